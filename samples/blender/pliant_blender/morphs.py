"""Drives meshes without the package: d shape keys, which are the morph targets of `pliant export`, and the table in that
file from pose weights to morph weights, evaluated by drivers. The mathematics are those of samples/README.md."""
import json
import string
import struct

import bpy
import numpy as np

from . import drive, shapes

FUNCTION = "pliant_weight"
# One driver variable for each weight. An expression has at most 256 characters, and there may be 64 weights.
VARIABLES = [*string.ascii_letters, *(letter + "0" for letter in string.ascii_letters)]
tables = {}  # by identity: arrays of a table
computed = {}  # by identity: the last weights and their morph weights


def read_glb(path):
    """[n, 3] base, [d, n, 3] targets, [d] morph weights of the first shape, and the extras of a file of `pliant export`,
    which has one primitive of float32."""
    blob = path.read_bytes()
    size = struct.unpack_from("<I", blob, 12)[0]
    document, start = json.loads(blob[20:20 + size]), 28 + size
    primitive = document["meshes"][0]["primitives"][0]
    count = primitive["extras"]["pliant"]["vertex_count"] if "extras" in primitive else None

    def positions(attributes):
        view = document["bufferViews"][document["accessors"][attributes["POSITION"]]["bufferView"]]
        values = np.frombuffer(blob, "<f4", view["byteLength"] // 4, start + view["byteOffset"]).reshape(-1, 3)
        return shapes.z_up(values[:count])  # without the two corners of a box

    mesh, targets = document["meshes"][0], np.array([positions(target) for target in primitive["targets"]])
    return positions(primitive["attributes"]), targets, np.array(mesh["weights"]), mesh["extras"]["pliant"]


def add_keys(thing, path):
    """Adds keys and drivers; returns the table as JSON. Where no driver runs, Blender sets all keys to 0: their base is the
    first shape."""
    base, targets, first, extras = read_glb(path)
    base = (base + np.tensordot(first, targets, 1)).astype(np.float32)
    thing.data.vertices.foreach_set("co", base.ravel())
    thing.shape_key_add(name="Basis", from_mix=False)
    for j, target in enumerate(targets):
        key = thing.shape_key_add(name=f"Pliant {j}", from_mix=False)
        key.slider_min, key.slider_max = -10, 10  # the table may leave 0 to 1 a little
        key.data.foreach_set("co", (base + target).ravel())
        add_driver(thing, key, j)
    thing.data.update()
    return json.dumps({"layers": extras.get("blend") == "layers", "first": first.tolist(), **extras["pose_table"]})


def add_driver(thing, key, j):
    driver = key.driver_add("value").driver
    driver.type, driver.use_self = "SCRIPTED", True
    names = VARIABLES[:len(thing.data.pliant.weights)]
    for name, weight in zip(names, thing.data.pliant.weights):
        drive.add_variable(driver, name, thing, drive.property_path(weight.name))
    # In tuples, since Blender without Auto Run refuses calls with more than 30 arguments.
    groups = ", ".join(f"({','.join(names[i:i + 25])},)" for i in range(0, len(names), 25))
    driver.expression = f"{FUNCTION}(self, {j}, {groups})"


def morph_weights(state, weights):
    """[d], less those of the first shape."""
    if state.identity not in tables:
        table = json.loads(state.table)
        centres = np.reshape(table["centres"], (-1, len(weights)))
        rows = len(centres) + table["layers"] + len(weights)
        tables[state.identity] = table["layers"], centres, np.reshape(table["coefficients"], (rows, -1)), table["first"]
    layers, centres, coefficients, first = tables[state.identity]
    w = np.array(weights) if layers else drive.shares(weights)
    features = np.concatenate([np.linalg.norm(centres - w, axis=1) ** 3, [1] * layers, w])
    return features @ coefficients - first


def driver_function(key, j, *groups):
    """The value of shape key j. All of a mesh are computed at once, for the first that asks."""
    state, weights = key.id_data.user.pliant, sum(groups, ())
    if computed.get(state.identity, (None, None))[0] != weights:
        computed[state.identity] = weights, morph_weights(state, weights)
    return computed[state.identity][1][j]


@bpy.app.handlers.persistent
def add_function(*_):
    """Blender empties the namespace when it opens a file."""
    bpy.app.driver_namespace[FUNCTION] = driver_function


def register():
    add_function()
    bpy.app.handlers.load_post.append(add_function)


def unregister():
    bpy.app.handlers.load_post.remove(add_function)
    bpy.app.driver_namespace.pop(FUNCTION, None)
