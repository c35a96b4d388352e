"""Prints "passed failed skipped" for one of ctest's JUnit files, build/PRESET/results.xml; to stderr what failed, what was
skipped and why, the slowest tests, and a warning for each test that took longer than its budget in budgets.txt.

ctest files a test that returned SKIP_RETURN_CODE and a test whose program is missing under the same status, "notrun"; only
the first is a skip.
"""
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path


def classify(case):
    if case.get("status") == "run":
        return "passed"
    skip = case.find("skipped")
    if skip is not None and "SKIP_RETURN_CODE" in (skip.get("message") or ""):
        return "skipped"
    return "failed"


def skip_reason(case):
    """The first line that speaks of skipping, else the last line printed."""
    lines = [line.strip() for line in (case.findtext("system-out") or "").splitlines() if line.strip()]
    reasons = [line for line in lines if "skip" in line.lower()]
    return (reasons or lines[-1:] or ["no reason printed"])[0]


def read_budgets(preset):
    """Seconds by the name of the test; "*" is every other test."""
    rows = [line.split("#")[0].split() for line in Path(__file__).with_name("budgets.txt").read_text().splitlines()]
    return {name: int(sanitized if preset == "asan" else seconds) for name, seconds, sanitized in filter(None, rows)}


def report_times(cases, preset):
    """Only warns: the time of a test depends on the machine."""
    budgets = read_budgets(preset)
    times = sorted((-float(case.get("time") or 0), case.get("name")) for case in cases)
    if times:
        slowest = ", ".join(f"{name} {-time:.1f} s" for time, name in times[:3])
        print(f"slowest tests of {preset}: {slowest}", file=sys.stderr)
    for time, name in times:
        seconds, budget = round(-time), budgets.get(name, budgets["*"])
        if seconds > budget:
            print(f"tests/run.sh: warning: {name} took {seconds} s, its budget is {budget} s (tests/budgets.txt)",
                  file=sys.stderr)


def main(path):
    counts = {"passed": 0, "failed": 0, "skipped": 0}
    cases = list(ElementTree.parse(path).getroot().iter("testcase"))
    for case in cases:
        outcome = classify(case)
        counts[outcome] += 1
        if outcome == "failed":
            print(f"failed: {case.get('name')}", file=sys.stderr)
        elif outcome == "skipped":
            print(f"skipped: {case.get('name')}: {skip_reason(case)}", file=sys.stderr)
    report_times(cases, Path(path).resolve().parent.name)
    print(counts["passed"], counts["failed"], counts["skipped"])


if __name__ == "__main__":
    main(sys.argv[1])
