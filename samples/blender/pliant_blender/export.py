"""The operator pliant.export: the asset itself, or a GLB that `pliant export` makes of it."""
import os
import pathlib
import tempfile

import bpy
from bpy_extras.io_utils import ExportHelper

from . import shapes, tool

OPTIONS = {"MORPH": ["--morph"], "MESHOPT": ["--meshopt"], "EMBED": ["--embed"]}


class PLIANT_OT_export(bpy.types.Operator, ExportHelper):
    """Write the elastic blend of the object to a file"""
    bl_idname = "pliant.export"
    bl_label = "Export Elastic Blend"
    filter_glob: bpy.props.StringProperty(default="*.pliant;*.glb", options={"HIDDEN"})
    kind: bpy.props.EnumProperty(name="File", items=[
        ("ASSET", "Asset (.pliant)", "For programs with the runtime of Pliant, for the player and for the tool"),
        ("MORPH", "Morph targets (.glb)", "For every program that reads glTF"),
        ("MESHOPT", "Morph targets, compressed (.glb)", "A fifth of the size, for engines that read meshopt compression"),
        ("EMBED", "Asset inside (.glb)", "For programs with the runtime")])

    @classmethod
    def poll(cls, context):
        thing = context.object
        return bool(thing and thing.type == "MESH" and thing.data.pliant.identity)

    @property
    def filename_ext(self):
        return ".pliant" if self.kind == "ASSET" else ".glb"

    def execute(self, context):
        state = context.object.data.pliant
        path = pathlib.Path(os.path.abspath(bpy.path.abspath(self.filepath)))
        try:
            write_asset(path, state.asset) if self.kind == "ASSET" else write_glb(path, state.asset, OPTIONS[self.kind])
        except (shapes.Failure, OSError) as failure:
            self.report({"ERROR"}, str(failure))
            return {"CANCELLED"}
        return {"FINISHED"}


def write_asset(path, content):
    """The file appears whole or not at all, with the permissions of the one it replaces, as with the tool."""
    if path.suffix != ".pliant":
        raise shapes.Failure(f"'{path.name}' does not end in .pliant")
    path = path.resolve()  # a link stays one
    mode = path.stat().st_mode & 0o777 if path.exists() else None
    if mode is not None and not mode & 0o222:
        raise shapes.Failure(f"'{path.name}' is write-protected")
    with tempfile.TemporaryDirectory(prefix=".pliant_", dir=path.parent) as folder:
        part = pathlib.Path(folder, path.name)
        part.write_bytes(content)
        if mode is not None:
            part.chmod(mode)
        os.replace(part, path)


def write_glb(path, content, options):
    with tempfile.TemporaryDirectory(prefix="pliant_") as folder:
        pathlib.Path(folder, f"{path.stem}.pliant").write_bytes(content)  # the GLB's node gets the name
        run = tool.Run([["export", *options, "-o", str(path), "--", f"{path.stem}.pliant"]], folder)
        code = run.wait()
        run.stop()
    if code != 0:
        raise shapes.Failure("\n".join(run.messages) or f"the tool ended with exit code {code}")
