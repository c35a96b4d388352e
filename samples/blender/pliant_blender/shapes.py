"""Shapes of an object as arrays, and as PLY files for the tool. Files have glTF's axes, y up, as the asset then has them:
(x, y, z) of Blender is (x, z, -y) there, which loses nothing."""
import re
from typing import NamedTuple

import bpy
import numpy as np


LAST_FRAME = 1048574  # of Blender, and the first one below zero


class Failure(Exception):
    """A text for people."""


class Shape(NamedTuple):
    name: str
    positions: np.ndarray  # (n, 3) float32
    faces: np.ndarray  # of each face the number of its corners, then its corners
    face_count: int


class Shapes(NamedTuple):
    """Arrays only: while the tool works, undo may replace all data of Blender."""
    shapes: list  # the rest shape first
    layers: bool
    ranges: list  # (low, high) of every weight
    values: list  # at the start

    @property
    def weight_names(self):
        return [shape.name for shape in self.shapes[self.layers:]]


def coordinates(vertices):
    flat = np.empty(3 * len(vertices), np.float32)
    vertices.foreach_get("co", flat)
    return flat.reshape(-1, 3)


def make_shape(name, positions, mesh):
    corners = np.empty(len(mesh.loops), np.int32)
    starts, counts = np.empty((2, len(mesh.polygons)), np.int32)
    mesh.loops.foreach_get("vertex_index", corners)
    mesh.polygons.foreach_get("loop_start", starts)
    mesh.polygons.foreach_get("loop_total", counts)
    return Shape(name, positions, np.insert(corners, starts, counts), len(counts))


def y_up(positions):
    return np.stack([positions[:, 0], positions[:, 2], -positions[:, 1]], axis=1)


def z_up(positions):
    return np.stack([positions[:, 0], -positions[:, 2], positions[:, 1]], axis=1)


def read(scene, thing, options):
    layers = options.blend == "LAYERS" or options.blend == "AUTO" and options.source == "KEYS"
    check_scale(thing)
    result = from_keys(thing, layers) if options.source == "KEYS" else from_frames(scene, thing, options.frames, layers)
    for name in result.weight_names:
        known = thing.bl_rna.properties.get(name)
        if known and known.is_runtime:  # Blender before 5.0 keeps those of add-ons among the custom properties
            raise Failure(f"shape key '{name}': an add-on has a property of this name: rename the key")
        if name in thing.keys():
            raise Failure(f"{thing.name} has a custom property '{name}', the name of a slider: rename one of them")
    return result


def check_scale(thing):
    """Lengths of the world are those of the object, up to one factor and 1 %."""
    bpy.context.view_layer.update()
    linear = np.array(thing.matrix_world)[:3, :3]
    squares = linear.T @ linear
    mean = np.trace(squares) / 3
    if abs(squares - mean * np.eye(3)).max() > 0.02 * mean:
        raise Failure(f"{thing.name}: its scale is uneven, or that of a parent: apply it (Object > Apply > Scale)")


def check_mirrors(thing):
    for modifier in thing.modifiers:
        if modifier.type == "MIRROR" and (modifier.show_viewport or modifier.show_render):
            raise Failure(f"{thing.name}: shape keys below the modifier {modifier.name} are those of one half, whose blend "
                          "may open in the middle: take Frames")


def group_weights(thing, name):
    """(n, 1): how much of a shape key each vertex takes."""
    group = thing.vertex_groups.get(name)
    if not group or not any(vertex.groups for vertex in thing.data.vertices):  # there Blender takes all of the key, too
        return 1
    rows = [[g.weight for g in vertex.groups if g.group == group.index] for vertex in thing.data.vertices]
    return np.array([row[0] if row else 0 for row in rows], np.float32)[:, None]


def from_keys(thing, layers):
    """Every key at value 1, as Blender shows it alone. The slider of a layer keeps its range and its value."""
    keys = thing.data.shape_keys
    if not keys:
        return Shapes([make_shape(thing.name, coordinates(thing.data.vertices), thing.data)], layers, [], [])
    check_mirrors(thing)
    if not keys.use_relative:
        raise Failure(f"{thing.name}: its shape keys are absolute: turn on Relative in the shape key settings")
    blocks = [key for key in keys.key_blocks if key == keys.reference_key or not key.mute]
    rest = coordinates(keys.reference_key.data)
    shapes = [make_shape(blocks[0].name, rest, thing.data)]
    for key in blocks[1:]:
        difference = coordinates(key.data) - coordinates(key.relative_key.data)
        shapes.append(make_shape(key.name, rest + group_weights(thing, key.vertex_group) * difference, thing.data))
    if not layers:
        return average(shapes)
    ranges = [(min(key.slider_min, 0), max(key.slider_max, 0)) for key in blocks[1:]]
    return Shapes(shapes, True, ranges, [key.value for key in blocks[1:]])


def average(shapes):
    return Shapes(shapes, False, [(0, 1)] * len(shapes), [1] + [0] * (len(shapes) - 1))


def frame_numbers(text):
    words = re.findall(r"[^\s,;]+", text)
    try:
        numbers = list(dict.fromkeys(int(word) for word in words))
    except ValueError:
        raise Failure(f"frames '{text}': write whole numbers, for example 1, 10, 20") from None
    if any(abs(number) > LAST_FRAME for number in numbers):
        raise Failure(f"frames '{text}': Blender's last frame is {LAST_FRAME}")
    return numbers


def from_frames(scene, thing, text, layers):
    """What the modifiers make of the object at frames of the scene."""
    check_caches(thing)
    shapes = []
    for frame, evaluated in at_frames(scene, thing, frame_numbers(text)):
        mesh = evaluated.to_mesh()
        shapes.append(make_shape(f"frame {frame}", coordinates(mesh.vertices), mesh))
        evaluated.to_mesh_clear()
    return Shapes(shapes, True, [(0, 1)] * len(shapes[1:]), [0] * len(shapes[1:])) if layers else average(shapes)


def dependencies(thing):
    """The object and all that it uses: by modifiers, nodes, collections, constraints, parents."""
    uses = {}
    for used, users in bpy.data.user_map().items():
        for user in users:
            uses.setdefault(user, set()).add(used)
    found, left = {thing}, {thing}
    while left:
        left = set().union(*(uses.get(each, ()) for each in left)) - found
        left = {each for each in left if not isinstance(each, bpy.types.Scene)}  # it uses all there is
        found |= left
    return found


def is_in(layer, thing):
    """Not by its name, which a linked object may have, too."""
    return thing in layer.objects.values()


def check_caches(thing):
    """Without its cache, Blender computes a frame of a simulation from the one that was shown before."""
    things = [each for each in dependencies(thing) if isinstance(each, bpy.types.Object)]
    for modifier in (modifier for each in things for modifier in each.modifiers):
        cache = getattr(modifier, "point_cache", None)
        if cache and modifier.show_viewport and not (cache.is_baked or cache.use_external):
            raise Failure(f"{modifier.id_data.name}: bake the cache of the modifier {modifier.name} first (Physics > Cache)")


def at_frames(scene, thing, frames):
    """The evaluated object at each frame; the scene then returns to the frame that it had."""
    shown = scene.frame_current
    try:
        for frame in frames:
            scene.frame_set(frame)
            evaluated = thing.evaluated_get(bpy.context.evaluated_depsgraph_get())
            if not evaluated.is_evaluated or not is_in(bpy.context.view_layer, thing):
                raise Failure(f"{thing.name} is disabled in viewports, or not in the view layer: enable it")
            yield frame, evaluated
    finally:
        scene.frame_set(shown)


def write_ply(path, shape):
    header = (f"ply\nformat binary_little_endian 1.0\nelement vertex {len(shape.positions)}\nproperty float x\n"
              f"property float y\nproperty float z\nelement face {shape.face_count}\n"
              "property list uint int vertex_indices\nend_header\n")
    with open(path, "wb") as file:
        file.write(header.encode())
        file.write(y_up(shape.positions).astype("<f4").tobytes())
        file.write(shape.faces.astype("<i4").tobytes())


def result_mesh(scene, thing, options):
    """A new mesh for the result, without shape keys: that of the object, of frames as the modifiers make it."""
    if options.source == "KEYS":
        return bpy.data.meshes.new_from_object(thing, preserve_all_data_layers=True)
    for _, evaluated in at_frames(scene, thing, frame_numbers(options.frames)[:1]):
        graph = bpy.context.evaluated_depsgraph_get()
        return bpy.data.meshes.new_from_object(evaluated, preserve_all_data_layers=True, depsgraph=graph)
