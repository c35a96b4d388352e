"""tests/run.sh reports honestly: stand-ins for cmake and ctest play a good build, a broken build, failures, skips and
programs that are missing; the last line and the exit code must tell. Slow tests are named and never fail.
test_run_sh.py TESTS_FOLDER"""
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

PASSED = '<testcase name="good" status="run"/>'
FAILED = '<testcase name="bad" status="fail"><failure message=""/></testcase>'
SKIPPED = ('<testcase name="left_out" status="notrun"><skipped message="SKIP_RETURN_CODE=77"/>'
           "<system-out>skipped: no data</system-out></testcase>")
MISSING = '<testcase name="lost" status="notrun"><skipped message="Unable to find executable"/></testcase>'
DISABLED = '<testcase name="off" status="disabled"/>'

# Tests on both sides of these budgets, and what both suites must say of them.
BUDGETS = "# test seconds sanitized\n* 30 45\n\nlisted 60 90 # a comment\nlonger 60 90\n"
TIMED = "".join(f'<testcase name="{name}" status="run" time="{time}"/>' for name, time in (
    ("quick", 0.04), ("in_time", 30.4), ("over", 41.2), ("listed", 59), ("longer", 95.1)))
TIME_LINES = """slowest tests of dev: longer 95.1 s, listed 59.0 s, over 41.2 s
tests/run.sh: warning: longer took 95 s, its budget is 60 s (tests/budgets.txt)
tests/run.sh: warning: over took 41 s, its budget is 30 s (tests/budgets.txt)
slowest tests of asan: longer 95.1 s, listed 59.0 s, over 41.2 s
tests/run.sh: warning: longer took 95 s, its budget is 90 s (tests/budgets.txt)""".splitlines()

# Finds where to write the results, as ctest does, and writes what the test prepared.
FAKE_CTEST = """#!/bin/bash
echo "ctest $*" >> "$FAKE_LOG"
while (($#)); do
    [[ $1 == --output-junit ]] && results=$2
    shift
done
[[ -n $FAKE_RESULTS ]] && mkdir -p "$(dirname "$results")" && echo "<testsuite>$FAKE_RESULTS</testsuite>" > "$results"
exit 0
"""
FAKE_CMAKE = """#!/bin/bash
echo "cmake $*" >> "$FAKE_LOG"
[[ $1 == --build ]] && exit "$FAKE_BUILD_RESULT"
exit 0
"""

# name, options, results per suite, exit code of the build -> exit code, last line
CASES = [
    ("all good", [], PASSED + PASSED, 0, 0, "4 passed, 0 failed, 0 skipped"),
    ("one suite", ["--dev"], PASSED + SKIPPED, 0, 0, "1 passed, 0 failed, 1 skipped"),
    ("a failure", ["--asan"], PASSED + FAILED, 0, 1, "1 passed, 1 failed, 0 skipped"),
    ("a missing program is no skip", ["--dev"], PASSED + MISSING, 0, 1, "1 passed, 1 failed, 0 skipped"),
    ("a disabled test is no pass", ["--dev"], PASSED + DISABLED, 0, 1, "1 passed, 1 failed, 0 skipped"),
    ("a broken build", [], PASSED, 1, 1, "0 passed, 3 failed, 0 skipped"),
    ("ctest dies", ["--dev"], "", 0, 1, "0 passed, 1 failed, 0 skipped"),
    ("nothing ran", ["--dev", "--filter", "nothing"], " ", 0, 1, "0 passed, 1 failed, 0 skipped"),
    ("everything skipped", ["--dev"], SKIPPED, 0, 1, "0 passed, 1 failed, 1 skipped"),
    ("only build", ["--only-build"], PASSED, 0, 0, "0 passed, 0 failed, 0 skipped"),
    ("only a broken build", ["--only-build", "--dev"], PASSED, 1, 1, "0 passed, 1 failed, 0 skipped"),
]


def run(folder, tests, options, results, build_result, budgets=None):
    """Runs a copy of run.sh in an empty project, with other budgets if they are given."""
    project = Path(folder, "project")
    shutil.rmtree(project, ignore_errors=True)
    (project / "tests").mkdir(parents=True)
    for name in ("run.sh", "count_results.py", "budgets.txt"):
        shutil.copy(tests / name, project / "tests" / name)
    if budgets is not None:
        (project / "tests/budgets.txt").write_text(budgets)
    tools = project / "tools"
    tools.mkdir()
    for name, text in (("cmake", FAKE_CMAKE), ("ctest", FAKE_CTEST), ("clang++", "#!/bin/bash\n")):
        (tools / name).write_text(text)
        (tools / name).chmod(0o755)
    environment = {**os.environ, "PATH": f"{tools}:{os.environ['PATH']}", "FAKE_RESULTS": results,
                   "FAKE_BUILD_RESULT": str(build_result), "FAKE_LOG": str(project / "log")}
    return subprocess.run(["bash", str(project / "tests/run.sh"), "--no-install", *options], env=environment, text=True,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)


def main(tests):
    bad = 0
    with tempfile.TemporaryDirectory(prefix="pliant_run_sh_") as folder:
        for name, options, results, build_result, exit_code, last_line in CASES:
            result = run(folder, tests, options, results, build_result)
            lines = result.stdout.splitlines()
            if result.returncode != exit_code or lines[-1] != last_line:
                bad += 1
                print(f"{name}: exit code {result.returncode}, wanted {exit_code}; wanted '{last_line}', "
                      f"output:\n{result.stdout}")
        if run(folder, tests, ["--wrong"], PASSED, 0).returncode != 2:
            bad += 1
            print("an unknown option is not refused")
        result = run(folder, tests, [], TIMED, 0, BUDGETS)
        lines = [line for line in result.stdout.splitlines() if line.startswith("slowest") or "warning" in line]
        if lines != TIME_LINES or result.returncode != 0 or "10 passed, 0 failed, 0 skipped" not in result.stdout:
            bad += 1
            print(f"slow tests are reported otherwise, exit code {result.returncode}, output:\n{result.stdout}")
    print(f"{len(CASES) + 2} cases, {bad} bad")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]).resolve()))
