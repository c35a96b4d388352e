"""test_json.py PLIANT CHECKOUT: what programs read. --json of every verb that prints figures is one JSON value, or nothing
if it fails; the report holds to its schema; every exit code of baker/README.md comes as it says."""
import json
import pathlib
import re
import sys
import tempfile

import support
from support import QUICK_OPTIONS, check, poses

TOOL, SOURCE = support.Tool(sys.argv[1]), pathlib.Path(sys.argv[2])


def figures(folder, *arguments):
    result = TOOL.run(*arguments, "--json", cwd=folder)
    try:
        value = json.loads(result.stdout)
    except ValueError:
        value = None
    check(result.returncode == 0 and isinstance(value, dict), f"{arguments[0]} --json {result.stderr}")
    return value or {}


def test_verbs(folder):
    poses(folder)
    pair = ["rest.obj", "bent.obj"]
    TOOL.run("bake", *pair, "-o", "a.pliant", "--report", "report.json", *QUICK_OPTIONS, cwd=folder)
    checked = figures(folder, "check", *pair, "--dim", "3")
    check(checked["vertices"] == 66 and checked["estimate"]["memory"] > 0 and checked["estimate"]["dimension"] == 3,
          "check: counts and estimate")
    dry = TOOL.run("bake", *pair, "-o", "b.pliant", "--dim", "3", "--dry-run", cwd=folder)
    check(json.loads(dry.stdout)["estimate"]["dimension"] == 3 and not (folder / "b.pliant").exists(),
          "bake --dry-run says the same, and bakes nothing")
    info = figures(folder, "info", "a.pliant")
    check(info["dimension"] == 3 and info["mean_error"] == info["certificate"]["measured"]["mean_error"]
          and info["meets_tolerance"] is info["certificate"]["meets_tolerance"] and info["tolerance"] == 0.001,
          "info: dimension, errors and verdict")
    check(figures(folder, "validate", "a.pliant")["valid"] is True, "validate: valid")
    for verb in ("info", "validate"):
        several = json.loads(TOOL.run(verb, "a.pliant", "a.pliant", "--json", cwd=folder).stdout)
        check([one["asset"] for one in several] == ["a.pliant"] * 2, f"{verb}: several assets are an array")
    check(len(figures(folder, "measure", "a.pliant", *pair, "--samples", "2")["samples"]) == 2, "measure: a row a sample")
    blended = figures(folder, "blend", "a.pliant", "--weights", "1,2", "-o", "b.ply")
    check(blended["frames"][0]["output"] == "b.ply" and blended["frames"][0]["evaluations"] > 0,
          f"blend: evaluations {blended}")
    (folder / "path.csv").write_text("0.75,0.25\n0.5,0.5\n", encoding="utf-8")
    frames = figures(folder, "blend", "a.pliant", "--path", "path.csv", "-o", "b_%d.ply")["frames"]
    check([frame["output"] for frame in frames] == ["b_0.ply", "b_1.ply"], "blend --path: a row a frame")
    averages = figures(folder, "average", *pair, "--path", "path.csv", "-o", "t_%d.ply")
    check([row["weights"] for row in averages["averages"]] == [[0.75, 0.25], [0.5, 0.5]], "average --path: a row a mesh")
    check(figures(folder, "average", *pair, "-w", "1,1", "-o", "t.ply")["averages"][0]["energy"] > 0, "average: energy")
    return json.loads((folder / "report.json").read_text(encoding="utf-8"))


def test_failures(folder):
    poses(folder)
    (folder / "no.pliant").write_text("nothing", encoding="utf-8")
    for arguments in (["check", "rest.obj", "missing.obj"], ["info", "no.pliant"],
                      ["measure", "no.pliant", "rest.obj"],
                      ["blend", "no.pliant", "-w", "1,1", "-o", "b.ply"],
                      ["average", "rest.obj", "missing.obj", "-w", "1,1", "-o", "b.ply"]):
        result = TOOL.run(*arguments, "--json", cwd=folder)
        check(result.returncode == 3 and result.stdout == "" and "error P" in result.stderr,
              f"{arguments[0]} fails: its errors on standard error alone")
    for name, number in (("no.pliant", 5102), ("missing.pliant", 2001)):
        result = TOOL.run("validate", name, "--json", cwd=folder)
        verdict = json.loads(result.stdout)
        check(result.returncode == 3 and verdict["valid"] is False and verdict["number"] == number and verdict["what"]
              and f"error P{number}" in result.stderr, f"validate: {name} is not valid, and why")


def test_schema(report):
    judge = support.validator(SOURCE, "report.schema.json")
    if not judge:
        print("skipped: the report against its schema, python3-jsonschema is not installed")
        return
    check(judge(report) == [], f"a report holds to its schema {judge(report)}")
    del report["measured"]
    report["subspace"]["dimension"] = "3"
    check(len(judge(report)) == 2, f"and a spoilt one does not {judge(report)}")


def test_schema_of_layers(folder):
    """Weights beyond 1."""
    judge = support.validator(SOURCE, "report.schema.json")
    done = TOOL.run("bake", *poses(folder), "--blend", "layers", "--range", "0:1.3", "-o", folder / "a.pliant", "--report",
                    folder / "a.json", *QUICK_OPTIONS)
    report = json.loads((folder / "a.json").read_text(encoding="utf-8"))
    check(done.returncode == 0 and not (judge and judge(report)), f"a report of layers holds to it, too {done.stderr}")


def test_exit_codes(folder):
    pair = poses(folder)
    wanted = {0: ["check", *pair], 1: ["bake", *pair, "-o", folder / "no folder/a.pliant"], 2: ["bake", "--bogus"],
              3: ["check", pair[0], folder / "missing.obj"],
              4: ["bake", *pair, "-o", folder / "a.pliant", "--tolerance", "1e-8", *QUICK_OPTIONS]}
    for code, arguments in wanted.items():
        got = TOOL.run(*arguments).returncode
        check(got == code, f"exit code {got}, wanted {code}: {arguments[0]} {' '.join(map(str, arguments[-2:]))}")
    # 130 is tested in bad_input/test_bake_output.py and in test_bake_all.py.
    table = (SOURCE / "baker/README.md").read_text(encoding="utf-8").split("## Exit codes")[1].split("\n## ")[0]
    documented = {int(code) for code in re.findall(r"(?m)^\| (\d+) \|", table)}
    check(documented == set(wanted) | {130}, f"baker/README.md has a table of them {documented}")


with tempfile.TemporaryDirectory(prefix="pliant-json-") as name:
    place = pathlib.Path(name)
    for part in ("a", "b", "c", "d"):
        (place / part).mkdir()
    test_schema(test_verbs(place / "a"))
    test_failures(place / "b")
    test_schema_of_layers(place / "d")
    test_exit_codes(place / "c")
support.finish()
