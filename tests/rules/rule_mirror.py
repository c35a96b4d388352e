"""Tests mirror the rooms: every folder of tests/baker/ is a group of the baker, by the table in baker/README.md, and every
group of sources has one. Of the top level runtime/, baker/ and samples/ have a folder of tests each."""
from rule_layers import table_of
from tree import Plant

README = "baker/README.md"
# Only scripts for other projects; the tests of pipeline/ run them.
WITHOUT_TESTS = {"cmake"}
TOP = ("baker", "runtime", "samples")


def first_files(tree, base):
    """Folder below base -> a file in it."""
    found = {}
    for path in tree.files(base):
        inside = path[len(base) + 1:].split("/")
        if len(inside) > 1:
            found.setdefault(inside[0], path)
    return found


def check(tree):
    groups = list(dict.fromkeys(room.split("/")[0] for room in table_of(tree, README)))
    tested = first_files(tree, "tests/baker")
    faults = [f"{path}:1: {name}/ is no group of the table in {README}"
              for name, path in tested.items() if name not in groups]
    faults += [f"{README}:1: the group {name}/ has no folder tests/baker/{name}/"
               for name in groups if name not in tested and name not in WITHOUT_TESTS]
    return faults + [f"tests/{name}/: {name}/ has no tests" for name in TOP if not tree.files(f"tests/{name}")]


PLANTS = [
    Plant("tests/baker/planted/test.py", "pass\n", "planted/ is no group of the table"),
    Plant("baker/README.md", "\n## Rooms\n\n| `planted/` | nothing |\n", "the group planted/ has no folder"),
]
