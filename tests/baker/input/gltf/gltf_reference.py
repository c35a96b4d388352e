"""A second, independent evaluator of glTF files with numpy: what the specification says, in the plainest way. No Draco,
no sparse data."""
import base64
import json
import pathlib
import struct

import numpy as np

DTYPES = {5120: np.int8, 5121: np.uint8, 5122: np.int16, 5123: np.uint16, 5125: np.uint32, 5126: np.float32}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}


class File:
    def __init__(self, path):
        path, data = pathlib.Path(path), pathlib.Path(path).read_bytes()
        blob = b""
        if data[:4] == b"glTF":
            size = struct.unpack("<I", data[12:16])[0]
            self.json, blob = json.loads(data[20:20 + size]), data[28 + size:]
        else:
            self.json = json.loads(data)
        self.buffers = []
        for buffer in self.json["buffers"]:
            uri = buffer.get("uri")
            if uri is None:
                self.buffers.append(blob)
            else:
                self.buffers.append(base64.b64decode(uri.split(",", 1)[1]) if uri.startswith("data:")
                                    else (path.parent / uri).read_bytes())

    def numbers(self, index):
        accessor = self.json["accessors"][index]
        view, dtype, width = (self.json["bufferViews"][accessor["bufferView"]], DTYPES[accessor["componentType"]],
                              WIDTHS[accessor["type"]])
        start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        item = np.dtype(dtype).itemsize
        rows = np.ndarray((accessor["count"], width), dtype, self.buffers[view["buffer"]], start,
                          (view.get("byteStride", item * width), item))
        rows = rows.astype(np.float64)
        return rows / np.iinfo(dtype).max if accessor.get("normalized") else rows


def rotation_matrix(q):
    x, y, z, w = q / np.linalg.norm(q)
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                     [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                     [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])


def slerp(a, b, t):
    a, b = a / np.linalg.norm(a), b / np.linalg.norm(b)
    cosine = a @ b
    if cosine < 0:
        b, cosine = -b, -cosine
    angle = np.arccos(min(cosine, 1.0))
    if angle < 1e-9:
        return a
    return (np.sin((1 - t) * angle) * a + np.sin(t * angle) * b) / np.sin(angle)


def sample(times, values, interpolation, seconds, is_rotation):
    """values: keys x width; of cubic splines keys x 3 x width."""
    if interpolation == "CUBICSPLINE":
        keys = values[:, 1]
    else:
        keys = values
    if seconds <= times[0]:
        return keys[0]
    if seconds >= times[-1]:
        return keys[-1]
    i = int(np.searchsorted(times, seconds, side="right")) - 1
    span = times[i + 1] - times[i]
    t = (seconds - times[i]) / span
    if interpolation == "STEP":
        return keys[i]
    if interpolation == "CUBICSPLINE":
        return ((2 * t ** 3 - 3 * t ** 2 + 1) * keys[i] + span * (t ** 3 - 2 * t ** 2 + t) * values[i, 2]
                + (-2 * t ** 3 + 3 * t ** 2) * keys[i + 1] + span * (t ** 3 - t ** 2) * values[i + 1, 0])
    if is_rotation:
        return slerp(keys[i], keys[i + 1], t)
    return (1 - t) * keys[i] + t * keys[i + 1]


def local_matrices(file, animation, seconds):
    nodes = file.json["nodes"]
    parts = [{"translation": np.array(n.get("translation", [0, 0, 0]), float),
              "rotation": np.array(n.get("rotation", [0, 0, 0, 1]), float),
              "scale": np.array(n.get("scale", [1, 1, 1]), float)} for n in nodes]
    weights = {}
    for channel in (animation or {}).get("channels", []):
        sampler, node, path = animation["samplers"][channel["sampler"]], channel["target"]["node"], channel["target"]["path"]
        times, values = file.numbers(sampler["input"])[:, 0], file.numbers(sampler["output"])
        interpolation = sampler.get("interpolation", "LINEAR")
        shape = (len(times), 3, -1) if interpolation == "CUBICSPLINE" else (len(times), -1)
        value = sample(times, values.reshape(shape), interpolation, seconds, path == "rotation")
        if path == "weights":
            weights[node] = value
        else:
            parts[node][path] = value
    matrices = []
    for node, part in zip(nodes, parts):
        m = np.eye(4)
        m[:3, :3], m[:3, 3] = rotation_matrix(part["rotation"]) * part["scale"], part["translation"]
        matrices.append(np.array(node["matrix"], float).reshape(4, 4).T if "matrix" in node else m)
    return matrices, weights


def world_matrices(file, local):
    parent = {child: i for i, node in enumerate(file.json["nodes"]) for child in node.get("children", [])}

    def world(i):
        return (world(parent[i]) if i in parent else np.eye(4)) @ local[i]
    return [world(i) for i in range(len(local))]


def shown(file):
    found, waiting = set(), list(file.json["scenes"][file.json.get("scene", 0)]["nodes"])
    while waiting:
        node = waiting.pop()
        found.add(node)
        waiting += file.json["nodes"][node].get("children", [])
    return sorted(found)


def skin_matrices(file, skin, world):
    skin = file.json["skins"][skin]
    inverse = file.numbers(skin["inverseBindMatrices"]).reshape(-1, 4, 4).transpose(0, 2, 1)
    return np.array([world[joint] @ inverse[k] for k, joint in enumerate(skin["joints"])])


def positions(file, animation=None, seconds=0.0, target=None):
    """n x 3: the scene at rest (morph weights 0), with one target at 1, or in an animation."""
    chosen = next((a for a in file.json.get("animations", []) if a.get("name") == animation), None)
    local, weights = local_matrices(file, chosen, seconds)
    world = world_matrices(file, local)
    out = []
    for i in shown(file):
        node = file.json["nodes"][i]
        if "mesh" not in node:
            continue
        mesh = file.json["meshes"][node["mesh"]]
        for primitive in mesh["primitives"]:
            names = mesh.get("extras", {}).get("targetNames",
                                               [f"target_{k + 1}" for k in range(len(primitive.get("targets", [])))])
            at_rest = (node.get("weights", mesh.get("weights", [0] * len(names))) if chosen
                       else [float(name == target) for name in names])
            p = file.numbers(primitive["attributes"]["POSITION"])
            for w, t in zip(weights.get(i, at_rest), primitive.get("targets", [])):
                p = p + w * file.numbers(t["POSITION"])
            p = np.c_[p, np.ones(len(p))]
            if "skin" in node:
                joints, share = (file.numbers(primitive["attributes"]["JOINTS_0"]).astype(int),
                                 file.numbers(primitive["attributes"]["WEIGHTS_0"]))
                share = share / share.sum(1, keepdims=True)
                matrices = np.einsum("vk,vkij->vij", share, skin_matrices(file, node["skin"], world)[joints])
                p = np.einsum("vij,vj->vi", matrices, p)
            else:
                p = p @ world[i].T
            out.append(p[:, :3])
    return np.concatenate(out)
