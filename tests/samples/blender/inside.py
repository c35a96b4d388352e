"""Run by Blender, or by a Python with bpy: CASE ZIP TOOL FOLDER come behind `--`. See test_addon.py."""
import functools
import importlib.util
import json
import os
import sys
import traceback

import bpy
import numpy as np

sys.dont_write_bytecode = True  # beside scene.py
sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from scene import (CASE, FOLDER, NAMES, TOOL, ZIP, addon, animate_slider, bake, bake_layers, blended, check,  # noqa: E402
                   check_error, check_shape, coordinates, glb_json, last_message, make_layers, preferences, set_weights,
                   shown, write)
from tubes import SIDES, activate, make_tube, tube  # noqa: E402
from window import window  # noqa: E402


# -------------------------------------------------------------------------------------------------------------------- cases

def package():
    """Driven by the package: layers, averages, animation, files."""
    thing = bake_layers()
    asset = write(thing)
    for weights in ((1, 0, 0), (0.5, -0.4, 0.8), (5, 4, 5), (0.0005, 0, 0)):
        set_weights(thing, *weights)
        check_shape(thing, asset, weights)
    check(abs(coordinates(thing.data.vertices) - tube()).max() < 1e-3, "what is bound to the shape at rest stays there")
    set_weights(thing, 0, 1, 0)
    check(abs(shown(thing) - tube(twist=1.5)).max() < 0.01, "a layer alone at 1 is its shape key, not mirrored")
    check_duplicate(thing, asset)
    check_shared(thing)
    check_refused_asset(thing, asset)
    check_baked_again(thing)
    check_animation(thing, asset)
    check_followed_keys()
    check_empty_group()
    check_tweaked()
    check_baked_twice()
    check_simulated()
    check_average()
    check_frames()
    check_simulation()
    check_reload()


def check_duplicate(thing, asset):
    """Shift+D: each of the two has sliders of its own."""
    set_weights(thing, 0.3, 0, 0.6)
    activate(thing)
    bpy.ops.object.duplicate()
    copy = bpy.context.object
    set_weights(copy, 1, 0, 0)
    check_shape(copy, asset, (1, 0, 0))
    check_shape(thing, asset, (0.3, 0, 0.6))
    bpy.data.meshes.remove(copy.data)  # and the object
    activate(thing)


def check_shared(thing):
    """Alt+D: both objects have the shape of the one that was baked, also when it is baked again."""
    activate(thing)
    bpy.ops.object.duplicate(linked=True)
    copy = bpy.context.object
    check(addon("morphs").driving_object(copy.data) == thing, "the panel says whose sliders move the copy")
    activate(thing)
    bake()
    check(copy.data == thing.data and thing.active_shape_key_index == 0, "one mesh, which edit mode shows at rest")
    check_edited(thing, copy)
    activate(copy)
    bpy.ops.object.make_single_user(object=True, obdata=True)
    activate(copy)
    bake()
    check([addon("morphs").driving_object(each.data) for each in (thing, copy)] == [thing, copy], "each moves its own")
    bpy.data.meshes.remove(copy.data)
    activate(thing)


def check_edited(thing, other):
    """A mesh that another object edits, which Blender does not replace."""
    activate(other)
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.context.view_layer.objects.active = thing
    check_error(f"the mesh of {thing.name} is in edit mode")
    bpy.context.view_layer.objects.active = other
    bpy.ops.object.mode_set(mode="OBJECT")


def check_refused_asset(thing, asset):
    """Where the package does not open the asset, as one that is older than the tool, the table drives."""
    thing.data.pliant.identity, thing.data.pliant.asset = "newer", b"of a later version"
    set_weights(thing, 0.7, 0, 0.3)
    check("error P" in addon("morphs").why_approximate(thing.data.pliant), "the panel says why")
    check(1e-5 < check_shape(thing, asset, (0.7, 0, 0.3), 0.1), "the shape is that of the table")


def check_baked_again(thing):
    set_weights(thing, 0.75, 0, 0)
    count = len(bpy.data.objects), len(bpy.data.meshes)
    check(bake() == thing and (len(bpy.data.objects), len(bpy.data.meshes)) == count, "baked again in place")
    check(len(bpy.data.shape_keys) == 2, "shape keys of the origin and of the driven mesh")
    check(thing[NAMES[0]] == 0.75, "weights survive another bake")
    check_shape(thing, write(thing), (0.75, 0, 0))


def check_animation(thing, asset):
    animate_slider(thing, NAMES[0], (1, 0), (11, 1))
    for frame in (6, 11, 1):
        bpy.context.scene.frame_set(frame)
        value = thing.evaluated_get(bpy.context.evaluated_depsgraph_get())[NAMES[0]]
        check(abs(value - (frame - 1) / 10) < 1e-6, f"frame {frame}: {value}")
        check_shape(thing, asset, (value, 0, 0))
    check_rendered()


def check_rendered():
    """Rendering evaluates the scene by itself: its frames show the animation, and between them it is blurred."""
    scene = bpy.context.scene
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.location, camera.rotation_euler = (0.5, -6, 1), (np.pi / 2, 0, 0)
    scene.collection.objects.link(camera)
    scene.camera, scene.render.engine, scene.cycles.samples, scene.cycles.use_denoising = camera, "CYCLES", 1, False
    scene.render.resolution_x = scene.render.resolution_y = 32
    scene.render.film_transparent, scene.render.image_settings.color_mode = True, "RGBA"
    straight, bent = (np.ptp(np.nonzero(rendered(frame).max(axis=1) > 0.5)[0]) for frame in (1, 11))
    check(bent < 0.8 * straight, f"rows of pixels of the straight and of the bent tube: {straight}, {bent}")
    scene.cycles.samples, scene.render.motion_blur_shutter = 32, 2
    soft = []
    for scene.render.use_motion_blur in (False, True):
        picture = rendered(6)
        soft.append(np.count_nonzero((picture > 0.1) & (picture < 0.9)))
    check(soft[1] > 1.2 * soft[0], f"soft pixels without and with motion blur: {soft}")


def rendered(frame):
    """The alpha channel of a frame that Blender renders as one of an animation."""
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end, scene.render.filepath = frame, frame, str(FOLDER / "frame_")
    bpy.ops.render.render(animation=True)
    image = bpy.data.images.load(str(FOLDER / f"frame_{frame:04}.png"), check_existing=False)
    return np.array(image.pixels[:]).reshape(32, 32, 4)[:, :, 3]


def animate_key(key, *pairs):
    for frame, key.value in pairs:
        key.keyframe_insert("value", frame=frame)


def check_followed_keys():
    """Shape keys that are animated play on in the driven object; sliders with keyframes of their own do not follow them."""
    for in_strip in (False, True):
        origin = make_layers()
        keys = origin.data.shape_keys
        animate_key(keys.key_blocks[NAMES[2]], (1, 0), (21, 1))
        if in_strip:
            animation = keys.animation_data
            animation.nla_tracks.new().strips.new("strip", 1, animation.action)
            animation.action = None
        thing = bake()
        animate_slider(thing, NAMES[0], (1, 0), (21, 0.6))
        check_frames_of(thing, ((21, (0.6, 0.25, 1)), (1, (0, 0.25, 0))))
        animate_key(keys.key_blocks[NAMES[0]], (1, 0.3))
        activate(thing)
        check_frames_of(bake(), ((21, (0.6, 0.25, 1)), (1, (0, 0.25, 0))))
        set_weights(thing, 0, 0.75, 0)
        check_shape(thing, write(thing), (0, 0.75, 0))
        keys.key_blocks[NAMES[2]].name = "other"
        keys.key_blocks[NAMES[1]].name = NAMES[2]
        activate(thing)
        set_weights(bake(), 0, 0.5, 0)
        value = thing.evaluated_get(bpy.context.evaluated_depsgraph_get())[NAMES[2]]
        check(value == 0.5, f"the slider of a key that stands still, with the name of one that moved: {value}")
        animate_key(keys.key_blocks[NAMES[2]], (1, 0.3))
        activate(thing)
        check(len(bake().animation_data.drivers) == 2, "the layers of the two keys that are animated follow them")
        check(len(bake(blend="AVERAGE").animation_data.drivers) == 0, "sliders of an average follow nothing")


def check_frames_of(thing, frames):
    asset = write(thing)
    for frame, weights in frames:
        bpy.context.scene.frame_set(frame)
        check_shape(thing, asset, weights)


def check_simulated():
    """Only one of the two acts as a rigid body or a force: they would push each other away. Cloth gets the shape in time."""
    origin = make_layers()
    bpy.ops.rigidbody.object_add()
    check(len(origin.users_collection) == 2, "the origin is a rigid body")
    bpy.ops.object.forcefield_toggle()
    thing = bake()
    check(thing.users_collection == (bpy.context.scene.collection,), "the copy is no rigid body")
    check((origin.field.type, thing.field.type) == ("FORCE", "NONE"), "the copy has no force field")
    cloth = thing.modifiers.new("cloth", "CLOTH")
    thing.vertex_groups.new(name="pin").add(list(range(len(thing.data.vertices))), 1, "REPLACE")
    cloth.settings.vertex_group_mass = "pin"
    animate_slider(thing, NAMES[0], (1, 0), (3, 1))
    check_frames_of(thing, ((1, (0, 0.25, 0)), (2, (0.5, 0.25, 0)), (3, (1, 0.25, 0)), (1, (0, 0.25, 0))))


def check_empty_group():
    """Of a mesh without any weights, where Blender takes all of the key."""
    origin = make_tube(("twist", tube(twist=1)))
    origin.vertex_groups.new(name="group")
    origin.data.shape_keys.key_blocks["twist"].vertex_group = "group"
    thing = bake()
    set_weights(thing, 1)
    check(abs(shown(thing) - tube(twist=1)).max() < 0.01, "the whole key")


def check_tweaked():
    """An origin whose strip of the nonlinear animation is being edited."""
    origin = make_layers()
    origin.keyframe_insert("location")
    origin.animation_data.nla_tracks.new().strips.new("strip", 1, origin.animation_data.action).select = True
    origin.animation_data.action = None
    origin.animation_data.use_tweak_mode = True
    check(bake().animation_data.nla_tracks and origin.animation_data.use_tweak_mode, "the mode is the origin's")


def check_baked_twice():
    """A second bake of an origin, which the first one has hidden; strips are those of the copy."""
    origin = make_layers()
    origin.keyframe_insert("location")
    strip = origin.animation_data.nla_tracks.new().strips.new("strip", 1, origin.animation_data.action)
    bpy.data.objects.remove(bake())
    activate(origin)
    thing = bake()
    check(origin.hide_render and not thing.hide_render, "renders show the copy")
    copied = thing.animation_data.nla_tracks[0].strips[0]
    check(copied.action != strip.action and addon("sliders").curves(copied), "keyframes of the copy's strips")


def check_average():
    make_layers()
    thing = bake(blend="AVERAGE")
    check([weight.name for weight in thing.data.pliant.weights] == ["Basis", *NAMES], "names of poses")
    check([thing[name] for name in ("Basis", *NAMES)] == [1, 0, 0, 0], "an average starts with its first pose")
    asset = write(thing)
    set_weights(thing, 1, 2, 0, 1)
    check_shape(thing, asset, (1, 2, 0, 1))
    for weights, used in (((0, 0, 0, 0), (1, 1, 1, 1)), ((1, 0, -2, 1), (1, 0, 0, 1))):
        set_weights(thing, *weights)
        check_shape(thing, asset, used)
    limits = bake(blend="LAYERS").id_properties_ui(NAMES[0]).as_dict()
    check(limits["min"] < -1e30, f"a layer may leave its range: {limits}")


def check_frames():
    origin = make_tube()
    modifier = origin.modifiers.new("bend", "SIMPLE_DEFORM")
    modifier.deform_method, modifier.deform_axis = "TWIST", "Z"
    for frame, angle in ((1, 0.0), (20, 1.5)):
        modifier.angle = angle
        modifier.keyframe_insert("angle", frame=frame)
    thing = bake(source="FRAMES", frames="1, 10 20")
    check([weight.name for weight in thing.data.pliant.weights] == ["frame 1", "frame 10", "frame 20"], "names of frames")
    check(not thing.modifiers and bpy.context.scene.frame_current == 1, "no modifiers, and the frame of before")
    check(thing.animation_data.action != origin.animation_data.action, "keyframes of the copy are its own")
    asset = write(thing)
    set_weights(thing, 1, 0, 1)
    check_shape(thing, asset, (1, 0, 1))
    bake(source="FRAMES", frames="1, 10 20")
    check(write(thing, "again.pliant").read_bytes() == asset.read_bytes(), "frames of a hidden origin are the same")
    check_error(f"keeps its kind of shapes: select {origin.name}")


def check_simulation():
    """Frames of a cloth that falls while it is moved, by its baked cache only."""
    origin = make_tube()
    origin.vertex_groups.new(name="pin").add(list(range(SIDES)), 1, "REPLACE")
    origin.modifiers.new("cloth", "CLOTH").settings.vertex_group_mass = "pin"
    origin.rotation_euler.x = 1.2
    for frame, origin.location.x in ((1, 0), (15, 1)):
        origin.keyframe_insert("location", frame=frame)
    check_error("bake the cache of the modifier cloth", source="FRAMES", frames="15, 1")
    with bpy.context.temp_override(point_cache=origin.modifiers["cloth"].point_cache):
        bpy.ops.ptcache.bake(bake=True)
    thing = bake(source="FRAMES", frames="15, 1")  # shows its first shape
    bpy.context.scene.frame_set(15)
    difference, moved = (abs(shown(origin) - other).max() for other in (shown(thing), tube()))
    check(difference < 0.01 and moved > 0.3, f"off by {difference} where the cloth falls by {moved}")


def check_reload():
    """A file with a driven object, moved elsewhere and opened without Auto Run: the asset is in it."""
    thing = bake_layers()
    asset, name = write(thing), thing.name
    for kind, word in (("MORPH", "targets"), ("EMBED", "pliant"), ("MESHOPT", "EXT_meshopt_compression")):
        check(word in json.dumps(glb_json(write(thing, "out.glb", kind))), f"the GLB {kind}")
    reopen(thing)
    thing = bpy.data.objects[name]
    set_weights(thing, 0.3, 0.6, 0.9)
    check_shape(thing, asset, (0.3, 0.6, 0.9))
    check_linked(name, asset)


def check_linked(name, asset):
    """Library overrides of the object of another file: each has sliders of its own."""
    bpy.ops.wm.read_homefile(use_empty=True)
    made = []
    for _ in range(2):
        with bpy.data.libraries.load(str(FOLDER / "moved.blend"), link=True) as (_, wanted):
            wanted.objects = [name]
        linked = wanted.objects[0]
        bpy.context.scene.collection.objects.link(linked)
        made.append(linked.override_hierarchy_create(bpy.context.scene, bpy.context.view_layer))
        bpy.context.scene.collection.objects.unlink(linked)
    for weights in ((0.2, 0.7, 0.4), (1, 0, 0)):
        set_weights(made[0], *weights)
        set_weights(made[1], *reversed(weights))
        check_shape(made[0], asset, weights)
        check_shape(made[1], asset, tuple(reversed(weights)))
    activate(made[0])
    check_error("is linked from another file: bake it there")


def reopen(thing):
    path = FOLDER / "scene.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    moved = path.rename(FOLDER / "moved.blend")
    bpy.ops.wm.open_mainfile(filepath=str(moved), use_scripts=False)


def keys():
    """Driven by shape keys, as where the package is not installed: as far from the runtime as the table states."""
    check(not importlib.util.find_spec("pliant"), "the package is not to be found in this case")
    thing = bake_layers()
    check(len(thing.data.shape_keys.key_blocks) > 5, "the targets are shape keys")
    asset, name = write(thing), thing.name
    check_stated_error(thing, asset)
    reopen(thing)
    check_stated_error(bpy.data.objects[name], asset)
    check_without_addon(name)
    check_many_layers()


def check_without_addon(name):
    """Where no driver runs, the object shows its first shape."""
    bpy.ops.preferences.addon_disable(module="pliant_blender")
    bpy.ops.wm.open_mainfile(filepath=str(FOLDER / "moved.blend"), use_scripts=False)
    difference = abs(shown(bpy.data.objects[name]) - tube()).max()
    check(difference < 0.02, f"without the add-on the shape is {difference} off the first one")
    bpy.ops.preferences.addon_enable(module="pliant_blender")
    preferences().tool = TOOL


def check_many_layers():
    """64 weights, as many as there may be, are variables of one driver: the last one arrives, also without Auto Run."""
    thing = make_tube(("key", tube(twist=1)))
    state, key = thing.data.pliant, thing.data.shape_keys.key_blocks["key"]
    for i in range(64):
        state.weights.add().name = f"layer {i}"
        thing[f"layer {i}"] = i / 100
    table = {"layers": True, "first": [0], "centres": [], "coefficients": [0] * 64 + [1]}
    state.identity, state.table = "64 layers", json.dumps(table)
    addon("morphs").add_driver(thing, key, 0)
    thing.update_tag()
    bpy.context.view_layer.update()
    value = key.value * addon("morphs").SCALE
    check(abs(value - 0.63) < 1e-6, f"the 64th weight is {value}")


def check_stated_error(thing, asset):
    """At mixtures of the kinds that the stated errors are of: single layers, pairs, and mostly all three."""
    stated = json.loads(thing.data.pliant.table)["error_of_diagonal"]
    rows = np.random.default_rng(1).uniform(0.3, 1, (24, 3)).round(3)
    rows[::6, 1:] = rows[1::6, 0] = 0
    distances, wanted = [], []
    for weights in rows.tolist():
        set_weights(thing, *weights)
        wanted.append(blended(asset, weights))
        distances.append(np.linalg.norm(shown(thing) - wanted[-1], axis=1))
    distances = np.array(distances) / np.linalg.norm(np.ptp(np.concatenate(wanted), axis=0))
    mean, largest = np.mean(distances), np.max(distances)
    check(mean < 2 * stated["mean"] + 1e-5, f"the shape keys are {mean} off, {stated} stated")
    check(largest < 2 * stated["largest"] + 1e-4, f"the shape keys are {largest} off, {stated} stated")
    print(f"shape keys: mean {mean:.1e}, largest {largest:.1e} of the diagonal, stated {stated}")


def errors():
    """The messages of the tool, word for word; and after an error nothing is left."""
    broken = tube(bend=1)
    broken[7, 1] = np.nan
    make_tube(("good", tube(twist=1)), ("bad", broken))
    check_error("error P2105: 2/bad.ply: vertex 7 has the coordinate nan\n"
                "  hint: the program that made the pose failed there: repair the pose")
    make_tube()
    check_error("error P3001: 0/tube.001.ply: 1 pose given")
    thing = make_tube(("twist", tube(twist=1)))
    thing.modifiers.new("build", "BUILD").frame_duration = 20
    check_error("error P3003: 1/frame 20.ply: has", source="FRAMES", frames="10, 20")
    check_error("frames '1, x': write whole numbers", source="FRAMES", frames="1, x")
    check_error("Blender's last frame is 1048574", source="FRAMES", frames="1, 99999999999")
    thing.data.shape_keys.use_relative = False
    check_error("tube.002: its shape keys are absolute")
    thing.data.shape_keys.use_relative = True
    check_refused(thing)
    preferences().tool = "no-such-pliant"
    check_error("the tool 'no-such-pliant' was not found")
    preferences().tool = "/bin/true"
    check_error("the tool ended with exit code 0 and wrote no asset")
    vanishing = FOLDER / "vanishing"
    vanishing.write_text(f'#!/bin/sh\nrm "$0"\nexec "{TOOL}" "$@"\n')
    vanishing.chmod(0o755)
    preferences().tool = str(vanishing)
    check_error("No such file or directory")
    preferences().tool = os.path.relpath(TOOL)
    check_miss(bake(preview=False, tolerance=1e-8))
    preferences().tool = TOOL
    check_export_errors()
    check_link()


def check_modifiers(thing):
    """Of an original that would act on simulations beside the copy, and of cloth that rests at a key."""
    fluid, collision = thing.modifiers.new("fluid", "FLUID"), thing.modifiers.new("collision", "COLLISION")
    check_error("remove its modifier collision")
    thing.modifiers.remove(collision)
    fluid.fluid_type = "FLOW"
    check_error("remove its modifier fluid")
    thing.modifiers.remove(fluid)
    brush = thing.modifiers.new("brush", "DYNAMIC_PAINT")
    brush.ui_type = "BRUSH"
    bpy.ops.dpaint.type_toggle(type="BRUSH")
    check_error("remove its modifier brush")
    thing.modifiers.remove(brush)
    cloth = thing.modifiers.new("cloth", "CLOTH")
    cloth.settings.rest_shape_key = thing.data.shape_keys.key_blocks[1]
    check_error("clear the Rest Shape Key of the modifier cloth")
    thing.modifiers.remove(cloth)


def check_refused(thing):
    """Shapes that are not those of the scene."""
    cloth, group, boolean = make_tube(), bpy.data.collections.new("group"), thing.modifiers.new("boolean", "BOOLEAN")
    cloth.modifiers.new("cloth", "CLOTH")
    group.objects.link(cloth)
    boolean.operand_type, boolean.collection = "COLLECTION", group
    activate(thing)
    check_error("bake the cache of the modifier cloth", source="FRAMES", frames="10, 20")
    thing.modifiers.remove(boolean)
    thing["twist"] = 30
    check_error("has a custom property 'twist', the name of a slider")
    del thing["twist"]
    check_modifiers(thing)
    thing.driver_add("hide_render")
    check_error("its visibility in renders is animated")
    thing.driver_remove("hide_render")
    mirror = thing.modifiers.new("mirror", "MIRROR")
    check_error("below the modifier mirror are those of one half")
    thing.modifiers.remove(mirror)
    thing.scale.z = 3
    check_error("its scale is uneven")
    thing.scale.z = 1
    bpy.context.view_layer.update()
    thing.hide_viewport = True
    check_error("enable it", source="FRAMES", frames="10, 20")
    thing.hide_viewport = False


def check_miss(thing):
    check("warning P4404: mixtures of layers miss the tolerance" in last_message(), f"a missed tolerance: {last_message()}")
    check(thing.data.pliant.asset, "it is a warning, and the blend is there")


def check_export_errors():
    for name, kind, wanted in (("a.fbx", "ASSET", "does not end in .pliant"), ("a.fbx", "MORPH", "error P1")):
        try:
            bpy.ops.pliant.export(filepath=str(FOLDER / name), kind=kind)
            raise AssertionError(f"{name} was exported as {kind}")
        except RuntimeError as error:
            check(wanted in str(error), f"{name}, {kind}: {error}")
        check(not (FOLDER / name).exists(), f"{name} is there")


def check_link():
    """A link stays one, and its file is written."""
    (FOLDER / "link.pliant").symlink_to("linked.pliant")
    write(bpy.context.object, "link.pliant")
    check((FOLDER / "link.pliant").is_symlink() and (FOLDER / "linked.pliant").exists(), "the link was replaced")


def main():
    bpy.ops.preferences.addon_install(filepath=ZIP)
    bpy.ops.preferences.addon_enable(module="pliant_blender")
    preferences().tool = TOOL
    bpy.ops.object.select_all(action="SELECT")
    bpy.ops.object.delete()
    if CASE == "window":
        bpy.app.timers.register(functools.partial(step, window()), persistent=True)
    else:
        globals()[CASE]()
        print(f"passed: {CASE}")


def step(steps):
    """One step of a case in a window; its next one comes after Blender's own."""
    try:
        next(steps)
        return 0.1
    except StopIteration:
        print(f"passed: {CASE}", flush=True)
        os._exit(0)
    except BaseException:
        fail()


def fail():
    traceback.print_exc()
    sys.stderr.flush()
    os._exit(9)


try:
    main()
except BaseException:
    fail()
