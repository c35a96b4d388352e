"""test_config.py PLIANT CHECKOUT: configuration files of `pliant bake`. They do what the same command line does, the command
line beats them, --print-config goes round, mistakes are named, and the schema says what the tool does."""
import json
import pathlib
import sys
import tempfile

import support
from support import QUICK, QUICK_OPTIONS, check, poses, write_json

TOOL, SOURCE = support.Tool(sys.argv[1]), pathlib.Path(sys.argv[2])
SCHEMA = json.loads((SOURCE / "formats/schema/bake_config.schema.json").read_text(encoding="utf-8"))["properties"]


def test_same_as_command_line(folder):
    poses(folder / "sub")
    config = write_json(folder / "sub/hero.json", {"$schema": "bake_config.schema.json", "poses": ["rest.obj", "bent.obj"],
                                                   "output": "by_config.pliant", "seed": 5, "no_align": True, **QUICK})
    by_config = TOOL.run("bake", "--config", config, "--quiet", cwd=folder)
    check(by_config.returncode == 0 and (folder / "sub/by_config.pliant").exists(),
          f"poses and output of a configuration {by_config.stderr}")
    TOOL.run("bake", "sub/rest.obj", "sub/bent.obj", "-o", "by_line.pliant", "--seed", "5", "--no-align", *QUICK_OPTIONS,
             cwd=folder)
    wanted = (folder / "by_line.pliant").read_bytes()
    check((folder / "sub/by_config.pliant").read_bytes() == wanted, "the same bytes as by the command line")
    other = TOOL.run("bake", "--config", "sub/hero.json", "-o", "other.pliant", "--seed", "6", "--quiet", cwd=folder)
    seed = json.loads(TOOL.run("info", "--json", folder / "other.pliant").stdout)["certificate"]["seed"]
    check(other.returncode == 0 and seed == 6, f"options of the command line beat those of the file: seed {seed}")

    printed = TOOL.run("bake", "--config", "sub/hero.json", "--print-config", cwd=folder)
    effective = json.loads(printed.stdout)
    check(printed.returncode == 0 and effective["seed"] == 5 and effective["membrane"] == "neo-hookean",
          "--print-config shows what is given and defaults")
    check(effective["poses"] == ["sub/rest.obj", "sub/bent.obj"] and not {"tolerance", "position_error"} & set(effective),
          "paths as seen from here, no condition that was not set, no default that follows from other options")
    turned_off = TOOL.run("bake", "--config", "sub/hero.json", "--preview=false", "--print-config", cwd=folder)
    check(json.loads(turned_off.stdout)["preview"] is False, "a flag that is turned off")
    write_json(folder / "round.json", effective)
    again = TOOL.run("bake", "--config", "round.json", "--print-config", cwd=folder)
    check(again.stdout == printed.stdout, "the printed configuration is printed again as it is")
    (folder / "sub/by_config.pliant").unlink()
    TOOL.run("bake", "--config", "round.json", "--quiet", cwd=folder)
    check((folder / "sub/by_config.pliant").read_bytes() == wanted, "and bakes the same bytes")


def test_round_trip_of_everything(folder):
    line = ["--", "a.obj", "-b.obj"]
    options = ["-o", "x.pliant", "--tolerance", "0.0123456789012345", "--tolerance-max", ".5", "--seed", str(2**64 - 1),
               "--poisson", "0.3",
               "--material", "stvk", "--cubature", "nn-htp", "--energy", "quartic", "--no-scene", "--best-effort", "--fix",
               "f.txt",
               "--weld", "0", "--position-error", "1e-7", "--report", "r.json", "--depfile", "d.d", "--stamp", "s", "-q"]
    printed = TOOL.run("bake", *options, *line, "--print-config", cwd=folder)
    check(printed.returncode != 0, "behind -- nothing is an option")
    printed = TOOL.run("bake", "--print-config", *options, *line, cwd=folder)
    effective = json.loads(printed.stdout)
    check(effective["seed"] == 2**64 - 1 and effective["tolerance"] == 0.0123456789012345
          and effective["tolerance_max"] == 0.5, "numbers keep all digits")
    check(set(effective) <= set(SCHEMA), f"the schema has every key {sorted(set(effective) - set(SCHEMA))}")
    write_json(folder / "all.json", effective)
    again = TOOL.run("bake", "--config", "all.json", "--print-config", cwd=folder)
    check(again.stdout == printed.stdout, f"a round trip of all options {again.stderr}")
    judge = support.validator(SOURCE, "bake_config.schema.json")
    if judge:
        check(judge(effective) == [], f"it holds to the schema {judge(effective)}")
        check(judge({"dim": 0}) != [] and judge({"tolerence": 1}) != [], "the schema refuses what is wrong")
    else:
        print("skipped: the schema as such, python3-jsonschema is not installed")


def refused(folder, value, number, text, what):
    path = folder / "bad.json"
    path.write_text(value if isinstance(value, str) else json.dumps(value), encoding="utf-8")
    result = TOOL.run("bake", "--config", path, cwd=folder)
    good = (result.returncode == 3 and f"error {number}: {path}" in result.stderr and text in result.stderr
            and "hint: " in result.stderr)
    check(good and result.stdout == "", f"{what}: {result.stderr.strip()}")


def test_mistakes(folder):
    refused(folder, "{ \"dim\": 3,\n  \"seed\" 4 }", "P2701", "line 2", "not JSON")
    refused(folder, "[" * 100000, "P2702", "nested", "nested deep")
    refused(folder, "{\"dim\": 3, \"dim\": 4}", "P2703", "'dim' twice", "a key twice")
    refused(folder, {"tolerence": 1e-3}, "P2704", 'did you mean "tolerance"', "a key misspelt")
    refused(folder, {"tolerance-max": 1e-3}, "P2704", 'did you mean "tolerance_max"', "a key as on the command line")
    refused(folder, {"config": "a.json"}, "P2704", "the keys are ", "a key that no configuration has")
    refused(folder, {"dim": "3"}, "P2705", "without quotation marks", "a number in quotation marks")
    refused(folder, {"dim": 2.5}, "P2705", "without a decimal point", "half a dimension")
    refused(folder, {"tolerance": None}, "P2705", "as in 0.001", "no number")
    refused(folder, {"no_align": 1}, "P2705", "true or false expected", "a number for a boolean")
    refused(folder, {"poses": "rest.obj"}, "P2705", "a list", "one pose for a list")
    refused(folder, {"range": "0:1.3"}, "P2705", 'write ["0:1.3"]', "one range for a list")
    refused(folder, {"poses": ["rest.obj", 7]}, "P2705", "the name of a file", "a number among poses")
    refused(folder, {"output": ""}, "P2705", '"output" is empty', "an empty name")
    refused(folder, {"fix": "a\0b"}, "P2705", "the name of a file", "a name with a byte 0")
    refused(folder, {"dim": 257}, "P2706", "1 to 256", "a dimension out of range")
    refused(folder, {"tolerance": 1e400}, "P2701", "not JSON", "a number that is none") # Python writes Infinity
    refused(folder, {"subspace": "krylow"}, "P2706", "adaptive, krylov, barbic", "a name that there is not")
    refused(folder, {"seed": -1}, "P2706", "it takes 0 to 18446744073709551615", "a negative seed")
    missing = TOOL.run("bake", "--config", "missing.json", cwd=folder)
    check(missing.returncode == 3 and "error P2001: missing.json" in missing.stderr, "a configuration that is not there")
    no_poses = TOOL.run("bake", "-o", "a.pliant", cwd=folder)
    check(no_poses.returncode == 2 and "error P1301" in no_poses.stderr, f"no poses: {no_poses.stderr}")
    no_output = TOOL.run("bake", "rest.obj", "bent.obj", cwd=folder)
    check(no_output.returncode == 2 and "error P1302" in no_output.stderr, f"no output: {no_output.stderr}")


def accepts(folder, values):
    """Whether the tool takes values by key; only --print-config, so that nothing is read or baked."""
    write_json(folder / "probe.json", {"poses": ["a.obj", "b.obj"], "output": "x.pliant", **values})
    return TOOL.run("bake", "--config", "probe.json", "--print-config", cwd=folder).returncode == 0


def values_of(key, rule, folder):
    """Values that the schema just takes, and some that it just does not."""
    if key == "solver" and not accepts(folder, {"solver": "cholmod"}):
        return ["eigen"], ["cholesky"] # a build without CHOLMOD
    if "enum" in rule:
        return rule["enum"], ["no-such-name"]
    if rule["type"] == "boolean":
        return [True, False], ["yes"]
    if rule["type"] == "array":
        return [["0:1.5", "bent=-1:1"]], ["0:1", [1], ["1"]]
    if rule["type"] == "string":
        return ["a"], [1]
    beyond = 1 if rule["type"] == "integer" else 1e-9
    return [rule["minimum"], rule["maximum"]], [rule["minimum"] - beyond, rule["maximum"] + beyond]


def test_schema_against_tool(folder):
    """Kinds, names and limits of the schema are those of the tool."""
    values = {key: values_of(key, rule, folder) for key, rule in SCHEMA.items() if key not in ("$schema", "poses", "output")}
    for turn in range(max(len(good) for good, _ in values.values())):
        taken = {key: good[turn % len(good)] for key, (good, _) in values.items()}
        if taken["check_samples"] == 0 and taken["fresh_samples"] == 0:
            check(not accepts(folder, taken), f"a tolerance of no comparisons is refused, turn {turn}") # P1240
            taken["fresh_samples"] = 1
        check(accepts(folder, taken), f"values of all keys at the limits, turn {turn}")
    wrong = [f"{key}: {value}" for key, (_, bad) in values.items() for value in bad if accepts(folder, {key: value})]
    check(wrong == [], f"values beyond are refused {wrong}")
    known = TOOL.run("bake", "--config", write_json(folder / "k.json", {"xyzzy_plugh": 1})).stderr
    keys = set(known.split("the keys are ")[1].split("\n")[0].split(", "))
    check(keys == set(SCHEMA) - {"$schema"}, f"the tool has no other keys {keys ^ set(SCHEMA)}")


with tempfile.TemporaryDirectory(prefix="pliant-config-") as name:
    for number, test in enumerate((test_same_as_command_line, test_round_trip_of_everything, test_mistakes,
                                   test_schema_against_tool)):
        place = pathlib.Path(name) / str(number)
        place.mkdir()
        test(place)
support.finish()
