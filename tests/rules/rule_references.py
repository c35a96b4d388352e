"""What the project refers to must be in the project: no absolute path of somebody's machine, no document that is not here,
no data outside the checkout, except in tests, which look beside it (../shared/) and skip when it is absent.
No loose ends."""
import re

from tree import CODE_SUFFIXES, Plant

SUFFIXES = CODE_SUFFIXES | {"CMakeLists.txt", "CMakePresets.json", ".md", ".json", ".in", "run", ".gitignore",
                            ".clang-format"}

PRIVATE_PATH = re.compile(r"(?<![\w.])/(?:work|home|root)/")
OUTSIDE_DATA = re.compile(r"\.\./shared\b|[\"']shared[\"'/]")
LOOSE_END = re.compile(r"\b(?:TODO|FIXME|XXX|HACK)\b")
DOCUMENT = re.compile(r"(?<!://)(?<![\w/.%-])([\w./-]*\w\.md)\b")
URL = re.compile(r"https?://\S+")

THIS_RULE = "tests/rules/rule_references.py"


def faults(line, path, documents):
    if PRIVATE_PATH.search(line):
        yield "an absolute path of a private machine"
    if OUTSIDE_DATA.search(line) and not path.startswith("tests/"):
        yield "refers to a folder outside the checkout"
    if LOOSE_END.search(line):
        yield "a loose end"
    for match in DOCUMENT.finditer(URL.sub("", line)):
        if match.group(1).split("/")[-1] not in documents:
            yield f"{match.group(1)} is not in the project"


def check(tree):
    documents = {path.split("/")[-1] for path in tree.files(suffixes={".md"})}
    violations = []
    for path in tree.files(suffixes=SUFFIXES):
        if path == THIS_RULE:
            continue
        for number, line in tree.lines(path):
            violations += [f"{path}:{number}: {fault}" for fault in faults(line, path, documents)]
    return violations


PLANTS = [
    Plant("runtime/planted.c", "/* see /work/notes */\n", "a private machine"),
    Plant("samples/planted.sh", "ls ../shared/data\n", "outside the checkout"),
    Plant("baker/planted.py", 'open(os.path.join("shared", "data"))\n', "outside the checkout"),
    Plant("baker/base/mesh/planted.cpp", "// TODO: planted\n", "a loose end"),
    Plant("baker/base/mesh/planted.cpp", "// see unwritten.md\n", "unwritten.md is not in the project"),
]
