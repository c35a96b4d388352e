"""run.py [--sanitized] --tool PROGRAM --interface pliant|load_poses_tool CASE: runs one case of cases.txt.

Makes its files in a folder of its own, runs the command there and asserts the exit code, the number and text of the message,
that nothing was created or changed, and that it took neither long nor much memory, whatever the files claim. Exit code 0
passed, 1 failed, 77 skipped. `run.py --self-test` checks that table and generator name the same cases."""
import argparse
import os
import pathlib
import re
import resource
import shlex
import subprocess
import sys
import tempfile

import generate

TABLE = pathlib.Path(__file__).with_name("cases.txt")
FIELDS = ("case", "shows", "command", "exit_code", "number", "message")
NOBODY = 65534
SKIPPED = 77


def read_table():
    rows = {}
    for line in TABLE.read_text(encoding="utf-8").splitlines():
        if not line.strip() or line.startswith("#"):
            continue
        fields = [field.strip() for field in (line + " ").split(" | ", len(FIELDS) - 1)]
        assert len(fields) == len(FIELDS), line
        row = dict(zip(FIELDS, fields))
        assert row["case"] not in rows, f"{row['case']} stands twice in the table"
        rows[row["case"]] = row
    return rows


def contents(folder):
    """Name, kind and bytes of everything below a folder; files that may not be read by their size."""
    result = {}
    for path in sorted(folder.rglob("*")):
        readable = path.is_file() and path.stat().st_mode & 0o400
        result[str(path)] = (path.read_bytes() if readable
                             else (path.stat().st_mode, path.stat().st_size if path.is_file() else 0))
    return result


def command_of(row, arguments, output):
    words = [word.replace("OUT", str(output)).replace("LONG", "n" * 240) for word in shlex.split(row["command"])]
    if arguments.interface == "load_poses_tool":
        words = words[1:]
    return [os.path.abspath(arguments.tool)] + words


def drop_rights():
    os.setgroups([])
    os.setuid(NOBODY)


def run(row, arguments, folder, output):
    # The superuser may read everything, so this case needs somebody who may not.
    needs_nobody = row["case"] == "unreadable_file" and os.geteuid() == 0
    seconds = 60 if arguments.sanitized else 5
    try:
        return subprocess.run(command_of(row, arguments, output), cwd=folder, stdin=subprocess.DEVNULL, capture_output=True,
                              timeout=seconds, preexec_fn=drop_rights if needs_nobody else None)
    except subprocess.TimeoutExpired:
        print(f"FAILED: still running after {seconds} seconds")
        sys.exit(1)
    except PermissionError:
        print(f"skipped: user {NOBODY} may not run {arguments.tool}")
        sys.exit(SKIPPED)


def problems_of(row, result, before, after, input_size, arguments):
    errors = result.stderr.decode(errors="replace")
    found = re.findall(r"(?m)^.*?\b(?:error|warning) (P\d{4}):", errors)
    if result.returncode != int(row["exit_code"]):
        yield f"exit code {result.returncode}, wanted {row['exit_code']}"
    if row["number"] == "-" and found:
        yield f"found {found}, wanted nothing"
    if row["number"] != "-" and not set(row["number"].split("|")) & set(found):
        yield f"found {found}, wanted {row['number']}"
    if not re.search(row["message"], errors):
        yield f"no message matches {row['message']}"
    if int(row["exit_code"]) != 0 and "hint: " not in errors:
        yield "no hint"
    if before != after:
        yield f"files changed: {[name for name in before.keys() | after.keys() if before.get(name) != after.get(name)]}"
    peak = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss * 1024
    limit = (64 << 20) + 20 * input_size
    if not arguments.sanitized and peak > limit:
        yield f"took {peak >> 20} MiB, allowed {limit >> 20}"


def run_case(row, arguments):
    with tempfile.TemporaryDirectory(prefix="pliant-bad-input-") as name:
        folder, output = pathlib.Path(name) / "in", pathlib.Path(name) / "out"
        folder.mkdir()
        output.mkdir()
        os.chmod(name, 0o755)
        generate.generate(row["case"], folder)
        before = contents(pathlib.Path(name))
        result = run(row, arguments, folder, output)
        after = contents(pathlib.Path(name))
        input_size = sum(path.stat().st_size for path in folder.iterdir() if path.is_file())
        problems = list(problems_of(row, result, before, after, input_size, arguments))
    print(shlex.join(command_of(row, arguments, output)), result.stdout.decode(errors="replace"),
          result.stderr.decode(errors="replace"), *[f"FAILED: {problem}" for problem in problems], sep="\n")
    return 1 if problems else 0


def self_test():
    different = set(read_table()) ^ set(generate.CASES)
    print(f"in the table or in the generator only: {sorted(different)}" if different else f"{len(generate.CASES)} cases")
    return 1 if different else 0


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--tool")
    parser.add_argument("--interface", choices=("pliant", "load_poses_tool"))
    parser.add_argument("--sanitized", action="store_true")
    parser.add_argument("--self-test", action="store_true")
    parser.add_argument("case", nargs="?")
    arguments = parser.parse_args()
    if arguments.self_test:
        return self_test()
    row = read_table()[arguments.case]
    if arguments.interface == "load_poses_tool" and not row["command"].startswith("check "):
        print("skipped: needs the tool pliant")
        return SKIPPED
    return run_case(row, arguments)


sys.exit(main())
