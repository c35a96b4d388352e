"""Pliant for Blender: bakes the shape keys or frames of an object into an elastic blend, drives it live, exports it."""
import bpy

from . import bake, export, morphs, panel, properties

bl_info = {
    "name": "Pliant",
    "description": "Blends whole shapes elastically: bakes shape keys or frames, drives the result by sliders, exports it",
    "author": "The Pliant authors",
    "version": (0, 0, 0),  # build.py writes that of the project
    "blender": (3, 4, 0),
    "location": "3D Viewport > Sidebar > Pliant",
    "category": "Animation",
}

CLASSES = (
    properties.PliantWeight,
    properties.PliantMesh,
    properties.PliantObject,
    bake.PLIANT_OT_bake,
    export.PLIANT_OT_export,
    panel.PliantPreferences,
    panel.VIEW3D_PT_pliant,
)
GROUPS = (("Mesh", "PliantMesh"), ("Object", "PliantObject"))


def register():
    for each in CLASSES:
        bpy.utils.register_class(each)
    for owner, group in GROUPS:
        setattr(getattr(bpy.types, owner), "pliant", bpy.props.PointerProperty(type=getattr(properties, group)))
    morphs.register()


def unregister():
    morphs.unregister()
    for owner, _ in GROUPS:
        delattr(getattr(bpy.types, owner), "pliant")
    for each in reversed(CLASSES):
        bpy.utils.unregister_class(each)
