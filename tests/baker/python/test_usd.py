"""USD files as poses: blend shapes, frames, skeletons, places; against arrays and the glTF file of the same shapes."""
import math
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path
from unittest import mock

import numpy as np
import pliant
import shapes

try:
    from pxr import Gf, Sdf, Usd, UsdGeom, UsdSkel, Vt
except ImportError:
    print("skipped: usd-core is not installed")
    sys.exit(77)

POSES, FACES = shapes.tubes((0.0, 1.2, -0.8))
POSES = POSES.astype(np.float32).astype(float)  # what files of single precision keep
QUADS = shapes.quads(FACES)
QUICK = {"dim": 6, "elements": 40, "check_samples": 1, "fresh_samples": 1}
FOLDER = tempfile.TemporaryDirectory()


def vectors(positions):
    return Vt.Vec3fArray.FromNumpy(np.ascontiguousarray(positions, np.float32))


def new_mesh(name, positions, faces, where="/tube"):
    """A stage in a file with one mesh."""
    path = str(Path(FOLDER.name, name))
    stage = Usd.Stage.CreateNew(path)
    add_mesh(stage, positions, faces, where)
    return path, stage


def add_mesh(stage, positions, faces, where):
    mesh = UsdGeom.Mesh.Define(stage, where)
    mesh.CreatePointsAttr(vectors(positions))
    mesh.CreateFaceVertexCountsAttr([len(face) for face in faces])
    mesh.CreateFaceVertexIndicesAttr([int(v) for face in faces for v in face])
    return mesh


def add_shapes(stage, where, count):
    """Blend shapes s0, s1, ... of the mesh there, each of one vertex."""
    binding = UsdSkel.BindingAPI.Apply(stage.GetPrimAtPath(where))
    binding.CreateBlendShapesAttr([f"s{k}" for k in range(count)])
    for k in range(count):
        shape = UsdSkel.BlendShape.Define(stage, f"{where}/s{k}")
        shape.CreateOffsetsAttr([(0, 0, 1)])
        shape.CreatePointIndicesAttr([0])
        binding.CreateBlendShapeTargetsRel().AddTarget(shape.GetPath())


def write_shapes(name):
    path, stage = new_mesh(name, POSES[0], QUADS)
    binding = UsdSkel.BindingAPI.Apply(stage.GetPrimAtPath("/tube"))
    binding.CreateBlendShapesAttr(["bend", "back"])
    for k, target in ((1, "bend"), (2, "back")):
        shape = UsdSkel.BlendShape.Define(stage, f"/tube/{target}")
        offsets = POSES[k] - POSES[0]
        moved = np.flatnonzero(offsets.any(1)) if k == 2 else np.arange(len(offsets))  # one sparse, one dense
        shape.CreateOffsetsAttr(vectors(offsets[moved]))
        if k == 2:
            shape.CreatePointIndicesAttr(moved.tolist())
        binding.GetBlendShapeTargetsRel() or binding.CreateBlendShapeTargetsRel()
        binding.GetBlendShapeTargetsRel().AddTarget(shape.GetPath())
    stage.Save()
    return path


def write_frames(name, times=(1, 12, 24)):
    path, stage = new_mesh(name, POSES[0], FACES)
    points = UsdGeom.Mesh.Get(stage, "/tube").GetPointsAttr()
    points.Clear()
    for k, time in enumerate(times):
        points.Set(vectors(POSES[k % 3]), time)
    stage.Save()
    return path


def add_skin(stage, prim, bones, move, joints, **options):
    """Binds a mesh to new bones at `bones`, one at the origin and one a unit above, with an animation whose second bone
    turns by move[time] about x; a time of None is no time. joints: of each vertex. Options: the place of the mesh among
    them."""
    skeleton = UsdSkel.Skeleton.Define(stage, bones)
    skeleton.CreateJointsAttr(["a", "a/b"])
    up = Gf.Matrix4d().SetTranslate((0, 0, 1))
    skeleton.CreateBindTransformsAttr([Gf.Matrix4d(1), up])
    skeleton.CreateRestTransformsAttr([Gf.Matrix4d(1), up])
    animation = UsdSkel.Animation.Define(stage, bones + "/move")
    animation.CreateJointsAttr(["a", "a/b"])
    animation.CreateTranslationsAttr([(0, 0, 0), (0, 0, 1)])
    animation.CreateScalesAttr([Gf.Vec3h(1)] * 2)
    for time, angle in move.items():
        turn = Gf.Quatf(math.cos(angle / 2), math.sin(angle / 2), 0, 0)
        code = Usd.TimeCode.Default() if time is None else time
        animation.CreateRotationsAttr().Set([Gf.Quatf(1), turn], code)
    UsdSkel.BindingAPI.Apply(skeleton.GetPrim()).CreateAnimationSourceRel().SetTargets([animation.GetPath()])
    binding = UsdSkel.BindingAPI.Apply(prim)
    binding.CreateSkeletonRel().SetTargets([skeleton.GetPath()])
    binding.CreateJointIndicesPrimvar(False, 1).Set([int(joint) for joint in joints])
    binding.CreateJointWeightsPrimvar(False, 1).Set([1.0] * len(joints))
    if "bind" in options:
        binding.CreateGeomBindTransformAttr(Gf.Matrix4d().SetTranslate(options["bind"]))


def turned(positions, joints, angle):
    """What add_skin's second bone does to those of its vertices."""
    y, z = positions[:, 1], positions[:, 2] - 1
    moved = np.stack([positions[:, 0], y * math.cos(angle) - z * math.sin(angle),
                      1 + y * math.sin(angle) + z * math.cos(angle)], 1)
    return np.where(joints[:, None] == 1, moved, positions)


def number_of(call, *arguments, **options):
    try:
        call(*arguments, **options)
    except pliant.Error as error:
        return error.number, str(error)
    return None, ""


class BlendShapes(unittest.TestCase):
    def test_they_are_layers(self):
        poses = pliant.load_poses(write_shapes("keys.usda"))
        self.assertEqual((poses.blend, poses.names), ("layers", ["rest", "bend", "back"]))
        np.testing.assert_array_equal(poses.faces, QUADS)
        self.assertLess(np.abs(poses.positions - POSES).max(), 2e-7)
        self.assertTrue(pliant.bake(poses, **QUICK).has_layers)
        glb = shapes.write_glb(Path(FOLDER.name, "keys.glb"), POSES[0], FACES, {"bend": POSES[1], "back": POSES[2]})
        self.assertLess(np.abs(poses.positions - pliant.load_poses(glb).positions).max(), 2e-7)

    def test_choices(self):
        path = write_shapes("choices.usdc")
        poses = pliant.load_poses([path + "#rest", path + "#target=back,bend"])
        self.assertEqual((poses.blend, poses.names), ("average", ["rest", "back", "bend"]))
        self.assertLess(np.abs(poses.positions - POSES[[0, 2, 1]]).max(), 2e-7)
        for wrong, number, text in (("#target=grin", "P1212", "it has bend, back"), ("#morph=bend", "P1211", "#time=FRAME"),
                                    ("#time=1,x", "P1211", "'x' is not a time in frames"), ("#", "P1211", "'#'"),
                                    ("#rest", "P3001", "two or more are needed")):
            got, message = number_of(pliant.load_poses, path + wrong)
            self.assertEqual(got, number, message)
            self.assertIn(text, message)


class Frames(unittest.TestCase):
    def test_they_are_poses_with_the_bytes_of_arrays(self):
        for name in ("frames.usda", "frames.usdc"):
            poses = pliant.load_poses(write_frames(name))
            self.assertEqual((poses.blend, poses.names), ("average", ["frame 1", "frame 12", "frame 24"]))
            np.testing.assert_array_equal(poses.positions, POSES)
            expected = pliant.bake(POSES, FACES, names=poses.names, **QUICK)
            self.assertEqual(bytes(pliant.bake(poses, **QUICK)), bytes(expected))

    def test_choices(self):
        path = write_frames("times.usda")
        poses = pliant.load_poses(path + "#time=24,6.5")
        self.assertEqual(poses.names, ["frame 24", "frame 6.5"])
        np.testing.assert_array_equal(poses.positions[0], POSES[2])
        self.assertLess(np.abs(poses.positions[1] - (POSES[0] + POSES[1]) / 2).max(), 1e-6)
        many = write_frames("many.usda", range(65))
        number, message = number_of(pliant.load_poses, many)
        self.assertEqual(number, "P3002")
        self.assertIn("many.usda#time=0,32,64", message)

    def test_several_files(self):
        paths = []
        for k, positions in enumerate(POSES):
            path, stage = new_mesh(f"pose{k}.usda", positions, FACES)
            stage.Save()
            paths.append(path)
        poses = pliant.load_poses(paths)
        self.assertEqual(poses.names, ["pose0", "pose1", "pose2"])
        np.testing.assert_array_equal(poses.positions, POSES)

    def test_skeletons(self):
        path, stage = new_mesh("skin.usda", POSES[0], FACES, "/hero/tube")
        UsdSkel.Root.Define(stage, "/hero")
        skeleton = UsdSkel.Skeleton.Define(stage, "/hero/bones")
        skeleton.CreateJointsAttr(["a"])
        for create in (skeleton.CreateBindTransformsAttr, skeleton.CreateRestTransformsAttr):
            create(Vt.Matrix4dArray([Gf.Matrix4d(1)]))
        animation = UsdSkel.Animation.Define(stage, "/hero/bones/move")
        animation.CreateJointsAttr(["a"])
        animation.CreateRotationsAttr([Gf.Quatf(1)])
        animation.CreateScalesAttr([Gf.Vec3h(1)])
        moves = animation.CreateTranslationsAttr()
        for time in (1, 2):
            moves.Set([Gf.Vec3f(0, time - 1, 0)], time)
        UsdSkel.BindingAPI.Apply(skeleton.GetPrim()).CreateAnimationSourceRel().SetTargets([animation.GetPath()])
        binding = UsdSkel.BindingAPI.Apply(stage.GetPrimAtPath("/hero/tube"))
        binding.CreateSkeletonRel().SetTargets([skeleton.GetPath()])
        weights = (np.arange(len(POSES[0])) % 2).astype(np.float32)  # of every other vertex
        binding.CreateJointIndicesPrimvar(False, 1).Set([0] * len(weights))
        binding.CreateJointWeightsPrimvar(False, 1).Set(weights.tolist())
        stage.Save()
        before = Path(path).read_bytes()
        poses = pliant.load_poses(path)
        self.assertEqual(len(poses), 2)
        moved = poses.positions[1] - poses.positions[0]
        self.assertLess(np.abs(moved[weights == 1] - [0, 1, 0]).max(), 1e-6)
        between = pliant.load_poses([path + "#time=1,1.5,2", path + "#time=0,3"]).positions
        for k, move in enumerate((0, 0.5, 1, 0, 1)):
            self.assertLess(np.abs(between[k] - poses.positions[0] - np.outer(weights, [0, move, 0])).max(), 1e-6)
        self.assertEqual(Path(path).read_bytes(), before)


class Skeletons(unittest.TestCase):
    JOINTS = np.arange(len(POSES[0])) % 2

    def hero(self, name, move, **options):
        path, stage = new_mesh(name, POSES[0], FACES, "/hero/tube")
        UsdSkel.Root.Define(stage, "/hero")
        add_skin(stage, stage.GetPrimAtPath("/hero/tube"), "/hero/bones", move, self.JOINTS, **options)
        return path, stage

    def same(self, got, wanted):
        self.assertLess(np.abs(got - wanted).max(), 2e-6)

    def test_joints_turn_between_keys(self):
        path, stage = self.hero("turn.usda", {0: 0.0, 24: 2.4})
        stage.Save()
        for pose, angle in zip(pliant.load_poses(path + "#time=0,6,12,24,30").positions, (0, 0.6, 1.2, 2.4, 2.4)):
            self.same(pose, turned(POSES[0], self.JOINTS, angle))

    def test_instances(self):
        path, stage = self.hero("instances.usda", {0: 0.0, 1: 0.7})
        for k in range(2):
            copy = UsdSkel.Root.Define(stage, f"/copy{k}")
            copy.GetPrim().GetReferences().AddInternalReference("/hero")
            copy.GetPrim().SetInstanceable(True)
            copy.AddTranslateOp().Set((5 * k, 0, 0))
        stage.GetPrimAtPath("/hero").SetSpecifier(Sdf.SpecifierClass)
        stage.Save()
        one = turned(POSES[0], self.JOINTS, 0.7)
        self.same(pliant.load_poses(path).positions[1], np.concatenate([one, one + [5, 0, 0]]))

    def test_where_parts_are_bound(self):
        path, stage = self.hero("bound.usda", {0: 0.0, 1: 0.7}, bind=(0, 2, 0))
        UsdGeom.Xformable(stage.GetPrimAtPath("/hero/tube")).AddTranslateOp().Set((9, 9, 9))  # does not count
        UsdGeom.Xformable(stage.GetPrimAtPath("/hero/bones")).AddTranslateOp().Set((0, 0, 3), 2)
        stage.Save()
        bound = POSES[0] + [0, 2, 0]
        self.assertEqual(pliant.load_poses(path).names, ["frame 0", "frame 1", "frame 2"])
        for pose, angle in zip(pliant.load_poses([path + "#rest", path + "#time=0,1,2"]).positions, (0, 0, 0.7, 0.7)):
            self.same(pose, turned(bound, self.JOINTS, angle) + [0, 0, 3])

    def test_files_that_are_poses(self):
        paths = []
        for angle in (0.0, 1.2):
            path, stage = self.hero(f"pose{angle}.usda", {None: angle})
            stage.Save()
            paths.append(path)
        for choice in ("", "#time=0"):
            poses = pliant.load_poses([path + choice for path in paths])
            self.same(poses.positions[1], turned(POSES[0], self.JOINTS, 1.2))
        self.same(pliant.load_poses([paths[0], paths[1] + "#rest"]).positions[1], POSES[0])

    # Against what OpenUSD itself writes at keys.
    def test_as_openusd_bakes_them(self):
        path, stage = self.hero("baked.usda", {0: 0.2, 1: 0.9}, bind=(1, 0, 0))
        tube, bones = stage.GetPrimAtPath("/hero/tube"), stage.GetPrimAtPath("/hero/bones")
        for where, op in (("/hero/bones", (1, 2, 3)), ("/hero/tube", (3, 2, 1)), ("/hero", (0, 1, 0))):
            UsdGeom.Xformable(stage.GetPrimAtPath(where)).AddTranslateOp().Set(op)
        shape = UsdSkel.BlendShape.Define(stage, "/hero/tube/bend")
        shape.CreateOffsetsAttr(vectors(POSES[1] - POSES[0]))
        shape.CreateInbetween("half").SetOffsets(vectors(POSES[2] - POSES[0]))
        shape.GetInbetween("half").SetWeight(0.5)
        UsdSkel.BindingAPI(tube).CreateBlendShapesAttr(["bend"])
        UsdSkel.BindingAPI(tube).CreateBlendShapeTargetsRel().SetTargets([shape.GetPath()])
        animation = UsdSkel.Animation.Get(stage, "/hero/bones/move")
        animation.CreateBlendShapesAttr(["other", "bend"])
        for time in (0, 1):
            animation.CreateBlendShapeWeightsAttr().Set([1, 0.3 + 0.5 * time], time)
        stage.Save()
        poses = pliant.load_poses(path + "#time=0,1").positions
        self.assertTrue(bones and UsdSkel.BakeSkinning(stage.Traverse()))
        for time in (0, 1):
            points = np.array(UsdGeom.Mesh(tube).GetPointsAttr().Get(time), float)
            place = np.array(UsdGeom.Imageable(tube).ComputeLocalToWorldTransform(time))
            self.same(poses[time], points @ place[:3, :3] + place[3, :3])

    def test_wrong_joints(self):
        path, stage = self.hero("joints.usda", {0: 0.0, 1: 0.7})
        UsdSkel.BindingAPI(stage.GetPrimAtPath("/hero/tube")).GetJointIndicesPrimvar().Set([7] * len(POSES[0]))
        stage.Save()
        with self.assertRaisesRegex(ValueError, "joints.usda: /hero/tube: its joints do not fit its skeleton"):
            pliant.load_poses(path)
        UsdSkel.BindingAPI(stage.GetPrimAtPath("/hero/tube")).GetJointIndicesPrimvar().Set([0])
        stage.Save()
        with self.assertRaisesRegex(ValueError, "joints.usda: "):
            pliant.load_poses(path)


class Meshes(unittest.TestCase):
    def test_mirrored_parts_stay_outside_out(self):
        path, stage = new_mesh("mirrored.usda", POSES[0], FACES, "/left/tube")
        UsdGeom.Xform.Define(stage, "/left").AddScaleOp().Set(Gf.Vec3f(-1, 1, 1))
        UsdSkel.Root.Define(stage, "/hero").AddScaleOp().Set(Gf.Vec3f(1, -2, 1))
        mesh = add_mesh(stage, POSES[0], FACES, "/hero/tube")
        add_skin(stage, mesh.GetPrim(), "/hero/bones", {0: 0.0, 1: 0.7}, np.zeros(len(POSES[0])))
        mesh.CreateOrientationAttr(UsdGeom.Tokens.leftHanded)
        stage.Save()
        np.testing.assert_array_equal(pliant.load_poses([path, path]).faces,
                                      np.concatenate([FACES, len(POSES[0]) + FACES[:, ::-1]]))

    def test_parts_in_another_order(self):
        paths = []
        for name, order in (("order.usda", (0, 1)), ("reversed.usda", (1, 0))):
            path, stage = new_mesh(name, POSES[0], FACES, "/body")
            for k in order:
                add_mesh(stage, POSES[0] + [0, 0, 3 + k], FACES, f"/eye{k}")
            stage.Save()
            paths.append(path)
        poses = pliant.load_poses(paths)
        np.testing.assert_array_equal(poses.positions[0], poses.positions[1])

    def test_faces_of_all_kinds(self):
        """Holes are left out; the others become fans, from the first corner as they are drawn."""
        path, stage = new_mesh("kinds.usda", np.random.default_rng(2).random((6, 3)), FACES[:1])
        mesh = UsdGeom.Mesh.Get(stage, "/tube")
        mesh.CreateFaceVertexCountsAttr([3, 5, 4, 3])
        mesh.CreateFaceVertexIndicesAttr([0, 1, 2, 1, 2, 3, 4, 5, 0, 1, 2, 3, 3, 4, 5])
        mesh.CreateHoleIndicesAttr([2])
        for orientation, faces in (("rightHanded", [[0, 1, 2], [1, 2, 3], [1, 3, 4], [1, 4, 5], [3, 4, 5]]),
                                   ("leftHanded", [[2, 1, 0], [5, 4, 3], [5, 3, 2], [5, 2, 1], [5, 4, 3]])):
            mesh.CreateOrientationAttr(orientation)
            stage.Save()
            np.testing.assert_array_equal(pliant.load_poses([path, path]).faces, faces)

    def test_instances_of_points(self):
        path, stage = new_mesh("points.usda", POSES[0], FACES)
        UsdGeom.PointInstancer.Define(stage, "/buttons")
        add_mesh(stage, POSES[1], FACES, "/buttons/button")
        stage.Save()
        with self.assertWarnsRegex(pliant.PliantWarning, "P2313: .*points.usda: instances of points are ignored: /buttons"):
            poses = pliant.load_poses([path, path])
        np.testing.assert_array_equal(poses.positions[0], POSES[0])

    def test_parts_places_and_what_is_not_drawn(self):
        path, stage = new_mesh("parts.usda", POSES[0], FACES, "/group/tube")
        group = UsdGeom.Xform.Define(stage, "/group")
        group.AddTranslateOp().Set((0, 5, 0), 1)
        group.GetOrderedXformOps()[0].Set((0, 7, 0), 2)
        add_mesh(stage, POSES[1], QUADS, "/other").CreateOrientationAttr(UsdGeom.Tokens.leftHanded)
        UsdGeom.Imageable(add_mesh(stage, POSES[1], FACES, "/hidden")).MakeInvisible()
        UsdGeom.Imageable(add_mesh(stage, POSES[1], FACES, "/later")).CreateVisibilityAttr().Set("invisible", 1)
        add_mesh(stage, POSES[1], FACES, "/guide").CreatePurposeAttr(UsdGeom.Tokens.guide)
        stage.Save()
        poses = pliant.load_poses(path)
        n = len(POSES[0])
        self.assertEqual(poses.positions.shape, (2, 2 * n, 3))
        self.assertLess(np.abs(poses.positions[1, :n] - POSES[0] - [0, 7, 0]).max(), 1e-12)
        np.testing.assert_array_equal(poses.positions[1, n:], POSES[1])
        flipped = QUADS[:, ::-1]
        fans = np.stack([flipped[:, [0, 1, 2]], flipped[:, [0, 2, 3]]], 1).reshape(-1, 3)
        np.testing.assert_array_equal(poses.faces, np.concatenate([FACES, n + fans]))

    def test_parts_that_appear_later(self):
        path, stage = new_mesh("later.usda", POSES[0], FACES)
        seen = UsdGeom.Imageable(add_mesh(stage, POSES[1], FACES, "/with/helmet")).CreateVisibilityAttr()
        seen.Set("invisible", 1)
        seen.Set("inherited", 20)
        add_mesh(stage, POSES[1], FACES, "/without/helmet")
        UsdGeom.Imageable(UsdGeom.Xform.Define(stage, "/without")).CreateVisibilityAttr().Set("invisible", 1)
        stage.Save()
        self.assertEqual(len(pliant.load_poses([path, path]).positions[0]), 2 * len(POSES[0]))

    def test_files_that_are_written_again(self):
        path, stage = new_mesh("again.usda", POSES[0], FACES)
        stage.Save()
        held = Usd.Stage.Open(path)  # as an error in a notebook holds one
        other, stage = new_mesh("before.usda", POSES[1], FACES)
        stage.Save()
        Path(path).write_bytes(Path(other).read_bytes())
        np.testing.assert_array_equal(pliant.load_poses([path, path]).positions[0], POSES[1])
        self.assertTrue(held)

    def test_faces_that_change(self):
        path = write_frames("faces.usda")
        stage = Usd.Stage.Open(path)
        corners = UsdGeom.Mesh.Get(stage, "/tube").GetFaceVertexIndicesAttr()
        corners.Set([int(v) for v in FACES.ravel()], 1)
        corners.Set([int(v) for v in FACES[:, ::-1].ravel()], 12)
        stage.Save()
        with self.assertRaisesRegex(ValueError, "/tube: has other faces at frame 12 than at first"):
            pliant.load_poses(path)

    def test_many_blend_shapes(self):
        path, stage = new_mesh("many.usda", POSES[0], FACES)
        add_shapes(stage, "/tube", 65)
        stage.Save()
        number, message = number_of(pliant.load_poses, path)
        self.assertEqual((number, "65 blend shapes given, the limit is 64" in message), ("P3002", True), message)
        self.assertEqual(len(pliant.load_poses([path + "#rest", path + "#target=s1,s64"]).names), 3)

    # 10 kB: a tree of 10^6 triangles; 20 kB: 2,500 under 1,000 transforms, which each of them looks at.
    def test_instances_of_instances(self):
        mesh = ("def Mesh \"m\"", "int[] faceVertexCounts = [3]", "int[] faceVertexIndices = [0, 1, 2]",
                "point3f[] points = [(0,0,0), (1,0,0), (0,1,0)]")
        for name, depth, widths in (("wide", 1, [10] * 6), ("deep", 1000, [50, 50])):
            lines = ["#usda 1.0", "class Xform \"L0\"", "{", mesh[0], "{", *mesh[1:], "}", "}"]
            for level, width in enumerate(widths):
                lines += [f"class Xform \"L{level + 1}\"", "{"]
                for i in range(width):
                    lines += [f"def Xform \"c{i}\" (", "instanceable = true", f"references = </L{level}>", ")", "{", "}"]
                lines.append("}")
            for i in range(depth):
                lines += [f"def Xform \"x{i}\"", "{"]
            lines += ["def Xform \"all\" (", "instanceable = true", f"references = </L{len(widths)}>", ")", "{", "}"]
            path = Path(FOLDER.name, name + ".usda")
            path.write_text("\n".join(lines + ["}"] * depth) + "\n")
            self.assertEqual(number_of(pliant.load_poses, path)[0], "P2333", name)

    # 50 kB: an array of many equal numbers takes crate files nothing.
    def test_long_arrays(self):
        for name in ("holeIndices", "faceVertexCounts", "pointIndices"):
            path, stage = new_mesh(f"long_{name}.usdc", POSES[0], FACES)
            add_shapes(stage, "/tube", 1)
            where = "/tube/s0" if name == "pointIndices" else "/tube"
            stage.GetPrimAtPath(where).GetAttribute(name).Set(Vt.IntArray(20000000, 0))
            stage.Save()
            number, message = number_of(pliant.load_poses, path)
            self.assertEqual(number, "P2333", message)

    # Some kB: 3,600 meshes that share 300 names, 2,500 that share 60 blend shapes, 400 that share 100 influences a point.
    def test_what_instances_share(self):
        for name, widths, shape_count, influence_count in (("names", [60, 60], 300, 0), ("poses", [50, 50], 60, 0),
                                                           ("influences", [20, 20], 1, 300)):
            path = str(Path(FOLDER.name, f"shared_{name}.usda"))
            stage = Usd.Stage.CreateNew(path)
            mesh = add_mesh(stage, np.eye(3).tolist() * (1 if influence_count == 0 else 20), [(0, 1, 2)], "/L0/m")
            add_shapes(stage, "/L0/m", shape_count)
            binding = UsdSkel.BindingAPI(mesh.GetPrim())
            if influence_count > 0:
                add_skin(stage, mesh.GetPrim(), "/L0/bones", {k: 0.1 * k for k in range(60)}, [0])
                binding.CreateJointIndicesPrimvar(False, influence_count).Set([0] * influence_count * 60)
                binding.CreateJointWeightsPrimvar(False, influence_count).Set([1.0] * influence_count * 60)
                UsdSkel.Root.Define(stage, "/L0")
            for level, width in enumerate(widths):
                for i in range(width):
                    prim = stage.DefinePrim(f"/L{level + 1}/c{i}")
                    prim.GetReferences().AddInternalReference(f"/L{level}")
                    prim.SetInstanceable(True)
            stage.Save()
            number, message = number_of(pliant.load_poses, path, blend="average" if influence_count > 0 else None)
            self.assertEqual(number, "P2333", (name, message))

    # Skeletons, drawn or not, share 100,000 names of joints, or meshes inherit them.
    def test_shared_names_of_joints(self):
        for kind, where in (("Skeleton", "Xform"), ("Skeleton", "PointInstancer"), ("Mesh", "Xform")):
            path, stage = new_mesh(f"joints_{kind}{where}.usdc", POSES[0], FACES, "/hero/tube")
            UsdSkel.Root.Define(stage, "/hero")
            first, above = stage.DefinePrim("/hero/first", kind), stage.DefinePrim("/hero/bones", where)
            UsdSkel.BindingAPI.Apply(first)
            holder, name = (first, "joints") if kind == "Skeleton" else (above, "skel:joints")
            holder.CreateAttribute(name, Sdf.ValueTypeNames.TokenArray).Set([f"j{k}" for k in range(100000)])
            for k in range(100):
                prim = stage.DefinePrim(f"/hero/bones/c{k}")
                prim.GetReferences().AddInternalReference("/hero/first")
                user = stage.DefinePrim(f"/hero/u{k}")
                UsdSkel.BindingAPI.Apply(user).CreateSkeletonRel().SetTargets([prim.GetPath()])
            stage.Save()
            self.assertEqual(number_of(pliant.load_poses, path)[0], "P2333", (kind, where))

    # Of a mesh without points.
    def test_what_frames_read(self):
        count = 20000000
        for name in ("influences", "weights"):
            path, stage = new_mesh(f"read_{name}.usdc", POSES[0], FACES, "/hero/tube")
            UsdSkel.Root.Define(stage, "/hero")
            empty = add_mesh(stage, np.zeros((0, 3)), [], "/hero/empty")
            add_skin(stage, empty.GetPrim(), "/hero/bones", {k: 0.1 * k for k in range(6)}, [])
            binding = UsdSkel.BindingAPI(empty.GetPrim())
            if name == "influences":
                binding.CreateJointIndicesPrimvar(True, count).Set(Vt.IntArray(count, 0))
                binding.CreateJointWeightsPrimvar(True, count).Set(Vt.FloatArray(count, 1))
            else:
                UsdSkel.Animation.Get(stage, "/hero/bones/move").CreateBlendShapeWeightsAttr(Vt.FloatArray(count, 0))
            stage.Save()
            self.assertEqual(number_of(pliant.load_poses, path)[0], "P2333", name)

    # Every frame reads all blend shapes, and prims may share one.
    def test_blend_shapes_at_frames(self):
        path, stage = new_mesh("shape_frames.usdc", POSES[0], FACES, "/hero/tube")
        prim = stage.GetPrimAtPath("/hero/tube")
        UsdSkel.Root.Define(stage, "/hero")
        add_skin(stage, prim, "/hero/bones", {1: 0.1, 2: 0.2}, [0] * len(POSES[0]))
        shape = UsdSkel.BlendShape.Define(stage, "/shape")
        shape.CreateOffsetsAttr(Vt.Vec3fArray(80000, Gf.Vec3f(0, 0, 1)))
        shape.CreatePointIndicesAttr(Vt.IntArray(80000, 0))
        binding = UsdSkel.BindingAPI(prim)
        names = [f"s{k}" for k in range(300)]
        binding.CreateBlendShapesAttr(["one name"])
        for name in names:
            copy = UsdSkel.BlendShape.Define(stage, f"/hero/tube/{name}")
            copy.GetPrim().GetReferences().AddInternalReference("/shape")
            binding.CreateBlendShapeTargetsRel().AddTarget(copy.GetPath())
        stage.Save()
        number, message = number_of(pliant.load_poses, path, blend="average")
        self.assertEqual(number, "P2333", message)

    # The place of 200 meshes has 20,000 operations, which are computed once a frame.
    def test_places_are_computed_once(self):
        lines = ["#usda 1.0", "def Xform \"all\"", "{", "double3 xformOp:translate.timeSamples = {1: (0,0,0), 2: (1,0,0)}",
                 "uniform token[] xformOpOrder = [" + ", ".join(["\"xformOp:translate\""] * 20000) + "]"]
        for k in range(200):
            lines += [f"def Mesh \"m{k}\"", "{", "int[] faceVertexCounts = [3]", "int[] faceVertexIndices = [0, 1, 2]",
                      "point3f[] points = [(0,0,0), (1,0,0), (0,1,0)]", "}"]
        path = Path(FOLDER.name, "operations.usda")
        path.write_text("\n".join(lines + ["}"]) + "\n")
        start = time.process_time()
        poses = pliant.load_poses(str(path)).positions
        self.assertLess(time.process_time() - start, 5)
        self.assertEqual(poses[1][0, 0], 20000)

    # The bytes of a frame's file count once it is opened.
    def test_clips(self):
        points = np.random.default_rng(1).normal(size=(9000, 3))
        corners = [[k, k + 1, k + 2] for k in range(0, len(points), 3)]
        for k in range(40):
            clip = Usd.Stage.CreateNew(str(Path(FOLDER.name, f"clip{k}.usdc")))
            UsdGeom.Mesh.Define(clip, "/tube").CreatePointsAttr().Set(vectors(points + k), k)
            clip.Save()
        path, stage = new_mesh("clips.usdc", points, corners)
        prim = stage.GetPrimAtPath("/tube")
        prim.GetAttribute("points").Clear()
        clips = Usd.ClipsAPI(prim)
        clips.SetClipAssetPaths([Sdf.AssetPath(f"./clip{k}.usdc") for k in range(40)])
        clips.SetClipPrimPath("/tube")
        clips.SetClipActive([(k, k) for k in range(40)])
        clips.SetClipTimes([(k, k) for k in range(40)])
        manifest = str(Path(FOLDER.name, "manifest.usda"))  # without it all clips are opened with the stage
        clips.GenerateClipManifest().Export(manifest)
        clips.SetClipManifestAssetPath(manifest)
        stage.Save()
        del stage, prim, clips, clip
        times = ",".join(str(k) for k in range(40))
        with mock.patch.multiple(pliant._usd, _COST=500000, _COST_FOR_BYTE=1):
            self.assertEqual(len(pliant.load_poses(f"{path}#time={times}").positions), 40)

    def test_wrong_files(self):
        number, message = number_of(pliant.load_poses, "nowhere.usd")
        self.assertEqual(number, "P2001")
        self.assertIn("nowhere.usd: cannot be read: No such file", message)
        broken = Path(FOLDER.name, "broken.usda")
        broken.write_text("#usda 1.0\n( this is none")
        self.assertEqual(number_of(pliant.load_poses, broken)[0], "P2001")
        empty = str(Path(FOLDER.name, "empty.usda"))
        Usd.Stage.CreateNew(empty).Save()
        with self.assertRaisesRegex(ValueError, "empty.usda: has no mesh that is drawn"):
            pliant.load_poses(empty)
        with self.assertRaisesRegex(ValueError, "paths: 'a.obj' is no USD file"):
            pliant.load_poses(["a.usd", "a.obj"])
        path, stage = new_mesh("corner.usda", POSES[0], FACES)
        UsdGeom.Mesh.Get(stage, "/tube").CreateFaceVertexIndicesAttr([999] * FACES.size)
        stage.Save()
        with self.assertRaisesRegex(ValueError, "corner.usda: /tube: a face has a corner that is not among its 112 points"):
            pliant.load_poses([path, path])
        other, stage = new_mesh("other.usda", POSES[0], FACES[::-1])
        stage.Save()
        with self.assertRaisesRegex(ValueError, "other.usda: has other vertices or faces than .*frames.usda"):
            pliant.load_poses([write_frames("frames.usda"), other])
        changing = write_frames("changing.usda")
        stage = Usd.Stage.Open(changing)
        UsdGeom.Mesh.Get(stage, "/tube").GetPointsAttr().Set(vectors(POSES[0][:5]), 12)
        stage.Save()
        with self.assertRaisesRegex(ValueError, "/tube: has 5 points at frame 12 and 112 at first"):
            pliant.load_poses(changing)

    def test_wrong_attributes(self):
        mesh = ('#usda 1.0\ndef Mesh "m" (prepend apiSchemas = ["SkelBindingAPI"])\n{{\n'
                'int[] faceVertexCounts = [{counts}]\nint[] faceVertexIndices = [{corners}]\n{points}\n{more}\n}}\n')
        good = {"counts": "3", "corners": "0, 1, 2", "points": "point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]",
                "more": ""}
        shapes = 'uniform token[] skel:blendShapes = ["smile"]\nrel skel:blendShapeTargets = <{}>'
        for name, changed, text in (
                ("lost", {"more": shapes.format("/nowhere")}, "/m: blend shape 'smile' is not in the file: /nowhere"),
                ("point", {"more": shapes.format("/m.points")}, "/m: blend shape 'smile' is not in the file: /m.points"),
                ("word", {"points": 'string[] points = ["a"]'}, "/m: points are not numbers"),
                ("pair", {"points": "float2[] points = [(0, 1)]"}, "/m: points are not vectors of three numbers"),
                ("bare", {"counts": "", "corners": ""}, "its meshes have no faces")):
            path = Path(FOLDER.name, name + ".usda")
            path.write_text(mesh.format(**{**good, **changed}))
            with self.assertRaisesRegex(ValueError, f"{name}.usda: {text}"):
                pliant.load_poses(path)

    def test_without_usd(self):
        program = "import sys; sys.modules['pxr'] = None; import pliant; pliant.load_poses('hero.usd')"
        done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
        self.assertIn("ImportError: hero.usd: reading USD needs usd-core: pip install 'pliant[usd]'", done.stderr)


if __name__ == "__main__":
    unittest.main(verbosity=2)
