"""What the add-on keeps in a .blend: the options of a bake in the object, the asset in the mesh."""
import bpy
from bpy.props import BoolProperty, CollectionProperty, EnumProperty, FloatProperty, PointerProperty, StringProperty


class BakeOptions:
    """Properties of the operator and of an object, which remembers them."""
    source: EnumProperty(name="Shapes", items=[
        ("KEYS", "Shape keys", "The basis and every shape key that is not muted, each at value 1"),
        ("FRAMES", "Frames", "The object with its modifiers at frames of the scene")])
    frames: StringProperty(name="Frames", default="1, 10, 20", description="Numbers of frames, the rest pose first")
    blend: EnumProperty(name="Blend", items=[
        ("AUTO", "Automatic", "Shape keys are layers, frames are averaged"),
        ("LAYERS", "Layers", "The first shape is the rest shape, the others add up on it"),
        ("AVERAGE", "Average", "A shape between all shapes, whose weights are shares")])
    tolerance: FloatProperty(name="Tolerance", default=0.001, min=1e-8, max=1, precision=5, step=0.01,
                             description="Mean error that is allowed, relative to the size of the shape")
    preview: BoolProperty(name="Preview", description="A rough blend in a fraction of the time; the tolerance is not used")


def copy_options(origin, destination):
    for name in BakeOptions.__annotations__:
        setattr(destination, name, getattr(origin, name))


class PliantWeight(bpy.types.PropertyGroup):
    """A weight of the blend; the custom property of the object has its name, which PropertyGroup declares."""


class PliantMesh(bpy.types.PropertyGroup):
    """The asset of a driven mesh. Its bytes are packed into the .blend: a path would break when the file is moved, sent to a
    render farm or undone past a bake."""
    asset: StringProperty(subtype="BYTE_STRING")
    identity: StringProperty(description="SHA-256 of the asset; empty in meshes that are not driven")
    table: StringProperty(description="JSON of pliant export that maps weights to shape keys")
    weights: CollectionProperty(type=PliantWeight)
    summary: StringProperty()


class PliantObject(bpy.types.PropertyGroup, BakeOptions):
    """The options of the last bake, and the object that it read."""
    origin: PointerProperty(type=bpy.types.Object)

