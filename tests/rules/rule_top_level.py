"""The top level of the project is closed: rooms, and the files that tools insist on finding there."""
from tree import Plant

ALLOWED = {
    "baker", "runtime", "formats", "samples", "tests",
    "CMakeLists.txt", "README.md", "LICENSE", "CHANGELOG.md", "CMakePresets.json", ".clang-format", ".gitignore",
    "CITATION.cff", ".ci", ".git", ".github",
}


def check(tree):
    return [f"{path}:1: {path.split('/')[0]} is not a name of the top level"
            for path in tree.files() if path.split("/")[0] not in ALLOWED]


PLANTS = [
    Plant("notes.txt", "planted\n", "not a name of the top level"),
    Plant("scripts/planted.sh", "true\n", "scripts is not a name of the top level"),
]
