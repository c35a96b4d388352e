"""The case of inside.py in a window."""
import bpy

from scene import (FOLDER, NAMES, TOOL, addon, animate_slider, bake_layers, check, check_shape, contents, last_message,
                   make_layers, preferences, set_weights, write)
from tubes import activate


def window():
    """In a window: Blender waits for the bake, Esc ends it, undo and redo move the shape. Yields to let Blender work."""
    thing = make_layers()
    bpy.ops.ed.undo_push(message="the scene")
    show_panel()
    yield
    before = contents()
    start_bake(preview=False, tolerance=1e-6)
    yield from wait_for(lambda: running().percent > 0, "progress")
    process = running().process
    bpy.context.window.event_simulate(type="ESC", value="PRESS")
    yield from wait_for(lambda: not addon("bake").PLIANT_OT_bake.job, "the end of a cancelled bake")
    check(process.poll() not in (None, 0), "the tool was ended")
    check(contents() == before and bpy.context.object == thing, "a cancelled bake leaves nothing")
    check(last_message() == "cancelled: nothing was baked", last_message())
    start_bake(preview=True)
    stages = set()
    yield from wait_for(lambda: stages.add(running() and running().stage) or not running(), "the end of a bake")
    check(len(stages) > 2, f"stages: {stages}")
    yield from check_locked()
    yield from check_undo(bpy.context.object.name)
    yield from check_turned_on(bpy.context.object.name)
    yield from check_left_layer()
    yield from check_opened()


def show_panel():
    """In the tab that is open, in a viewport that is quick to draw."""
    panel = addon("panel").VIEW3D_PT_pliant
    bpy.utils.unregister_class(panel)
    panel.bl_category = "Item"
    bpy.utils.register_class(panel)
    space = view_3d().spaces.active
    space.show_region_ui, space.shading.type, space.overlay.show_overlays = True, "WIREFRAME", False


def view_3d():
    return next(area for area in bpy.context.window.screen.areas if area.type == "VIEW_3D")


def check_locked():
    """During a bake Blender waits: a key that would enter edit mode does nothing."""
    area = view_3d()
    place = {"x": area.x + area.width // 3, "y": area.y + area.height // 2}
    for kind, value in (("MOUSEMOVE", "NOTHING"), ("LEFTMOUSE", "PRESS"), ("LEFTMOUSE", "RELEASE")):
        bpy.context.window.event_simulate(type=kind, value=value, **place)  # the splash screen goes
        yield
    for is_baking in (True, False):
        if is_baking:
            start_bake(preview=False, tolerance=1e-6)  # takes longer than the events
        for kind, value in (("MOUSEMOVE", "NOTHING"), ("TAB", "PRESS"), ("TAB", "RELEASE")):
            bpy.context.window.event_simulate(type=kind, value=value, **place)
            yield
        check(bool(running()) == is_baking, "the bake has ended already")
        check(bpy.context.mode == ("OBJECT" if is_baking else "EDIT_MESH"), f"{bpy.context.mode}, baking: {is_baking}")
        if is_baking:
            bpy.context.window.event_simulate(type="ESC", value="PRESS")
        yield from wait_for(lambda: not running(), "the end of a cancelled bake")
    bpy.ops.object.mode_set(mode="OBJECT")


def check_undo(name):
    asset = write(bpy.data.objects[name])
    for bend in (0.5, 1.0):
        set_weights(bpy.data.objects[name], bend, 0, 0)
        yield
        bpy.ops.ed.undo_push(message=f"bend {bend}")
    for act, bend in ((bpy.ops.ed.undo, 0.5), (bpy.ops.ed.redo, 1.0)):
        act()
        yield
        thing = bpy.data.objects[name]
        check(thing[NAMES[0]] == bend, f"{act}: the weight is {thing[NAMES[0]]}")
        check_shape(thing, asset, (bend, 0, 0))


def check_turned_on(name):
    """The add-on is turned off and on while the file is open."""
    asset = write(bpy.data.objects[name])
    set_weights(bpy.data.objects[name], 0.25, 0, 0)
    bpy.ops.preferences.addon_disable(module="pliant_blender")
    bpy.data.objects[name][NAMES[0]] = 0.5
    bpy.data.objects[name].update_tag()
    yield
    bpy.ops.preferences.addon_enable(module="pliant_blender")
    preferences().tool = TOOL
    yield  # the timer of the add-on
    yield
    check_shape(bpy.data.objects[name], asset, (0.5, 0, 0))


def check_left_layer():
    """The origin leaves the view layer during its bake."""
    bpy.ops.object.select_all(action="DESELECT")
    thing = make_layers()
    group = bpy.data.collections.new("group")
    bpy.context.scene.collection.children.link(group)
    for collection in thing.users_collection:
        collection.objects.unlink(thing)
    group.objects.link(thing)
    yield
    activate(thing)
    start_bake(preview=True)
    bpy.context.view_layer.layer_collection.children["group"].exclude = True
    yield from wait_for(lambda: not running(), "the end of a bake")
    made = bpy.data.objects[thing.name + " Pliant"]
    check(made.data != thing.data and made.data.pliant.asset, "half a copy")


def check_opened():
    """A linked object has the weights of its own file until the file that links it is evaluated."""
    thing = bake_layers()
    asset, name = write(thing), thing.name
    animate_slider(thing, NAMES[0], (1, 0), (11, 1))
    bpy.context.scene.frame_set(1)
    bpy.ops.wm.save_as_mainfile(filepath=str(FOLDER / "linked.blend"))
    bpy.ops.wm.read_homefile(use_empty=True)
    with bpy.data.libraries.load(str(FOLDER / "linked.blend"), link=True) as (_, wanted):
        wanted.objects = [name]
    bpy.context.scene.collection.objects.link(wanted.objects[0])
    bpy.context.scene.frame_set(6)
    bpy.ops.wm.save_as_mainfile(filepath=str(FOLDER / "shot.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(FOLDER / "shot.blend"))
    yield
    yield
    check_shape(bpy.data.objects[name], asset, (0.5, 0.25, 0))


def start_bake(**options):
    area = view_3d()
    with bpy.context.temp_override(window=bpy.context.window, area=area, region=area.regions[-1]):
        check(bpy.ops.pliant.bake("INVOKE_DEFAULT", **options) == {"RUNNING_MODAL"}, "the bake has begun")


def running():
    job = addon("bake").PLIANT_OT_bake.job
    return job and job.run


def wait_for(condition, what):
    for _ in range(600):
        if condition():
            return
        yield
    raise AssertionError(f"no {what} in a minute")
