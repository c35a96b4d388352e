"""What the tests of the site's recipes share: code out of a page, commands, blends to compare with."""
import json
import re
import struct
import subprocess
import sys
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[3]
PAGES = ROOT / "samples/site/pages"


def skip(reason):
    print("skipped:", reason)
    sys.exit(77)


def block(page, language, name):
    """The only block of that language that has the name in it."""
    blocks = re.findall(rf"^```{language}\n(.*?)^```", (PAGES / page).read_text(encoding="utf-8"), re.M | re.S)
    (found,) = [text for text in blocks if name in text]
    return found


def run(*command, **options):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, **options)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}: exit code {done.returncode}\n{done.stdout}{done.stderr}")
    return done.stdout


def blended(tool, asset, weights, folder):
    """The positions of `pliant blend`, which writes binary PLY with floats x y z first."""
    path = folder / "blend.ply"
    run(tool, "blend", asset, f"--weights={','.join(map(str, weights))}", "-o", path)
    head, body = path.read_bytes().split(b"end_header\n", 1)
    count = int(re.search(rb"element vertex (\d+)", head).group(1))
    properties = re.findall(rb"property (\w+) \w+\n", head.split(b"element face")[0])
    assert set(properties) == {b"float"}, properties
    return np.frombuffer(body, "<f4", count * len(properties)).reshape(count, -1)[:, :3]


def extras(glb):
    """What the only mesh of a GLB says of itself."""
    data = glb.read_bytes()
    (size,) = struct.unpack_from("<I", data, 12)
    return json.loads(data[20:20 + size])["meshes"][0]["extras"]["pliant"]


def table_weights(pliant, weights):
    """Morph weights as formats/SPEC.md defines them."""
    table, is_layers = pliant["pose_table"], pliant.get("blend") == "layers"
    w = np.array(weights, float) / (1 if is_layers else sum(weights))
    centres = np.reshape(table["centres"], (-1, len(w)))
    features = np.concatenate([np.linalg.norm(centres - w, axis=1) ** 3, [1.0] * is_layers, w])
    return features @ np.reshape(table["coefficients"], (len(features), -1))


def compare(what, found, expected, tolerance):
    error = np.abs(np.asarray(found) - expected).max() / np.ptp(expected)
    print(f"{what}: {error:.1e} of the size, {tolerance:.1e} allowed")
    assert error <= tolerance
