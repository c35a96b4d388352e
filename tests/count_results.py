"""Prints "passed failed skipped" for one of ctest's JUnit files; to stderr what failed, and what was skipped and why.

ctest files a test that returned SKIP_RETURN_CODE and a test whose program is missing under the same status, "notrun"; only
the first is a skip.
"""
import sys
import xml.etree.ElementTree as ElementTree


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


def main(path):
    counts = {"passed": 0, "failed": 0, "skipped": 0}
    for case in ElementTree.parse(path).getroot().iter("testcase"):
        outcome = classify(case)
        counts[outcome] += 1
        if outcome == "failed":
            print(f"failed: {case.get('name')}", file=sys.stderr)
        elif outcome == "skipped":
            print(f"skipped: {case.get('name')}: {skip_reason(case)}", file=sys.stderr)
    print(counts["passed"], counts["failed"], counts["skipped"])


if __name__ == "__main__":
    main(sys.argv[1])
