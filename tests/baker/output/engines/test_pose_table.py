"""test_pose_table.py TOOL SHAPES ASSET...: the table of `pliant export` from pose weights to morph weights. The scripts of
samples/README.md, taken from there and run by Python, node and Godot, say what numpy says; and vertices moved by the table
are as far from the C runtime's as the file states."""
import json
import pathlib
import re
import shutil
import subprocess
import sys

import numpy as np

from support import Glb, check, export, weight_count

RECIPES = pathlib.Path(__file__).resolve().parents[4] / "samples" / "README.md"
RUN_NODE = """
const { pliant, weights } = JSON.parse(require("fs").readFileSync(process.argv[2]));
console.log(JSON.stringify(weights.map((w) => morphWeights(pliant, w))));
"""
RUN_GODOT = """extends SceneTree
%s
func _init():
    var file = File.new()
    file.open("task.json", File.READ)
    var task = JSON.parse(file.get_as_text()).result
    var rows = []
    for weights in task["weights"]:
        rows.append(morph_weights(task["pliant"], weights))
    print("REPORT ", to_json(rows))
    quit()
"""


def recipe(language, name):
    """The block of that language that has the name in it."""
    blocks = re.findall(rf"^```{language}\n(.*?)^```", RECIPES.read_text(), re.M | re.S)
    found = [block for block in blocks if name in block]
    check(len(found) == 1, f"{len(found)} blocks of {language} with {name} in {RECIPES}")
    check(len(found[0].splitlines()) <= 30, f"the recipe in {language} has more than 30 lines")
    return found[0]


def evaluated(pliant, weights):
    """As formats/SPEC.md defines it."""
    w = np.array(weights, float) if pliant.get("blend") == "layers" else np.array(weights, float) / sum(weights)
    tail = np.append(1, w) if pliant.get("blend") == "layers" else w
    table = pliant["pose_table"]
    centres = np.array(table["centres"]).reshape(-1, len(w))
    rows = np.array(table["coefficients"]).reshape(len(centres) + len(tail), -1)
    check(table["kernel"] == "cubic", f"kernel {table['kernel']}")
    return (np.sqrt(((w - centres) ** 2).sum(axis=1)) ** 3) @ rows[:len(centres)] + tail @ rows[len(centres):]


def in_python(task, folder):
    names = {}
    exec(recipe("python", "def morph_weights"), names)
    return [names["morph_weights"](task["pliant"], w) for w in task["weights"]]


def in_node(task, folder):
    if not shutil.which("node"):
        return None
    (folder / "table.cjs").write_text(recipe("js", "function morphWeights") + RUN_NODE)
    return json.loads(subprocess.run(["node", folder / "table.cjs", folder / "task.json"], capture_output=True, check=True,
                                     text=True, timeout=60).stdout)


def in_godot(task, folder):
    program = shutil.which("godot3-server")
    if not program:
        return None
    (folder / "table.gd").write_text(RUN_GODOT % recipe("gdscript", "func morph_weights"))
    command = [program, "--path", ".", "-s", "table.gd"]
    result = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=100)
    lines = [line for line in result.stdout.splitlines() if line.startswith("REPORT ")]
    check(lines, f"Godot says {result.stdout[-2000:]}{result.stderr[-2000:]}")
    return json.loads(lines[0][len("REPORT "):])


def check_recipes(name, pliant, weights, folder):
    task = {"pliant": pliant, "weights": weights}
    (folder / "task.json").write_text(json.dumps(task))
    (folder / "project.godot").write_text("config_version=4\n")
    wanted = np.array([evaluated(pliant, w) for w in weights])
    ran = []
    for run in (in_python, in_node, in_godot):
        found = run(task, folder)
        if found is None:
            print(f"left out: {run.__name__}, which is not installed (group engines of samples/install_packages.sh)")
            continue
        difference = abs(np.array(found) - wanted).max()
        check(difference < 1e-5, f"{name}: {run.__name__} differs by {difference}")  # Godot prints six digits
        ran.append(run.__name__)
    return ran


def check_asset(tool, program, path, folder):
    name = pathlib.Path(path).stem
    export(tool, path, folder / "a.glb")
    glb = Glb(folder / "a.glb")
    pliant = glb.json["meshes"][0]["extras"]["pliant"]
    m, d, n = weight_count(pliant), len(pliant["q_min"]), glb.own_count()
    subprocess.run([program, path, folder / "a.bin"], check=True, timeout=60)
    rows = np.fromfile(folder / "a.bin", "<f4").reshape(-1, m + 2 * d + 3 * n).astype(float)
    weights, shapes = rows[:, :m], rows[:, m + 2 * d:].reshape(len(rows), n, 3)
    box = np.array(pliant["bounds"]["max"]) - pliant["bounds"]["min"]
    distances = np.array([np.linalg.norm(glb.shape(evaluated(pliant, w)) - shape, axis=1)
                          for w, shape in zip(weights, shapes)]) / np.linalg.norm(box)
    stated = pliant["pose_table"]["error_of_diagonal"]
    check(distances.mean() < 2 * stated["mean"] + 1e-5, f"{name}: the table is {distances.mean():.1e} off, {stated} stated")
    check(distances.max() < 2 * stated["largest"] + 1e-4, f"{name}: the table is {distances.max():.1e} off, {stated} stated")
    check(stated["mean"] < 5e-3, f"{name}: {stated}")  # the tube buckles between its poses
    ran = check_recipes(name, pliant, [[0.3] * m, *weights[12:20].tolist()], folder)
    print(f"{name}: mean {distances.mean():.1e}, largest {distances.max():.1e} of the diagonal; {', '.join(ran)}")


def main():
    tool, program, *assets = sys.argv[1:]
    folder = pathlib.Path("pose_table").resolve()
    folder.mkdir(exist_ok=True)
    for path in assets:
        check_asset(tool, program, path, folder)
    return 0


if __name__ == "__main__":
    sys.exit(main())
