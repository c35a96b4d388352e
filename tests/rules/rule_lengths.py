"""Lengths of files, lines and functions. Tables of data between "clang-format off" and "clang-format on" are exempt.

A code file has at most 600 lines, and should have at most 500: longer ones do more than one thing.
A line has at most 125 columns in code, and in the fenced code of Markdown. Other lines of Markdown have at most 100, except
tables, and lines with a URL or with nothing but one word or link, which cannot be broken.
A function of the baker, the runtime and the samples has at most 100 lines in its body, and should have at most 60. Functions
written inside a class are not counted."""
import re

from tree import C_SUFFIXES, Plant

FILE_NOTED = 500
FILE_LIMIT = 600
FUNCTION_NOTED = 60
FUNCTION_LIMIT = 100
CODE_COLUMNS = 125
TEXT_COLUMNS = 100
MARKER = re.compile(r"\s*([-*+>] |\d+\. |#+ )?")
UNBREAKABLE = re.compile(r"!?\[[^\]]*\]\([^)]*\)\S*|\S+")


def lines_of_code(tree, path):
    """(line number, line) pairs outside of tables of data."""
    in_table = False
    for number, line in tree.lines(path):
        if "clang-format off" in line:
            in_table = True
        elif "clang-format on" in line:
            in_table = False
        elif not in_table:
            yield number, line


def check_file_length(tree, path):
    count = sum(1 for _ in lines_of_code(tree, path))
    if FILE_NOTED < count <= FILE_LIMIT:
        print(f"note: {path} has {count} lines, more than {FILE_NOTED}")
    return [f"{path}:{FILE_LIMIT + 1}: {count} lines, the limit is {FILE_LIMIT}"] if count > FILE_LIMIT else []


def too_wide(path, number, line, limit):
    return [f"{path}:{number}: {len(line)} columns, the limit is {limit}"] if len(line) > limit else []


def check_code_columns(tree, path):
    return [fault for number, line in lines_of_code(tree, path) for fault in too_wide(path, number, line, CODE_COLUMNS)]


def can_be_broken(line):
    """Whether a line of Markdown is text of several words, and no row of a table."""
    text = line[MARKER.match(line).end():].strip()
    return not text.startswith("|") and "://" not in text and not UNBREAKABLE.fullmatch(text)


def check_text_columns(tree, path):
    faults = []
    in_fence = False
    for number, line in tree.lines(path):
        if line.lstrip().startswith("```"):
            in_fence = not in_fence
        if in_fence:
            faults += too_wide(path, number, line, CODE_COLUMNS)
        elif can_be_broken(line):
            faults += too_wide(path, number, line, TEXT_COLUMNS)
    return faults


def check_functions(tree, path):
    """clang-format puts the braces of a function of the file alone into the first column, and no other braces there."""
    faults = []
    start = None
    for number, line in tree.lines(path):
        if line == "{":
            start = number
        elif line == "}" and start:
            count = number - start - 1
            if count > FUNCTION_LIMIT:
                faults.append(f"{path}:{start}: a function of {count} lines, the limit is {FUNCTION_LIMIT}")
            elif count > FUNCTION_NOTED:
                print(f"note: {path}:{start}: a function of {count} lines, more than {FUNCTION_NOTED}")
            start = None
    return faults


def check(tree):
    violations = []
    for path in tree.code_files():
        violations += check_file_length(tree, path) + check_code_columns(tree, path)
    for path in tree.files(suffixes={".md"}):
        violations += check_text_columns(tree, path)
    for folder in ("baker", "runtime", "samples"):
        for path in tree.files(folder, C_SUFFIXES):
            violations += check_functions(tree, path)
    return violations


TABLE = "# clang-format off\n" + "1" * (CODE_COLUMNS + 1) + "\n# clang-format on\n"
WORDS = "word " * (TEXT_COLUMNS // 5) + "more\n"
PLANTS = [
    Plant("baker/base/mesh/planted.cpp", "// planted\n" * (FILE_LIMIT + 1), f"{FILE_LIMIT + 1} lines"),
    Plant("tests/planted.py", TABLE + "# planted\n" * (FILE_LIMIT + 1), f"{FILE_LIMIT + 1} lines"),
    Plant("baker/cli/planted.h", "// " + "x" * (CODE_COLUMNS - 2) + "\n", f":1: {CODE_COLUMNS + 1} columns"),
    Plant("tests/planted.sh", TABLE + "#" * (CODE_COLUMNS + 1) + "\n", f":4: {CODE_COLUMNS + 1} columns"),
    Plant("samples/README.md", "| " + WORDS + WORDS, f"{TEXT_COLUMNS + 4} columns, the limit is {TEXT_COLUMNS}"),
    Plant("samples/README.md", "```\n" + WORDS + "a " * CODE_COLUMNS + "\n```\n", f"{2 * CODE_COLUMNS} columns"),
    Plant("samples/README.md", "[a link](" + "x" * TEXT_COLUMNS + ") and text\n", f"{TEXT_COLUMNS + 19} columns"),
    Plant("runtime/planted.c", "void planted(void)\n{\n" + "    ;\n" * (FUNCTION_LIMIT + 1) + "}\n",
          f":2: a function of {FUNCTION_LIMIT + 1} lines"),
]
