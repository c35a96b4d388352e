"""What the pipeline tests share: small poses, the tool, and a list of what failed."""
import base64
import json
import math
import os
import pathlib
import struct
import subprocess
import sys

# A bake of a second at most: few dimensions, elements and checks.
QUICK = {"dim": 3, "elements": 18, "check_samples": 2, "fresh_samples": 0, "threads": 1}
QUICK_OPTIONS = ["--dim", "3", "--elements", "18", "--check-samples", "2", "--fresh-samples", "0", "--threads", "1"]
failures = []


def check(condition, text):
    print(("ok      " if condition else "FAILED  ") + text, flush=True)
    if not condition:
        failures.append(text)


def finish():
    print(f"{len(failures)} failures")
    sys.exit(1 if failures else 0)


class Tool:
    def __init__(self, path):
        self.path = str(pathlib.Path(path).resolve())

    def start(self, *arguments, **keywords):
        return subprocess.Popen([self.path, *map(str, arguments)], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                stderr=subprocess.PIPE, text=True, **keywords)

    def run(self, *arguments, cwd=None):
        return subprocess.run([self.path, *map(str, arguments)], stdin=subprocess.DEVNULL, capture_output=True, text=True,
                              timeout=300, cwd=cwd)


def has_open(process, path):
    """Whether it has the file open now."""
    try:
        return any(os.readlink(link) == str(path) for link in pathlib.Path(f"/proc/{process.pid}/fd").iterdir())
    except OSError:
        return False


def sheet(path, bend, n=5, turn=0.0):
    """An OBJ file: a strip of n x 2n squares, bent to a part of a cylinder and twisted."""
    lines = []
    for i in range(n + 1):
        for k in range(2 * n + 1):
            x, y = i / n - 0.5, k / n - 1
            z = 0.02 * math.sin(5 * x + 3 * y)
            if bend:
                y, z = math.sin(bend * y) / bend * (1 + bend * z), (1 - math.cos(bend * y)) / bend + z * math.cos(bend * y)
            angle = turn * y
            x, z = x * math.cos(angle) - z * math.sin(angle), x * math.sin(angle) + z * math.cos(angle)
            lines.append(f"v {x:.9g} {y:.9g} {z:.9g}")
    for i in range(n):
        for k in range(2 * n):
            a = i * (2 * n + 1) + k + 1
            lines.append(f"f {a} {a + 2 * n + 1} {a + 2 * n + 2} {a + 1}")
    pathlib.Path(path).write_text("\n".join(lines) + "\n", encoding="utf-8")


def poses(folder, bend=1.0, turn=0.3):
    """rest.obj and bent.obj in a folder, which is made."""
    folder.mkdir(parents=True, exist_ok=True)
    sheet(folder / "rest.obj", 0)
    sheet(folder / "bent.obj", bend, turn=turn)
    return [folder / "rest.obj", folder / "bent.obj"]


def write_gltf(path, folder):
    """A .gltf with a buffer and a picture beside it: a strip of triangles and one morph target."""
    n = 6
    rest = [(x / n, y / 2, 0.0) for x in range(n + 1) for y in range(3)]
    delta = [(0.0, 0.0, x * x) for x, y, z in rest]
    faces = [corner for i in range(n) for k in range(2) for a in [3 * i + k]
             for corner in (a, a + 3, a + 4, a, a + 4, a + 1)]
    data = b"".join(struct.pack("<3f", *v) for v in rest + delta) + struct.pack(f"<{len(faces)}H", *faces)
    (folder / "mesh data.bin").write_bytes(data)
    (folder / "skin.png").write_bytes(base64.b64decode(
        "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNk+M9QDwADhgGAWjR9awAAAABJRU5ErkJggg=="))
    size = 12 * len(rest)
    write_json(path, {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "buffers": [{"uri": "mesh%20data.bin", "byteLength": len(data)}],
        "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": size},
                        {"buffer": 0, "byteOffset": size, "byteLength": size},
                        {"buffer": 0, "byteOffset": 2 * size, "byteLength": 2 * len(faces)}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": len(rest), "type": "VEC3", "min": [0, 0, 0],
                       "max": [1, 1, 0]},
                      {"bufferView": 1, "componentType": 5126, "count": len(rest), "type": "VEC3", "min": [0, 0, 0],
                       "max": [0, 0, 1]},
                      {"bufferView": 2, "componentType": 5123, "count": len(faces), "type": "SCALAR"}],
        "images": [{"uri": "skin.png"}, {"uri": "lost.png"}], "textures": [{"source": 0}, {"source": 1}],
        "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}, "emissiveTexture": {"index": 1}}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 2, "material": 0,
                                    "targets": [{"POSITION": 1}]}]}]})


def write_json(path, value):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(value, indent=1), encoding="utf-8")
    return path


def validator(schema_folder, name):
    """A function that lists what is wrong with a value by a schema of the project; None where jsonschema is missing."""
    try:
        import jsonschema
    except ImportError:
        return None
    schemas = [json.loads(p.read_text(encoding="utf-8"))
               for p in sorted(pathlib.Path(schema_folder).glob("formats/schema/*.schema.json"))]
    schema = next(s for s in schemas if s["$id"] == name)
    jsonschema.Draft202012Validator.check_schema(schema)
    try:
        import referencing
        import referencing.jsonschema
        registry = referencing.Registry().with_resources(
            [(s["$id"], referencing.jsonschema.DRAFT202012.create_resource(s)) for s in schemas])
        judge = jsonschema.Draft202012Validator(schema, registry=registry)
    except ImportError: # before jsonschema 4.18, as in Debian 12
        resolver = jsonschema.RefResolver(name, schema, store={s["$id"]: s for s in schemas})
        judge = jsonschema.Draft202012Validator(schema, resolver=resolver)
    return lambda value: [f"{list(e.absolute_path)}: {e.message}" for e in judge.iter_errors(value)]
