"""The source tree as the rules see it: every file that belongs to the project, without version control and build folders."""
import os
import shutil
import tempfile
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

IGNORED_FOLDERS = {".git", "build", "__pycache__"}
CODE_SUFFIXES = {".c", ".h", ".cpp", ".hpp", ".py", ".sh", ".cmake", ".vert", ".frag", ".comp", ".glsl"}
C_SUFFIXES = {".c", ".h", ".cpp", ".hpp"}


class Tree:
    def __init__(self, root):
        self.root = Path(root)

    def files(self, under="", suffixes=None):
        """Paths relative to the root, sorted, with forward slashes."""
        found = []
        for folder, subfolders, names in os.walk(self.root / under):
            subfolders[:] = [name for name in subfolders if name not in IGNORED_FOLDERS]
            for name in names:
                path = Path(folder, name).relative_to(self.root)
                if suffixes is None or path.suffix in suffixes or path.name in suffixes:
                    found.append(path.as_posix())
        return sorted(found)

    def code_files(self, under=""):
        return self.files(under, CODE_SUFFIXES | {"CMakeLists.txt"})

    def exists(self, path):
        return (self.root / path).is_file()

    def text(self, path):
        """The text of a file; a binary file reads as empty."""
        data = (self.root / path).read_bytes()
        return "" if b"\0" in data[:4096] else data.decode("utf-8", errors="replace")

    def lines(self, path):
        """(line number from 1, line) pairs."""
        return list(enumerate(self.text(path).splitlines(), start=1))


@dataclass
class Plant:
    """A deliberate violation: text put at the end of a file (made if it is not there), and what the report must then say."""

    path: str
    text: str
    expected: str


@contextmanager
def temporary_copy(root):
    """A copy of the tree that a test may spoil."""
    with tempfile.TemporaryDirectory(prefix="pliant_rules_") as folder:
        copy = Path(folder, "tree")
        shutil.copytree(root, copy, ignore=shutil.ignore_patterns(*IGNORED_FOLDERS))
        yield copy


@contextmanager
def planted(root, plant):
    """Plants the violation while the block runs, then takes it out again."""
    path = Path(root, plant.path)
    before = path.read_bytes() if path.exists() else None
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes((before or b"") + plant.text.encode())
    try:
        yield
    finally:
        if before is None:
            path.unlink()
        else:
            path.write_bytes(before)
