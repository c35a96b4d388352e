"""C and C++ code is as clang-format writes it with the .clang-format of the root."""
import re
import shutil
import subprocess

from tree import C_SUFFIXES, Plant

TOOL = "clang-format"
COMPLAINT = re.compile(r"^(.+?):(\d+):\d+: (?:error|warning): code should be clang-formatted")


def missing_tool():
    return None if shutil.which(TOOL) else f"{TOOL} is not installed"


def check(tree):
    paths = tree.files(suffixes=C_SUFFIXES)
    result = subprocess.run([TOOL, "--dry-run", *paths], cwd=tree.root, capture_output=True, text=True, check=True)
    first_lines = {}
    for line in result.stderr.splitlines():
        match = COMPLAINT.match(line)
        if match:
            first_lines.setdefault(match.group(1), match.group(2))
    return [f"{path}:{line}: not as clang-format writes it (clang-format -i {path})" for path, line in first_lines.items()]


PLANTS = [Plant("runtime/planted.c", "int  planted ;\n", "not as clang-format writes it")]
