"""Run by Blender: imports a GLB and prints what it got. FILE.glb [RECIPE.py] comes behind `--`; the recipe's set_poses then
sets the shape keys for the weights 0.5, 0.25, 0, ..."""
import json
import sys

import numpy

numpy.bool = bool  # Debian 12's glTF add-on is older than its numpy
import bpy  # noqa: E402

bpy.ops.object.select_all(action="SELECT")
bpy.ops.object.delete()
arguments = sys.argv[sys.argv.index("--") + 1:]
bpy.ops.import_scene.gltf(filepath=arguments[0], merge_vertices=False)
mesh = next(thing for thing in bpy.data.objects if thing.type == "MESH")
keys = mesh.data.shape_keys
report = {"vertices": len(mesh.data.vertices), "faces": len(mesh.data.polygons)}
report["materials"] = [slot.material.name if slot.material else None for slot in mesh.material_slots]
report["images"] = [[image.name, *image.size] for image in bpy.data.images if image.size[0]]
report["places"] = len(mesh.data.uv_layers)
if keys:
    report["targets"] = len(keys.key_blocks) - 1
    report["names"] = [key.name for key in keys.key_blocks][1:]
    report["values"] = [key.value for key in keys.key_blocks][1:]
    action = keys.animation_data.action if keys.animation_data and keys.animation_data.action else None
    if not action and keys.animation_data and keys.animation_data.nla_tracks:
        action = keys.animation_data.nla_tracks[0].strips[0].action
    report["curves"] = len(action.fcurves) if action else 0
    keys.animation_data_clear()
    for key in list(keys.key_blocks)[1:]:
        key.value = 0.5
    evaluated = mesh.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()
    report["middle"] = [list(mesh.matrix_world @ vertex.co) for vertex in evaluated.vertices]
    if len(arguments) > 1:
        exec(open(arguments[1]).read())
        pliant = mesh.data["pliant"]
        set_poses(mesh, [0.5, 0.25] + [0] * (len(pliant.get("layers", pliant["poses"])) - 2))  # noqa: F821
        report["driven"] = [key.value for key in keys.key_blocks][1:]
print("REPORT " + json.dumps(report))
