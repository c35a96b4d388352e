"""A source with a header of its own includes it first, so that every header is compiled once with nothing before it. A
source without one is a main program, or implements a part of a header that is listed here, and includes that first."""
import re

from rule_includes import INCLUDE, resolve
from tree import Plant

ROOMS = ("baker", "samples")

# Sources that share a header, and the header.
SHARED = [
    (r"baker/cli/(?:verb_\w+|shared_options)\.cpp", "baker/cli/verbs.h"),
    (r"baker/input/io/read_(?:obj|off)\.cpp", "baker/input/io/source_file.h"),
    (r"baker/input/io/read_ply\.cpp", "baker/input/io/ply_header.h"),
    (r"baker/input/io/read_(?:medit|msh|vega|vtk)\.cpp", "baker/input/io/tet_builder.h"),
    (r"baker/input/poses/check_tets\.cpp", "baker/input/poses/check_solid.h"),
    (r"baker/input/poses/compare_\w+\.cpp", "baker/input/poses/compare_poses.h"),
    (r"baker/output/export/export_(?:morph|skin)\.cpp", "baker/output/export/export_parts.h"),
    (r"baker/output/page/render_camera\.cpp", "baker/output/page/render.h"),
    (r"baker/pipeline/summary\.cpp", "baker/pipeline/batch.h"),
    (r"baker/reduced/surrogate/nn_htp\.cpp", "baker/reduced/surrogate/nnls.h"),
]
MAIN = re.compile(r"(?:^|/)(?:main|module|\w+_test)\.cpp$|/test/")


def wanted_header(tree, path):
    """The header that a source must include first; None for a main program, "" where nothing is known."""
    own = path[:-len(".cpp")] + ".h"
    if tree.exists(own):
        return own
    if MAIN.search(path):
        return None
    return next((header for pattern, header in SHARED if re.fullmatch(pattern, path)), "")


def first_include(tree, path):
    """(line number, file in the tree) of the first include; of a header from outside the file is None."""
    for number, line in tree.lines(path):
        match = INCLUDE.match(line)
        if match:
            return number, resolve(tree, path, match.group(2)) if match.group(1) == '"' else None
    return 1, None


def check(tree):
    faults = []
    for path in [path for room in ROOMS for path in tree.files(room, {".cpp"})]:
        wanted = wanted_header(tree, path)
        if wanted is None:
            continue
        if wanted == "":
            faults.append(f"{path}:1: has no header of its own and is not in the list of tests/rules/rule_pairs.py")
            continue
        number, found = first_include(tree, path)
        if not (found or "").endswith(wanted):
            faults.append(f"{path}:{number}: includes {wanted} not first")
    return faults


PLANTS = [
    Plant("baker/base/mesh/planted.cpp", "int planted;\n", "no header of its own"),
    Plant("baker/cli/verb_planted.cpp", '#include "bake/bake.h"\n#include "cli/verbs.h"\n',
          "includes baker/cli/verbs.h not first"),
    Plant("baker/input/poses/compare_planted.cpp", "#include <vector>\n", "compare_poses.h not first"),
]
