"""A code file has at most 600 lines, and should have at most 500: longer ones do more than one thing. Tables of data that
stand between "clang-format off" and "clang-format on" do not count."""
from tree import Plant

NOTED = 500
LIMIT = 600


def count_of_code(tree, path):
    count = 0
    in_table = False
    for _, line in tree.lines(path):
        if "clang-format off" in line:
            in_table = True
        elif "clang-format on" in line:
            in_table = False
        elif not in_table:
            count += 1
    return count


def check(tree):
    violations = []
    for path in tree.code_files():
        count = count_of_code(tree, path)
        if count > LIMIT:
            violations.append(f"{path}:{LIMIT + 1}: {count} lines, the limit is {LIMIT}")
        elif count > NOTED:
            print(f"note: {path} has {count} lines, more than {NOTED}")
    return violations


PLANTS = [
    Plant("baker/base/mesh/planted.cpp", "// planted\n" * (LIMIT + 1), f"{LIMIT + 1} lines"),
    Plant("tests/planted.py", "# clang-format off\n1\n# clang-format on\n" + "# planted\n" * (LIMIT + 1), f"{LIMIT + 1} lines"),
]
