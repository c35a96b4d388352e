"""Drives meshes by the Python package pliant: when weights have changed, handlers blend the asset and set a shape key."""
import functools
import importlib

import bpy
import numpy as np
from bpy.app.handlers import persistent

from . import shapes

assets = {}  # by identity
messages = {}  # by the name of a mesh: why it stands still
KEY = "Pliant"
FOLLOWED = "pliant_key"  # the variable of drivers of add_properties(), by which another bake knows them
SIMULATIONS = {"CLOTH", "COLLISION", "DYNAMIC_PAINT", "FLUID", "SOFT_BODY"}  # modifiers
LARGEST = float(np.finfo(np.float32).max)


@functools.cache
def package():
    """The module, or None where it is not installed."""
    try:
        return importlib.import_module("pliant")
    except ImportError:
        return None


def is_simulated(thing):
    """Whether Blender simulates with the object, which it does before the handlers set the shape of the frame."""
    return any(modifier.type in SIMULATIONS for modifier in thing.modifiers)


def property_path(name):
    return f'["{bpy.utils.escape_identifier(name)}"]'


def add_properties(thing, shapes_read, origin):
    """A custom property for each weight. Those that are there keep their value and their driver; if the shape keys of the
    origin are animated or driven, they are followed by drivers."""
    layers = shapes_read.layers
    for path in followers(thing):  # of the last bake: the names of keys may be other ones now
        thing.driver_remove(path)
    for name, (low, high), value in zip(shapes_read.weight_names, shapes_read.ranges, shapes_read.values):
        before = thing.get(name)
        thing[name] = float(before if isinstance(before, (int, float)) else value)
        least = -LARGEST if layers else 0.0  # weights of layers may leave their range, those of averages are shares
        thing.id_properties_ui(name).update(min=least, max=LARGEST, soft_min=low, soft_max=high,
                                            description="Weight of the elastic blend")
        thing.property_overridable_library_set(property_path(name), True)
        if layers and origin.data.shape_keys:
            follow(thing, property_path(name), origin.data.shape_keys)


def follow(thing, path, keys):
    """Drives a property by the shape key of its name, if that one moves and the property does not by itself."""
    source = f"key_blocks{path}.value"
    if is_animated(keys.animation_data, source) and not movers(thing.animation_data, path):
        driver = thing.driver_add(path).driver
        add_variable(driver, FOLLOWED, keys, source, "KEY")
        driver.expression = FOLLOWED


def followers(thing):
    """The paths of the custom properties that follow() drives."""
    drivers = thing.animation_data.drivers if thing.animation_data else []
    return [curve.data_path for curve in drivers if curve.driver.expression == FOLLOWED]


def movers(animation, path):
    """The curves that move a property: its driver, and its keyframes in the action and in the nonlinear animation."""
    found = [curve for user in users_of_actions(animation) for curve in curves(user)] + [*getattr(animation, "drivers", ())]
    return [curve for curve in found if curve.data_path == path]


def is_animated(animation, path):
    return any(not curve.mute for curve in movers(animation, path))


def users_of_actions(animation):
    """Animation data and its strips; nothing of None."""
    return [animation, *(strip for track in animation.nla_tracks for strip in strips_in(track))] if animation else []


def strips_in(owner):
    """Of a track, or of a strip that groups others."""
    for strip in owner.strips:
        yield strip
        yield from strips_in(strip)


def curves(user):
    """Of the action of animation data or of a strip."""
    action = user.action
    if not action or not hasattr(user, "action_slot"):  # before Blender 4.4
        return action.fcurves if action else []
    bags = [strip.channelbag(user.action_slot) for layer in action.layers for strip in layer.strips if user.action_slot]
    return [curve for bag in bags if bag for curve in bag.fcurves]


def add_variable(driver, name, owner, path, kind="OBJECT"):
    variable = driver.variables.new()
    variable.name = name
    variable.targets[0].id_type = kind
    variable.targets[0].id = owner
    variable.targets[0].data_path = path


def add_key(thing):
    """The key that the handlers set. Moving vertices would move what is bound to the shape at rest: generated texture
    coordinates, hair; and motion blur and exports look for something that deforms the mesh."""
    thing.shape_key_add(name="Basis", from_mix=False)
    thing.shape_key_add(name=KEY, from_mix=False).value = 1


def weights_of(thing, graph):
    evaluated = thing.evaluated_get(graph) if graph else thing
    return tuple(float(evaluated.get(weight.name, 0)) for weight in thing.data.pliant.weights)


def blend(state, weights):
    """(n, 3) positions in Blender's axes."""
    if state.identity not in assets:
        assets[state.identity] = package().Asset.open(state.asset)
    asset = assets[state.identity]
    return shapes.z_up(asset.blend(weights if asset.has_layers else shares(weights)))


def shares(weights):
    """Of an average, with the sum 1: a negative weight counts as 0, and weights that are all 0 count as equal."""
    positive = np.maximum(weights, 0)
    positive = positive if positive.any() else np.ones(len(positive))
    return positive / positive.sum()


def place(mesh, positions):
    points = mesh.shape_keys.key_blocks[KEY].data
    if mesh.library or mesh.override_library:  # there Blender ignores foreach_set
        for point, position in zip(points, positions):
            point.co = position
    else:
        points.foreach_set("co", np.ascontiguousarray(positions, np.float32).ravel())
    mesh.update()


def drive(thing, graph):
    mesh = thing.data
    try:
        weights = weights_of(thing, graph)
        shown = repr((mesh.pliant.identity, weights))
        if mesh.pliant.shown == shown:
            return
        mesh.pliant.shown = shown
        messages.pop(mesh.name_full, None)
        positions = blend(mesh.pliant, weights)
    except (package().Error, TypeError, ValueError) as error:  # of a file of somebody else: properties that are no numbers
        messages[mesh.name_full] = str(error)
        return
    if len(positions) != len(mesh.vertices):
        messages[mesh.name_full] = f"the mesh has {len(mesh.vertices)} vertices, the asset {len(positions)}: bake it again"
    elif not mesh.shape_keys or KEY not in mesh.shape_keys.key_blocks:
        messages[mesh.name_full] = f"the shape key {KEY} is gone: bake it again"
    else:
        place(mesh, positions)


@persistent
def refresh(_=None, graph=None):
    """Objects that share a mesh share its shape: the first of them in the order of names drives it, before those that the
    scene lacks, as the object behind a library override. Without a graph it uses the weights that the objects hold: Blender
    gives up every driver that it evaluates before another handler has defined its function."""
    things = [thing for thing in bpy.data.objects if thing.type == "MESH" and thing.mode == "OBJECT"
              and thing.data.pliant.identity and not thing.data.pliant.table]
    if not things or not package():
        return
    driven = {}
    for thing in sorted(things, key=lambda each: bool(graph) and not each.evaluated_get(graph).is_evaluated):
        driven.setdefault(thing.data.name_full, thing)
    for thing in driven.values():
        drive(thing, graph)


def refresh_evaluated():
    refresh(None, bpy.context.evaluated_depsgraph_get())


@persistent
def refresh_opened(*_):
    """Shows the weights that the file holds, and the evaluated ones after all handlers have run."""
    refresh_all()
    bpy.app.timers.register(refresh_evaluated)


@persistent
def refresh_all(*_):
    """After undo, and after a file was opened: vertices may be of another time than the weights."""
    for mesh in bpy.data.meshes:
        if mesh.pliant.shown:
            mesh.pliant.shown = ""
    messages.clear()
    refresh()


HANDLERS = {"depsgraph_update_post": refresh, "frame_change_post": refresh, "undo_post": refresh_all,
            "redo_post": refresh_all, "load_post": refresh_opened}


def register():
    for event, handler in HANDLERS.items():
        getattr(bpy.app.handlers, event).append(handler)


def unregister():
    for event, handler in HANDLERS.items():
        getattr(bpy.app.handlers, event).remove(handler)
    if bpy.app.timers.is_registered(refresh_evaluated):
        bpy.app.timers.unregister(refresh_evaluated)
    for each in (assets, messages):
        each.clear()
