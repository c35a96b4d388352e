#!/usr/bin/env python3
"""Draws the pictures of README.md: make_pictures.py CREATURE TOOL PACKAGES FOLDER

Bakes the poses of the program CREATURE (samples/creature) in Blender with the add-on and takes pictures of its window, under
Xvfb, with Mesa's software drawing. PACKAGES is a folder with the Python package pliant. Needs blender, xvfb-run and Pillow.
"""
import os
import pathlib
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
POSES = ["rest", "reach", "curl", "leap", "twist"]
WEIGHTS = {"rest": 0.0, "reach": 0.0, "curl": 0.5, "leap": 0.0, "twist": 0.5}
TAB = (13, 216)  # of the add-on in the sidebar, from the upper right of the viewport


# ---------------------------------------------------------------------------------------------------------- outside Blender

def main(creature, tool, packages, output):
    from PIL import Image
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        subprocess.run([creature, "-o", folder, "--vertices", "8000"], check=True)
        subprocess.run([sys.executable, HERE / "build.py", folder / "pliant_blender.zip"], check=True)
        (folder / "addons/modules").mkdir(parents=True)
        (folder / "addons/modules/pliant").symlink_to(pathlib.Path(packages, "pliant").resolve())
        environment = {**os.environ, "LIBGL_ALWAYS_SOFTWARE": "1", "BLENDER_USER_SCRIPTS": name, "BLENDER_USER_CONFIG": name}
        subprocess.run(["xvfb-run", "-a", "-s", "-screen 0 1280x800x24", "blender", "--factory-startup",
                        "--enable-event-simulate", "--python", __file__, "--", folder, tool], check=True, env=environment)
        for picture in ("blender_bake", "blender_driven"):
            with Image.open(folder / f"{picture}.png") as image:
                upper = image.convert("RGB").crop((0, 0, image.width, 500))
                upper.save(pathlib.Path(output, f"{picture}.webp"), quality=85, method=6)
    return 0


# ----------------------------------------------------------------------------------------------------------- inside Blender

def read_ply(path):
    import numpy as np
    blob = path.read_bytes()
    start = blob.index(b"end_header\n") + len(b"end_header\n")
    counts = [int(line.split()[2]) for line in blob[:start].split(b"\n") if line.startswith(b"element")]
    positions = np.frombuffer(blob, "<f4", 3 * counts[0], start).reshape(-1, 3)
    face = np.dtype([("count", "u1"), ("corners", "<i4", 3)])
    faces = np.frombuffer(blob, face, counts[1], start + positions.nbytes)["corners"]
    return positions, faces


def make_scene(folder):
    import bpy
    shapes = [read_ply(folder / f"creature_{pose}.ply") for pose in POSES]
    mesh = bpy.data.meshes.new("dragon")
    mesh.from_pydata(shapes[0][0].tolist(), [], shapes[0][1].tolist())
    mesh.polygons.foreach_set("use_smooth", [True] * len(mesh.polygons))
    thing = bpy.data.objects.new("dragon", mesh)
    bpy.context.scene.collection.objects.link(thing)
    for pose, (positions, _) in zip(POSES, shapes):
        thing.shape_key_add(name=pose, from_mix=False).data.foreach_set("co", positions.ravel())
    bpy.ops.object.select_all(action="DESELECT")
    bpy.context.view_layer.objects.active = thing
    thing.select_set(True)
    thing.pliant.blend, thing.pliant.preview = "AVERAGE", True
    return thing


def steps(folder, tool):
    import bpy
    bpy.context.preferences.view.show_splash = False
    bpy.ops.object.select_all(action="SELECT")
    bpy.ops.object.delete()
    bpy.ops.preferences.addon_install(filepath=str(folder / "pliant_blender.zip"))
    bpy.ops.preferences.addon_enable(module="pliant_blender")
    bpy.context.preferences.addons["pliant_blender"].preferences.tool = tool
    thing = make_scene(folder)
    area = show_viewport()
    yield
    click = ("MOUSEMOVE", "NOTHING"), ("LEFTMOUSE", "PRESS"), ("LEFTMOUSE", "RELEASE")
    for kind, value in click * 2:  # the first click closes the splash screen
        bpy.context.window.event_simulate(type=kind, value=value, x=area.x + area.width - TAB[0],
                                          y=area.y + area.height - TAB[1])
        yield
    with bpy.context.temp_override(window=bpy.context.window, area=area, region=area.regions[-1]):
        bpy.ops.pliant.bake("INVOKE_DEFAULT", blend="AVERAGE", preview=True)
    bake = sys.modules["pliant_blender.bake"].PLIANT_OT_bake
    while bake.job and bake.job.run.percent < 50:
        yield
    save(area, folder / "blender_bake.png")
    while bake.job:
        yield
    place(thing, bpy.context.object, area.spaces.active.region_3d)
    for _ in range(3):
        yield
    save(area, folder / "blender_driven.png")


def place(linear, elastic, view):
    """The linear blend of the shape keys, on the left, beside the elastic one."""
    import bpy
    from mathutils import Vector
    linear.hide_set(False)
    for name, weight in WEIGHTS.items():
        elastic[name] = weight
        linear.data.shape_keys.key_blocks[name].value = weight
    right = view.view_rotation @ Vector((4.2, 0, 0))
    linear.location -= 1.5 * right
    elastic.location += 0.3 * right
    elastic.update_tag()
    bpy.context.view_layer.update()


def show_viewport():
    import bpy
    from mathutils import Euler
    area = next(area for area in bpy.context.window.screen.areas if area.type == "VIEW_3D")
    space = area.spaces.active
    space.show_region_ui, space.show_region_toolbar, space.show_gizmo = True, False, False
    overlay = space.overlay
    overlay.show_floor = overlay.show_axis_x = overlay.show_axis_y = overlay.show_cursor = overlay.show_text = False
    overlay.show_outline_selected = False
    space.region_3d.view_rotation = Euler((1.05, 0, 0.35)).to_quaternion()
    space.region_3d.view_distance = 17
    return area


def save(area, path):
    import bpy
    with bpy.context.temp_override(window=bpy.context.window, area=area):
        bpy.ops.screen.screenshot_area(filepath=str(path))


def inside():
    import bpy
    folder, tool = sys.argv[sys.argv.index("--") + 1:]
    running = steps(pathlib.Path(folder), tool)

    def step():
        try:
            next(running)
            return 0.2
        except StopIteration:
            os._exit(0)

    bpy.app.timers.register(step)


if __name__ == "__main__":
    if "--" in sys.argv:
        inside()
    elif len(sys.argv) != 5:
        sys.exit(__doc__)
    else:
        sys.exit(main(*sys.argv[1:]))
