"""The operator pliant.bake: writes the shapes, runs the tool, and puts a driven object beside the one that was read."""
import hashlib
import json
import pathlib
import tempfile
from types import SimpleNamespace

import bpy

from . import morphs, shapes, sliders, tool
from .properties import BakeOptions, copy_options

FILE_NAMES = {ord("/"): "\u2215", ord("#"): "\uff03"}  # a '#' would ask for a part of a glTF file


def check_origin(origin, options):
    """It stays in the scene, hidden, beside the copy."""
    if sliders.is_animated(origin.animation_data, "hide_render"):
        raise shapes.Failure(f"{origin.name}: its visibility in renders is animated, and would show it beside the copy: "
                             "remove these keyframes or the driver, and animate the copy")
    for modifier in origin.modifiers:
        if acts_on_others(modifier):
            raise shapes.Failure(f"{origin.name} would act on simulations beside the copy, though it is hidden: remove its "
                                 f"modifier {modifier.name}, and add one to the copy")
        if modifier.type == "CLOTH" and options.source == "KEYS" and modifier.settings.rest_shape_key:
            raise shapes.Failure(f"{origin.name}: the copy has no shape key for the cloth to rest at: clear the Rest Shape "
                                 f"Key of the modifier {modifier.name}, or take Frames")


def acts_on_others(modifier):
    return (modifier.type == "COLLISION" or modifier.type == "DYNAMIC_PAINT" and modifier.brush_settings
            or modifier.type == "FLUID" and modifier.fluid_type in {"FLOW", "EFFECTOR"})


class Job:
    """A bake from the shapes of an object to an asset, in a temporary folder that close() removes."""

    def __init__(self, scene, thing, options):
        self.target = thing.name if thing.data.pliant.identity else ""  # baked again from its origin
        origin = thing.pliant.origin if self.target else thing
        if not origin:
            raise shapes.Failure(f"the object that {thing.name} was baked from is gone")
        if self.target and options.source != thing.pliant.source:  # one has the modifiers of its origin, the other none
            raise shapes.Failure(f"{thing.name} keeps its kind of shapes: select {origin.name} to bake from others")
        for each in (thing, origin):
            if each.library or each.override_library:  # Blender would not store what a copy of it adds
                raise shapes.Failure(f"{each.name} is linked from another file: bake it there, or append it")
            if each.data.is_editmode:  # by another object, too
                raise shapes.Failure(f"the mesh of {each.name} is in edit mode: leave it")
        self.origin, self.options = origin.name, SimpleNamespace()
        copy_options(options, self.options)
        check_origin(origin, options)
        self.shapes = shapes.read(scene, origin, options)
        self.storage = tempfile.TemporaryDirectory(prefix="pliant_")
        self.folder = pathlib.Path(self.storage.name)
        try:
            export = ["export", "baked.pliant", "--no-normals", "-o", "baked.glb"]
            self.run = tool.Run([self.bake_command(), export], self.folder)
        except BaseException:
            self.storage.cleanup()
            raise

    def bake_command(self):
        files = []
        for number, shape in enumerate(self.shapes.shapes):
            # The tool names poses by their files; names that are equal to the file system are in different folders.
            files.append(f"{number}/{shape.name.translate(FILE_NAMES)}.ply")
            (self.folder / str(number)).mkdir()
            shapes.write_ply(self.folder / files[-1], shape)
        words = ["bake", "-o", "baked.pliant", "--report", "report.json", "--blend"]
        words += ["layers" if self.shapes.layers else "average"]
        words += [] if self.shapes.layers else ["--no-align"]  # shapes stand where the scene has them
        words += ["--preview"] if self.options.preview else ["--best-effort", "--tolerance", f"{self.options.tolerance:.6g}"]
        for (low, high), file in zip(self.shapes.ranges, files[1:]) if self.shapes.layers else ():
            words += ["--range", f"{pathlib.PurePosixPath(file).name[:-len('.ply')]}={low:.6g}:{high:.6g}"]
        return [*words, "--", *files]

    def has_result(self):
        return (self.folder / "baked.glb").exists()

    def asset(self):
        return (self.folder / "baked.pliant").read_bytes()

    def summary(self):
        report = json.loads((self.folder / "report.json").read_text())
        measured = report["measured"]
        return (f"mean error {100 * measured['mean_error']:.2g} %, largest {100 * measured['largest_error']:.2g} %, "
                f"d = {report['subspace']['dimension']}, {len(self.asset()) / 1048576:.2g} MiB")

    def close(self):
        self.run.stop()
        self.storage.cleanup()


def put_result(context, job):
    """The driven object with a new mesh: the one that was active, or beside the origin, which is hidden, a new one."""
    origin, thing = bpy.data.objects.get(job.origin), bpy.data.objects.get(job.target)
    mesh = shapes.result_mesh(context.scene, origin, job.options) if origin else None
    is_here = not job.target or thing and not thing.data.is_editmode
    if not is_here or not mesh or len(mesh.vertices) != len(job.shapes.shapes[0].positions):
        if mesh:
            bpy.data.meshes.remove(mesh)
        raise shapes.Failure(f"{job.origin} has changed during the bake: bake it again")
    if thing:
        replace_mesh(thing.data, mesh)
    else:
        thing = new_object(context, origin, job.options)
        thing.data = mesh
    copy_options(job.options, thing.pliant)
    return thing


def replace_mesh(previous, mesh):
    """In all objects that share it."""
    previous.user_remap(mesh)
    if not previous.users:
        bpy.data.meshes.remove(previous)


def new_object(context, origin, options):
    thing = origin.copy()
    thing.name = origin.name + " Pliant"
    thing.show_only_shape_key = False  # a pin would keep the sliders from moving anything
    thing.pliant.origin = origin
    own_actions(thing.animation_data)
    if thing.field:  # that of the origin stays
        thing.field.type = "NONE"
    for collection in thing.users_collection:  # Blender puts the copy of a rigid body into its world, and nowhere else
        collection.objects.unlink(thing)
    for collection in collections_of(origin) or [context.scene.collection]:
        collection.objects.link(thing)
    if options.source == "FRAMES":  # they are in the shapes
        thing.modifiers.clear()
        thing.parent_type = "OBJECT" if thing.parent_type == "ARMATURE" else thing.parent_type
    thing.hide_render, origin.hide_render = False, True  # the first bake of this origin may have hidden it
    layer = context.view_layer  # may have become another during the bake, without the origin
    layer.update()
    if shapes.is_in(layer, origin):
        origin.select_set(False)
        origin.hide_set(True)
    if shapes.is_in(layer, thing):
        thing.select_set(True)
        layer.objects.active = thing
    return thing


def collections_of(origin):
    """Those that take another object, without the worlds of rigid bodies, where it would push the origin away."""
    worlds = [scene.rigidbody_world for scene in bpy.data.scenes if scene.rigidbody_world]
    taken = {each for world in worlds for each in (world.collection, world.constraints)}
    return [each for each in origin.users_collection if each not in taken and not each.library and not each.override_library]


def own_actions(animation):
    """Keyframes of the copy are not those of the origin."""
    if animation:
        animation.use_tweak_mode = False  # there the action is that of a strip
    for user in sliders.users_of_actions(animation):
        if user.action:
            slot = getattr(user, "action_slot", None)
            user.action = user.action.copy()
            if hasattr(user, "action_slot"):  # since Blender 4.4
                user.action_slot = user.action.slots[slot.identifier] if slot else None


def finish(context, job):
    asset, summary = job.asset(), job.summary()
    thing = put_result(context, job)
    state = thing.data.pliant
    state.asset, state.summary = asset, summary
    state.identity = hashlib.sha256(asset).hexdigest()
    for name in job.shapes.weight_names:
        state.weights.add().name = name
    sliders.add_properties(thing, job.shapes, bpy.data.objects[job.origin])
    state.table = morphs.add_keys(thing, job.folder / "baked.glb")
    thing.update_tag()


class PLIANT_OT_bake(bpy.types.Operator, BakeOptions):
    """Bake the shapes of the object into an elastic blend, and drive a copy of the object by it"""
    bl_idname = "pliant.bake"
    bl_label = "Bake Elastic Blend"
    bl_options = {"UNDO"}
    job = None  # the one bake that is running
    message = ""  # of the last one, word for word

    @classmethod
    def poll(cls, context):
        thing = context.object
        return bool(thing and thing.type == "MESH" and thing.mode == "OBJECT") and not PLIANT_OT_bake.job

    def start(self, context):
        """Whether the tool is at work."""
        PLIANT_OT_bake.message = ""
        try:
            PLIANT_OT_bake.job = Job(context.scene, context.object, self)
        except (shapes.Failure, OSError) as failure:
            self.tell("ERROR", str(failure))
        return bool(self.job)

    def tell(self, kind, text):
        PLIANT_OT_bake.message = text
        self.report({kind}, text)

    def execute(self, context):
        """From scripts and in background mode: to the end."""
        if not self.start(context):
            return {"CANCELLED"}
        try:
            self.job.run.wait()
            return self.end(context)
        finally:
            self.close()

    def invoke(self, context, event):
        if bpy.app.background:
            return self.execute(context)
        if not self.start(context):
            return {"CANCELLED"}
        self.timer = context.window_manager.event_timer_add(0.1, window=context.window)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        if event.type == "ESC" and event.value == "PRESS":
            self.cancel(context)
            self.tell("INFO", "cancelled: nothing was baked")
            return {"CANCELLED"}
        if event.type != "TIMER":  # nothing is edited meanwhile: Blender crashes if a stroke runs while the result is put in
            return {"PASS_THROUGH"} if event.type.startswith("TIMER") else {"RUNNING_MODAL"}
        is_done = self.job.run.poll() is not None
        self.show(context)
        if not is_done:
            return {"PASS_THROUGH"}
        try:
            return self.end(context)
        finally:
            self.cancel(context)

    def show(self, context):
        run = self.job.run
        context.workspace.status_text_set(f"Pliant {run.percent} %: {run.stage}. Esc cancels")
        for area in context.screen.areas:
            if area.type == "VIEW_3D":
                area.tag_redraw()

    def cancel(self, context):
        """Also called by Blender, when it quits or opens another file."""
        context.window_manager.event_timer_remove(self.timer)
        context.workspace.status_text_set(None)
        self.close()

    def close(self):
        job, PLIANT_OT_bake.job = self.job, None
        job.close()

    def end(self, context):
        run, text = self.job.run, "\n".join(self.job.run.messages)
        try:
            if run.code not in (0, 4) or not self.job.has_result():
                raise shapes.Failure(text or f"the tool ended with exit code {run.code} and wrote no asset")
            finish(context, self.job)
        except shapes.Failure as failure:
            self.tell("ERROR", str(failure))
            return {"CANCELLED"}
        if text:
            self.tell("WARNING", text)
        return {"FINISHED"}
