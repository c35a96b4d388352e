"""What the cases of inside.py share: the driven object, comparison with `pliant blend`, errors."""
import json
import pathlib
import struct
import subprocess
import sys

import bpy
import numpy as np

from tubes import activate, make_tube, tube

CASE, ZIP, TOOL, FOLDER = sys.argv[sys.argv.index("--") + 1:]
FOLDER = pathlib.Path(FOLDER)
# As of a part of a glTF file; with a slash, an equals sign, letters beyond ASCII.
NAMES = ["x.glb#bend", "twist/turn", "\u0431\u0443\u043b\u0430=1"]
FILES = [name.replace("/", "\u2215").replace("#", "\uff03") for name in NAMES]


def check(condition, text):
    if not condition:
        raise AssertionError(text)


# ---------------------------------------------------------------------------------------------------------------- the scene

def make_layers():
    thing = make_tube(*zip(NAMES, (tube(bend=1.8), tube(twist=1.5), tube(bulge=0.6))))
    keys = thing.data.shape_keys.key_blocks
    keys[NAMES[1]].slider_min, keys[NAMES[1]].value = -0.5, 0.25
    thing.data.uv_layers.new(name="UVMap")
    thing.vertex_groups.new(name="group").add([5], 1, "REPLACE")
    return thing


def bake(**options):
    """The driven object."""
    check(bpy.ops.pliant.bake(**{"preview": True, **options}) == {"FINISHED"}, "the bake")
    return bpy.context.object


def bake_layers(**options):
    origin = make_layers()
    origin.show_only_shape_key = True  # pinned, as artists leave it
    thing = bake(**options)
    check([weight.name for weight in thing.data.pliant.weights] == NAMES, "names of layers")
    check([round(thing[name], 6) for name in NAMES] == [0, 0.25, 0], f"values of sliders: {[thing[n] for n in NAMES]}")
    limits = thing.id_properties_ui(NAMES[1]).as_dict()
    check((limits["soft_min"], limits["soft_max"]) == (-0.5, 1), f"the range of the slider: {limits}")
    check({"UVMap"} == {each.name for each in thing.data.uv_layers} and thing.data.vertices[5].groups, "layers of the mesh")
    check(not origin.visible_get() and origin.data.shape_keys, "the origin is hidden, as it was")
    report = json.loads(subprocess.run([TOOL, "info", "--json", write(thing)], capture_output=True, check=True).stdout)
    found = json.dumps(report, ensure_ascii=False)
    check(all(name in found for name in FILES), f"names in the asset: {found[:2000]}")
    return thing


def set_weights(thing, *weights):
    for weight, value in zip(thing.data.pliant.weights, weights):
        thing[weight.name] = float(value)
    thing.update_tag()
    bpy.context.view_layer.update()


def animate_slider(thing, name, *pairs):
    for frame, value in pairs:
        thing[name] = float(value)
        thing.keyframe_insert(f'["{name}"]', frame=frame)


# --------------------------------------------------------------------------------------------------------------- comparison

def coordinates(vertices):
    flat = np.empty(3 * len(vertices), np.float32)
    vertices.foreach_get("co", flat)
    return flat.reshape(-1, 3)


def shown(thing):
    """The vertices that are drawn."""
    return coordinates(thing.evaluated_get(bpy.context.evaluated_depsgraph_get()).data.vertices)


def blended(asset, weights):
    """What `pliant blend` says, in Blender's axes."""
    output = FOLDER / "blend.ply"
    subprocess.run([TOOL, "blend", asset, "--weights=" + ",".join(map(str, weights)), "-o", output], check=True,
                   capture_output=True)
    blob = output.read_bytes()
    start = blob.index(b"end_header\n") + len(b"end_header\n")
    count = int(blob[:start].split(b"element vertex ")[1].split()[0])
    x, y, z = np.frombuffer(blob, "<f4", 3 * count, start).reshape(-1, 3).T
    return np.stack([x, -z, y], axis=1)


def check_shape(thing, asset, weights, limit=1e-5):
    difference = abs(shown(thing) - blended(asset, weights)).max()
    check(difference <= limit, f"{thing.name} at {weights} differs by {difference} from pliant blend")
    return difference


def write(thing, name="out.pliant", kind="ASSET"):
    activate(thing)
    path = FOLDER / name
    check(bpy.ops.pliant.export(filepath=str(path), kind=kind) == {"FINISHED"} and path.stat().st_size > 1000, name)
    return path


def glb_json(path):
    blob = path.read_bytes()
    return json.loads(blob[20:20 + struct.unpack_from("<I", blob, 12)[0]])


# ------------------------------------------------------------------------------------------------------------------ add-on

def addon(name):
    return sys.modules[f"pliant_blender.{name}"]


def preferences():
    return bpy.context.preferences.addons["pliant_blender"].preferences


def last_message():
    return addon("bake").PLIANT_OT_bake.message


def contents():
    return [sorted(each.name for each in kind) for kind in (bpy.data.objects, bpy.data.meshes, bpy.data.shape_keys)]


def check_error(wanted, **options):
    before = contents()
    try:
        bpy.ops.pliant.bake(**{"preview": True, **options})
        raise AssertionError(f"no error, expected {wanted}")
    except RuntimeError as error:
        check(wanted in str(error), f"{error}, expected {wanted}")
    check(wanted in last_message(), f"the panel says {last_message()}")
    check(contents() == before, "the error left something")
