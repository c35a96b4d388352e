"""tests/run.sh reports honestly: stand-ins for cmake and ctest play a good build, a broken build, failures, skips and
programs that are missing; the last line and the exit code must tell. test_run_sh.py TESTS_FOLDER"""
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


def run(folder, tests, options, results, build_result):
    """Runs a copy of run.sh in an empty project."""
    project = Path(folder, "project")
    shutil.rmtree(project, ignore_errors=True)
    (project / "tests").mkdir(parents=True)
    for name in ("run.sh", "count_results.py"):
        shutil.copy(tests / name, project / "tests" / name)
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
    print(f"{len(CASES) + 1} cases, {bad} bad")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]).resolve()))
