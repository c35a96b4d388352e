"""Drives meshes by d shape keys, which are the morph targets of `pliant export`. Drivers give them the reduced coordinates
that the Python package pliant solves for, or, where it is not installed, those of the table in that file, whose mathematics
are in samples/README.md."""
import functools
import importlib
import json
import string
import struct

import bpy
import numpy as np

from . import shapes, sliders

FUNCTION = "pliant_weight"
SCALE = 100  # of keys: Blender holds their values within -10 and 10, which those of targets leave beyond the sliders' ranges
# One driver variable for each weight. An expression has at most 256 characters, and there may be 64 weights.
VARIABLES = [*string.ascii_letters, *(letter + "0" for letter in string.ascii_letters)]
solvers = {}  # by the identity of an asset: weights to the values of its keys
refusals = {}  # by the identity of an asset: why the package does not open it


@functools.cache
def package():
    """The module, or None where it is not installed, or not for this Python."""
    try:
        module = importlib.import_module("pliant")
    except Exception:
        return None
    return module if hasattr(module, "Asset") else None  # a folder of this name


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
        key.slider_min, key.slider_max = -10, 10
        key.data.foreach_set("co", (base + SCALE * target).ravel())
        add_driver(thing, key, j)
    thing.active_shape_key_index = 0  # edit mode shows this one
    thing.data.update()
    return json.dumps({"layers": extras.get("blend") == "layers", "first": first.tolist(), "q_min": extras["q_min"],
                       "q_max": extras["q_max"], **extras["pose_table"]})


def add_driver(thing, key, j):
    driver = sliders.add_driver(key, "value")
    driver.type, driver.use_self = "SCRIPTED", True
    names = VARIABLES[:len(thing.data.pliant.weights)]
    for name, weight in zip(names, thing.data.pliant.weights):
        sliders.add_variable(driver, name, thing, sliders.property_path(weight.name))
    # In tuples, since Blender without Auto Run refuses calls with more than 30 arguments.
    groups = ", ".join(f"({','.join(names[i:i + 25])},)" for i in range(0, len(names), 25))
    driver.expression = f"{FUNCTION}(self, {j}, {groups})"


def drivers(mesh):
    """Of its shape keys; people may have removed some."""
    animation = mesh.shape_keys and mesh.shape_keys.animation_data
    return [curve.driver for curve in animation.drivers] if animation else []


def driving_object(mesh):
    """The one whose sliders move the keys of the mesh, which other objects may share; None if it is gone."""
    variable = next((each for driver in drivers(mesh) for each in driver.variables), None)
    return variable.targets[0].id if variable else None


def why_approximate(state):
    """A text for people; empty if the package solves."""
    return refusals.get(state.identity, "") if package() else "the Python package pliant is not installed for this Python"


def solver(state):
    """The function from weights to the values of all shape keys: exact if the package opens the asset."""
    table = json.loads(state.table)
    asset = open_asset(state) if package() else None
    solve = of_asset(asset, table) if asset else of_table(table, len(state.weights))
    first = np.array(table["first"])
    return functools.lru_cache(64)(lambda weights: (solve(weights if table["layers"] else shares(weights)) - first) / SCALE)


def open_asset(state):
    try:
        return package().Asset.open(state.asset)
    except package().Error as error:  # a package that is older than the tool
        refusals[state.identity] = str(error)


def of_asset(asset, table):
    low, high = np.array(table["q_min"]), np.array(table["q_max"])
    width = np.where(high > low, high - low, np.inf)  # a target that moves nothing
    return lambda weights: (asset.coordinates(weights) - low) / width


def of_table(table, count):
    centres = np.reshape(table["centres"], (-1, count))
    rows = len(centres) + table["layers"] + count
    coefficients = np.reshape(table["coefficients"], (rows, -1))

    def solve(weights):
        distances = np.linalg.norm(centres - np.array(weights), axis=1)
        return np.concatenate([distances ** 3, [1] * table["layers"], weights]) @ coefficients
    return solve


def shares(weights):
    """Of an average, with the sum 1: a negative weight counts as 0, and weights that are all 0 count as equal."""
    positive = np.maximum(weights, 0)
    positive = positive if positive.any() else np.ones(len(positive))
    return positive / positive.sum()


def driver_function(key, j, *groups):
    """The value of shape key j. All of a mesh are computed at once, for the first that asks."""
    state = key.id_data.user.pliant
    if state.identity not in solvers:
        solvers[state.identity] = solver(state)
    return solvers[state.identity](sum(groups, ()))[j]


@bpy.app.handlers.persistent
def add_function(*_):
    """Blender empties the namespace when it opens a file."""
    bpy.app.driver_namespace[FUNCTION] = driver_function


def revive_drivers():
    """Of a file that was open before the add-on was turned on: Blender gives up a driver whose function is not there."""
    for driver in (driver for mesh in bpy.data.meshes if mesh.pliant.table for driver in drivers(mesh)):
        driver.expression = driver.expression


def register():
    add_function()
    bpy.app.handlers.load_post.append(add_function)
    bpy.app.timers.register(revive_drivers)  # while add-ons are registered, there is no access to the file


def unregister():
    if bpy.app.timers.is_registered(revive_drivers):
        bpy.app.timers.unregister(revive_drivers)
    bpy.app.handlers.load_post.remove(add_function)
    bpy.app.driver_namespace.pop(FUNCTION, None)
    for each in (solvers, refusals):
        each.clear()
