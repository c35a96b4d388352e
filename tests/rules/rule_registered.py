"""Every test source is registered: a .c or .cpp file, and a test_*.py script, in tests/ or in a folder test/ of a sample, is
named in a CMakeLists.txt of its folder or of one above it. Comments do not count: a test commented out is a test that does
not run."""
import re
from pathlib import PurePosixPath

from tree import Plant


def is_test_source(path):
    *folders, name = PurePosixPath(path).parts
    if folders[0] != "tests" and "test" not in folders:
        return False
    return name.endswith((".c", ".cpp")) or (name.startswith("test_") and name.endswith(".py"))


def code_of(tree, path):
    """A CMakeLists.txt without its comments."""
    return "\n".join(re.sub(r"#.*", "", line) for _, line in tree.lines(path))


def words(code):
    """CMake code cut into its words; ${CMAKE_CURRENT_SOURCE_DIR}/ before a path is dropped."""
    code = re.sub(r"\$\{\w+_DIR\}/", "", code)
    return set(re.split(r"[\s\"();]+", code))


def names_it(code, path):
    """Whether CMake code names the path, outright or as test_${name}.cpp in a loop over words that have this name."""
    known = words(code)
    if path in known:
        return True
    for word in known:
        if "${" in word:
            pattern = re.sub(r"\\\$\\\{\w+\\\}", r"(\\w+)", re.escape(word))
            match = re.fullmatch(pattern, path)
            if match and match.groups() and all(name in known for name in match.groups()):
                return True
    return False


def is_registered(tree, path):
    for folder in list(PurePosixPath(path).parents)[:-1]:
        lists = (folder / "CMakeLists.txt").as_posix()
        if tree.exists(lists) and names_it(code_of(tree, lists), PurePosixPath(path).relative_to(folder).as_posix()):
            return True
    return False


def check(tree):
    return [f"{path}:1: named in no CMakeLists.txt, so it never runs"
            for path in tree.files("tests") + tree.files("samples")
            if is_test_source(path) and not is_registered(tree, path)]


PLANTS = [
    Plant("samples/creature/test/planted.cpp", "int main() { return 1; }\n", "never runs"),
    Plant("tests/rules/planted.cpp", "int main() { return 1; }\n", "never runs"),
    Plant("tests/baker/input/io/test_planted.cpp", "int main() { return 1; }\n", "never runs"),
    Plant("tests/rules/test_planted.py", "raise SystemExit(1)\n", "never runs"),
]
