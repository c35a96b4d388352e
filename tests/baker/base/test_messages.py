"""test_messages.py CHECKOUT: every message number that the sources use has a row in baker/base/common/messages.md and the
other way round, no number has two rows, and every number is named by some file under tests/, unless its row says
`none: REASON`."""
import pathlib
import re
import sys

# How a number gets into a message: error_at(2103, ...), SourceFile::error(2103, ...), progress.warn(4020, ...),
# Severity::error, 2103, "error P2103: ..."
USES = re.compile(r"(?:\b(?:error_at|warning_at|error|warning|warn|fail)\(\s*"
                  r"|Severity::(?:error|warning)\s*,\s*|\b(?:error|warning) P)"
                  r"([1-5]\d{3})\b")
ROW = re.compile(r"^\|\s*P([1-5]\d{3})\s*\|\s*(error|warning|error, warning)\s*\|([^|]+)\|([^|]*)\|([^|]+)\|$")


def used_numbers(root):
    used = {}
    for path in sorted(root.joinpath("baker").rglob("*")):
        if path.suffix not in (".cpp", ".h"):
            continue
        text = re.sub(r"//.*", "", path.read_text(encoding="utf-8"))
        for number in USES.findall(text):
            used.setdefault(number, path.relative_to(root))
    return used


def main():
    root = pathlib.Path(sys.argv[1])
    table = root / "baker/base/common/messages.md"
    problems, rows, untested = [], {}, set()
    for line_number, line in enumerate(table.read_text(encoding="utf-8").splitlines(), 1):
        if not re.match(r"^\|\s*P\d", line):
            continue
        row = ROW.match(line)
        if not row:
            problems.append(f"{table}:{line_number}: not a row of five columns")
        elif row[1] in rows:
            problems.append(f"{table}:{line_number}: P{row[1]} stands in line {rows[row[1]]} already")
        else:
            rows[row[1]] = line_number
            if row[5].strip().startswith("none:"):
                untested.add(row[1])
    used = used_numbers(root)
    problems += [f"{path}: P{number} has no row in {table}" for number, path in used.items() if number not in rows]
    problems += [f"{table}:{line}: P{number} is used nowhere" for number, line in rows.items() if number not in used]
    tests = "\n".join(p.read_text(encoding="utf-8", errors="replace") for p in root.joinpath("tests").rglob("*")
                      if p.suffix in (".cpp", ".h", ".c", ".py", ".txt", ".sh") and p.is_file())
    named = set(re.findall(r"(?<!\d)P?([1-5]\d{3})(?!\d)", tests))
    problems += [f"{table}:{line}: P{number} is named by no test" for number, line in rows.items()
                 if number not in named | untested]
    print("\n".join(problems) or f"{len(rows)} numbers, all documented and used, all but {len(untested)} tested")
    return 1 if problems or not rows else 0


sys.exit(main())
