"""The tab Pliant in the sidebar of the 3D viewport, and the preferences of the add-on."""
import textwrap

import bpy

from . import morphs, shapes, sliders, tool
from .bake import PLIANT_OT_bake
from .properties import copy_options


class PliantPreferences(bpy.types.AddonPreferences):
    bl_idname = __package__
    tool: bpy.props.StringProperty(name="Tool pliant", default="pliant", subtype="FILE_PATH",
                                   description="A program on PATH, or a path")

    def draw(self, context):
        self.layout.prop(self, "tool")
        try:
            self.layout.label(text=f"Found: {tool.find()}", icon="CHECKMARK")
        except shapes.Failure as failure:
            self.layout.label(text=str(failure), icon="ERROR")
        module = morphs.package()
        self.layout.label(text=f"Python package pliant: {module.__version__ if module else 'not installed, see README.md'}")


class VIEW3D_PT_pliant(bpy.types.Panel):
    bl_label = "Pliant"
    bl_category = "Pliant"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"

    @classmethod
    def poll(cls, context):
        return context.object and context.object.type == "MESH"

    def draw(self, context):
        thing = context.object
        if thing.data.pliant.identity:
            self.draw_weights(context, thing)
        self.draw_options(thing)
        self.draw_bake(context, thing)

    def draw_weights(self, context, thing):
        state, column = thing.data.pliant, self.layout.column(align=True)
        for weight in state.weights:
            if weight.name in thing:
                column.prop(thing, sliders.property_path(weight.name), text=weight.name, slider=True)
        driving = morphs.driving_object(thing.data)
        if driving != thing:
            leader = f"the sliders of {driving.name}" if driving else "an object that is gone"
            self.draw_text(context, f"The shape follows {leader}. To move it by these sliders, make the mesh a single user "
                                    "and bake again.", "ERROR")
        self.draw_text(context, state.summary, "INFO")
        reason = morphs.why_approximate(state)
        self.draw_text(context, f"Approximate: {reason}" if reason else "", "INFO")
        self.layout.operator("pliant.export", text="Export", icon="EXPORT")

    def draw_options(self, thing):
        column, state = self.layout.column(), thing.pliant
        column.use_property_split, column.use_property_decorate = True, False
        row = column.row()
        row.enabled = not thing.data.pliant.identity  # a bake anew has the shapes of the first one
        row.prop(state, "source")
        if state.source == "FRAMES":
            column.prop(state, "frames")
        column.prop(state, "blend")
        row = column.row()
        row.active = not state.preview
        row.prop(state, "tolerance")
        column.prop(state, "preview")

    def draw_bake(self, context, thing):
        job = PLIANT_OT_bake.job
        if job:
            self.draw_text(context, f"{job.run.percent} %: {job.run.stage}\nEsc cancels the bake", "SORTTIME")
            return
        text = "Bake Again" if thing.data.pliant.identity else "Bake Elastic Blend"
        copy_options(thing.pliant, self.layout.operator("pliant.bake", text=text, icon="MOD_SIMPLEDEFORM"))
        self.draw_text(context, PLIANT_OT_bake.message, "ERROR")

    def draw_text(self, context, text, icon):
        """Wrapped at the width of the region, whose characters are about 7 units wide."""
        width = max(20, int(context.region.width / (7 * context.preferences.system.ui_scale)) - 6)
        column = self.layout.column(align=True)
        column.scale_y = 0.8
        for i, line in enumerate(line for part in text.splitlines() for line in textwrap.wrap(part, width)):
            column.label(text=line, icon="NONE" if i else icon)
