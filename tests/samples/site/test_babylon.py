"""test_babylon.py FOLDER TOOL ASSET...: the recipe of samples/site/pages/engines/babylon.md, taken from there, in Babylon.js
on its engine without a screen, in node. The file loads, its animation moves, and for weights of poses or layers
the mesh has the positions that numpy computes from the file. FOLDER keeps node's packages. Exit code 77, and the reason,
without node or the npm registry."""
import json
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

from recipes import ROOT, block, compare, extras, run, table_weights

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(ROOT / "tests/baker/output/engines"))
import support  # noqa: E402

WEIGHTS = [0.2, 0.3, 0.5]


def recipe():
    samples = (ROOT / "samples/README.md").read_text(encoding="utf-8")
    blocks = re.findall(r"^```js\n(.*?)^```", samples, re.M | re.S)
    (function,) = [text for text in blocks if "function morphWeights" in text]
    return block("engines/babylon.md", "js", "loadPliant") + function


def main(folder, tool, *assets):
    modules = support.node_modules(folder, HERE)
    (modules / "recipe.mjs").write_text(recipe())
    shutil.copy(HERE / "babylon.mjs", modules)
    for asset in assets:
        with tempfile.TemporaryDirectory(prefix="pliant-babylon-") as name:
            glb = Path(name, "hero.glb")
            run(tool, "export", asset, "-o", glb)
            command = ["node", modules / "babylon.mjs", glb, json.dumps(WEIGHTS)]
            done = subprocess.run(command, capture_output=True, text=True)
            reports = [line for line in done.stdout.splitlines() if line.startswith("REPORT ")]
            assert done.returncode == 0 and reports, done.stdout + done.stderr
            report = json.loads(reports[0][len("REPORT "):])
            weights = table_weights(extras(glb), WEIGHTS)
            compare("weights", report["set"], weights, 1e-6)
            assert np.abs(np.diff(report["played"], axis=0)).max() > 1e-3, "the animation does not move it"
            file = support.Glb(glb)
            positions = np.reshape(report["positions"], (-1, 3))[:file.own_count()]
            compare("positions", positions, file.shape(weights), 1e-5)
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
