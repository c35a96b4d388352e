"""The sliders of a driven object: custom properties, which follow the shape keys of the origin that move."""
import bpy
import numpy as np

FOLLOWED = "pliant_key"  # the variable of drivers of add_properties(), by which another bake knows them
LARGEST = float(np.finfo(np.float32).max)


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
        driver = add_driver(thing, path)
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


def add_driver(owner, path):
    """Without keyframes of its curve, whose values Blender since 5.0 takes for all values that are within 1e-4 of them."""
    curve = owner.driver_add(path)
    while curve.keyframe_points:
        curve.keyframe_points.remove(curve.keyframe_points[0])
    return curve.driver


def add_variable(driver, name, owner, path, kind="OBJECT"):
    variable = driver.variables.new()
    variable.name = name
    variable.targets[0].id_type = kind
    variable.targets[0].id = owner
    variable.targets[0].data_path = path
