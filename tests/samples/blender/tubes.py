"""Tubes with shape keys, which inside.py bakes."""
import bpy
import numpy as np

RINGS, SIDES = 18, 12


def tube(bend=0.0, twist=0.0, bulge=0.0):
    """A tube along z: 216 vertices."""
    along, around = (grid.ravel() for grid in np.meshgrid(np.linspace(0, 1, RINGS), np.arange(SIDES) * 2 * np.pi / SIDES,
                                                          indexing="ij"))
    radius, angle = 0.2 * (1 + bulge * np.exp(-((along - 0.5) / 0.15) ** 2)), around + twist * along
    x, y, z = radius * np.cos(angle), radius * np.sin(angle), 2 * along
    if bend:
        x, z = 2 / bend - (2 / bend - x) * np.cos(along * bend), (2 / bend - x) * np.sin(along * bend)
    return np.stack([x, y, z], axis=1).astype(np.float32)


def make_tube(*keys):
    """The active object: a tube with these shape keys."""
    quads = [(i * SIDES + j, i * SIDES + (j + 1) % SIDES, (i + 1) * SIDES + (j + 1) % SIDES, (i + 1) * SIDES + j)
             for i in range(RINGS - 1) for j in range(SIDES)]
    mesh = bpy.data.meshes.new("tube")
    mesh.from_pydata(tube().tolist(), [], quads)
    thing = bpy.data.objects.new("tube", mesh)
    bpy.context.scene.collection.objects.link(thing)
    activate(thing)
    if keys:
        thing.shape_key_add(name="Basis", from_mix=False)
    for name, positions in keys:
        key = thing.shape_key_add(name=name, from_mix=False)
        key.data.foreach_set("co", positions.ravel())
        key.value = 0  # from Blender 5.0 on keys start at 1
    return thing


def activate(thing):
    bpy.ops.object.select_all(action="DESELECT")
    thing.select_set(True)
    bpy.context.view_layer.objects.active = thing
