"""What the tests of `pliant export` share: GLB files read with numpy and nothing else, node with its packages, skipping."""
import fcntl
import json
import pathlib
import shutil
import struct
import subprocess
import sys

import numpy as np

HERE = pathlib.Path(__file__).parent
SKIPPED = 77
COMPONENTS = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}


def skip(reason):
    print(f"skipped: {reason}")
    sys.exit(SKIPPED)


def check(condition, text):
    if not condition:
        print(f"FAILED: {text}")
        sys.exit(1)


class Glb:
    """A GLB: .json, .binary, and .start, the file offset of the binary chunk."""

    def __init__(self, path):
        self.path = pathlib.Path(path)
        blob = self.path.read_bytes()
        magic, version, total, size, kind = struct.unpack_from("<4sIII4s", blob)
        check((magic, version, total, kind) == (b"glTF", 2, len(blob), b"JSON"), f"{path}: not a GLB")
        self.json = json.loads(blob[20:20 + size])
        length, kind = struct.unpack_from("<I4s", blob, 20 + size)
        self.start = 28 + size
        check(kind == b"BIN\0" and self.start + length == total, f"{path}: binary chunk")
        self.binary = blob[self.start:]

    def view(self, index):
        view = self.json["bufferViews"][index]
        return self.binary[view["byteOffset"]:view["byteOffset"] + view["byteLength"]]

    def accessor(self, index):
        """[count, width] as stored, bounds compared with the accessor's."""
        entry = self.json["accessors"][index]
        width, kind = WIDTHS[entry["type"]], np.dtype(COMPONENTS[entry["componentType"]])
        stride = self.json["bufferViews"][entry["bufferView"]].get("byteStride", width * kind.itemsize)
        values = np.ndarray((entry["count"], width), kind, self.view(entry["bufferView"]),
                            strides=(stride, kind.itemsize))
        if "min" in entry:
            check((values.min(axis=0) == entry["min"]).all() and (values.max(axis=0) == entry["max"]).all(),
                  f"{self.path}: bounds of accessor {index}")
        return values

    def primitive(self):
        return self.json["meshes"][0]["primitives"][0]

    def own_count(self):
        """Vertices that are the asset's; behind them lie two corners of a box."""
        primitive = self.primitive()
        count = self.json["accessors"][primitive["attributes"]["POSITION"]]["count"]
        return primitive.get("extras", {}).get("pliant", {}).get("vertex_count", count)

    def attribute(self, name, target=None):
        """Of the asset's vertices; positions of integers are in the steps of the node's scale."""
        primitive = self.primitive()
        index = (primitive["attributes"] if target is None else primitive["targets"][target])[name]
        values = self.accessor(index)[:self.own_count()]
        scale = np.iinfo(values.dtype).max if self.json["accessors"][index].get("normalized") else 1
        return values / float(scale)

    def placed(self, positions):
        """Positions by the place of the node."""
        node = self.json["nodes"][0]
        return positions * node.get("scale", [1, 1, 1]) + node.get("translation", [0, 0, 0])

    def shape(self, weights, name="POSITION"):
        """As glTF defines morph targets: base + sum_j w_j target_j."""
        result = self.attribute(name)
        for j, weight in enumerate(weights):
            result = result + weight * self.attribute(name, j)
        return result


def weight_count(pliant):
    """Of the extras of a mesh."""
    return len(pliant["layers" if pliant.get("blend") == "layers" else "poses"])


def export(tool, asset, output, *options, code=0):
    result = subprocess.run([tool, "export", asset, "-o", output, *options], capture_output=True, text=True, timeout=120)
    check(result.returncode == code, f"export {asset}: exit code {result.returncode}\n{result.stdout}{result.stderr}")
    return result


def node_modules(folder, source=HERE):
    """The folder with node_modules of the package-lock.json of `source`, installed there if they are not yet; skips where
    that cannot be."""
    if not shutil.which("node") or not shutil.which("npm"):
        skip("node and npm are not installed (group engines of samples/install_packages.sh)")
    folder = pathlib.Path(folder) / "node"
    folder.mkdir(parents=True, exist_ok=True)
    with open(folder / ".lock", "w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        wanted = (source / "package-lock.json").read_text()
        stamp = folder / "installed"
        if not stamp.exists() or stamp.read_text() != wanted:
            for name in ("package.json", "package-lock.json"):
                shutil.copy(source / name, folder / name)
            command = ["npm", "ci", "--no-audit", "--no-fund", "--ignore-scripts", "--fetch-retries=0",
                       "--fetch-timeout=30000"]
            try:
                result = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=200)
            except subprocess.TimeoutExpired:
                skip("npm ci takes too long: no way to the npm registry?")
            if result.returncode:
                skip(f"npm ci cannot fetch the packages: {result.stderr.strip()[-300:]}")
            stamp.write_text(wanted)
    return folder


def run_node(folder, script, *arguments, timeout=100):
    """Runs a script of this folder with the packages of node_modules(folder), which `import` finds next to it."""
    modules = node_modules(folder)
    shutil.copy(HERE / script, modules / script)
    result = subprocess.run(["node", modules / script, *map(str, arguments)], capture_output=True, text=True,
                            timeout=timeout)
    if result.returncode == SKIPPED:
        skip(result.stdout.strip())
    check(result.returncode == 0, f"{script}: exit code {result.returncode}\n{result.stdout}{result.stderr}")
    return result.stdout


def blender():
    """The program, or None."""
    return shutil.which("blender")


def blender_report(program, glb, *recipe):
    """What Blender makes of a GLB: blender_check.py."""
    result = subprocess.run([program, "--background", "--factory-startup", "--python-exit-code", "9", "--python",
                             HERE / "blender_check.py", "--", glb, *recipe], capture_output=True, text=True, timeout=300)
    lines = [line for line in result.stdout.splitlines() if line.startswith("REPORT ")]
    check(result.returncode == 0 and lines, f"exit code {result.returncode}: {result.stdout[-2000:]}{result.stderr[-2000:]}")
    return json.loads(lines[0][len("REPORT "):])
