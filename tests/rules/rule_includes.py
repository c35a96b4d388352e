"""Includes go one way: formats <- runtime <- samples; baker <- formats, and baker <- runtime only where an asset is opened
(output/ for the self-check, exports and pages, cli/ for `blend`, python/ whose Asset is the runtime on bytes in Python). The
runtime sees five headers of the C library, its public headers two or none; pliant_gl declares what it needs of GL itself,
and the runtime knows nothing of pliant_gl."""
import re
from pathlib import PurePosixPath

from tree import C_SUFFIXES, Plant

INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]')

# Which rooms a room may include from. Tests may include everything.
ALLOWED_ROOMS = {
    "formats": {"formats"},
    "runtime": {"formats", "runtime"},
    "baker": {"formats", "baker"},
    "samples": {"formats", "runtime", "samples"},
}
BAKER_FOLDERS_WITH_RUNTIME = ("baker/output/", "baker/cli/", "baker/python/")

RUNTIME_LIBC = {"stddef.h", "stdint.h", "string.h", "math.h", "float.h"}
# The optional GL part of the runtime is a library of its own on top of the other.
GL_PART = "runtime/gl/"
# For other languages, each with the standard library of its own.
BINDINGS = "runtime/bindings/"
LIBC_OF_PUBLIC_HEADERS = {
    "runtime/pliant.h": {"stddef.h", "stdint.h"},
    "runtime/gl/pliant_gl.h": set(),
    "formats/pliant_format.h": {"stddef.h", "stdint.h"},
}

# Where an include is looked up after the includer's own folder: the include paths of our targets.
SEARCH_FOLDERS = ("baker", "formats", "runtime", "runtime/gl", "runtime/bindings/cpp", "samples", "samples/player", "")


def resolve(tree, path, name):
    """The file in the tree that an include means, or None if it is not ours."""
    for folder in (PurePosixPath(path).parent.as_posix(), *SEARCH_FOLDERS):
        parts = []
        for part in PurePosixPath(folder, name).parts:
            if part == ".." and parts:
                parts.pop()
            elif part != ".":
                parts.append(part)
        candidate = "/".join(parts)
        if tree.exists(candidate):
            return candidate
    return None


def allowed_libc(path):
    """The headers from outside that a file may include, or None for any."""
    if path in LIBC_OF_PUBLIC_HEADERS:
        return LIBC_OF_PUBLIC_HEADERS[path]
    if path.startswith("runtime/") and not path.startswith(BINDINGS):
        return RUNTIME_LIBC
    return None


def judge(tree, path, quote, name):
    """What is wrong with one include, or None."""
    room = path.split("/")[0]
    target = resolve(tree, path, name)
    if target is None:
        if quote == '"':
            return f'"{name}" is not in the tree (headers from outside stand in angle brackets)'
        libc = allowed_libc(path)
        if libc is not None and name not in libc:
            return f"<{name}>: this file may include only {', '.join(sorted(libc)) or 'nothing'} from outside"
        return None
    target_room = target.split("/")[0]
    if room == "runtime" and target.startswith(GL_PART) and not path.startswith(GL_PART):
        return f"{name}: the runtime does not include from pliant_gl"
    if target_room in ALLOWED_ROOMS[room]:
        return None
    if room == "baker" and target_room == "runtime" and path.startswith(BAKER_FOLDERS_WITH_RUNTIME):
        return None
    return f"{name}: {room} does not include from {target_room}"


def check(tree):
    violations = []
    for room in ALLOWED_ROOMS:
        for path in tree.files(room, C_SUFFIXES):
            for number, line in tree.lines(path):
                match = INCLUDE.match(line)
                fault = match and judge(tree, path, *match.groups())
                if fault:
                    violations.append(f"{path}:{number}: {fault}")
    return violations


PLANTS = [
    Plant("formats/planted.h", '#include "pliant.h"\n', "formats does not include from runtime"),
    Plant("runtime/planted.c", '#include "../baker/base/common/diagnostics.h"\n', "runtime does not include from baker"),
    Plant("runtime/planted.c", "#include <stdlib.h>\n", "<stdlib.h>"),
    Plant("runtime/pliant.h", "#include <math.h>\n", "<math.h>"),
    Plant("runtime/gl/pliant_gl.h", "#include <stdint.h>\n", "only nothing"),
    Plant("runtime/gl/planted.c", "#include <GL/gl.h>\n", "<GL/gl.h>"),
    Plant("runtime/planted.c", '#include "pliant_gl.h"\n', "the runtime does not include from pliant_gl"),
    Plant("formats/pliant_format.h", "#  include <string.h>\n", "<string.h>"),
    Plant("baker/base/mesh/planted.cpp", "#include <pliant.h>\n", "baker does not include from runtime"),
    Plant("samples/planted.c", '#include "base/mesh/pose_set.h"\n', "samples does not include from baker"),
    Plant("samples/player/planted.cpp", '#include "elastic/energy/solid.h"\n', "samples does not include from baker"),
    Plant("baker/input/io/planted.cpp", '#include "nowhere.h"\n', "is not in the tree"),
]
