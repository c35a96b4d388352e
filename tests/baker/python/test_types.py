"""The types that the package promises, by mypy: its own files, its stubs against the module, a user's program."""
import ast
import importlib.util
import os
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import pliant
from pliant._module import core

SAMPLE = Path(os.environ["PLIANT_SOURCE"], "samples/python/blend_in_ten_lines.py")

RIGHT = """
import numpy as np
import numpy.typing as npt
import pliant

poses: npt.NDArray[np.float64] = pliant.load_poses(["a.obj", "b.obj"]).positions
asset: pliant.Asset = pliant.bake(poses, [[0, 1, 2]], material="arap", progress=lambda stage, done, total: None)
shape: npt.NDArray[np.float32] = asset.blend([1, 2])
data: bytes = bytes(pliant.Asset.open(b""))
basis: npt.NDArray[np.float32] = asset.basis
energy: pliant.Energy = pliant.energy(poses, [[0, 1, 2]], material="arap")
slope: npt.NDArray[np.float64] = energy.gradient(poses[0], [1, 2]) * energy.value(poses[0])


class Mesh:
    vertices = poses[0]
    faces = np.zeros((1, 3), np.int64)


pliant.show(pliant.bake([Mesh(), Mesh()]), picture="mesh.png")
try:
    truth: npt.NDArray[np.float64] = pliant.average(poses, weights=[1, 2], tets=[[0, 1, 2, 3]])
except pliant.ToleranceError as error:
    number: str = error.number
    saved: pliant.Asset | None = error.asset
summary: pliant.batch.Summary = pliant.batch.run("all.json", workers=2,
                                                 progress=lambda record, done, total: print(record["name"]))
"""

WRONG = """
import pliant
pliant.bake([[[0.0]]], [[0]], material="rubber")  # line 3
pliant.bake([[[0.0]]], [[0]], tolerance="fine")  # line 4
pliant.Asset.open(b"").blend([1]).no_such_thing  # line 5
pliant.load_poses(3)  # line 6
"""


CACHE = tempfile.TemporaryDirectory()  # mypy's, in its folder: numpy is looked at once


def mypy(*arguments, module="mypy"):
    return subprocess.run([sys.executable, "-m", module, *arguments], cwd=CACHE.name, capture_output=True, text=True)


def mypy_of(program):
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, "program.py")
        file.write_text(program)
        return mypy("--strict", str(file))


@unittest.skipUnless(importlib.util.find_spec("mypy"), "mypy is not installed")
class Types(unittest.TestCase):
    def test_package(self):
        done = mypy("--strict", "-p", "pliant")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_stubs_have_the_names_of_the_module(self):
        with tempfile.NamedTemporaryFile("w", suffix=".txt") as known:
            # nanobind's functions are objects of its own, and its classes have a metaclass: stubtest looks no further there.
            functions = [name for name, member in vars(core).items() if type(member).__name__ == "nb_func"]
            classes = ["AssetView", "EnergyView", "Poses", "Poses.__init__"]
            known.write("\n".join(f"pliant._core.{name}" for name in functions + classes))
            known.flush()
            done = mypy("--allowlist", known.name, "pliant._core", module="mypy.stubtest")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_stubs_have_the_parameters_of_the_module(self):
        stub = ast.parse(Path(pliant.__file__).with_name("_core.pyi").read_text())
        compared = 0
        for scope in [stub] + [node for node in stub.body if isinstance(node, ast.ClassDef)]:
            owner = core if scope is stub else getattr(core, scope.name)
            for function in (node for node in scope.body if isinstance(node, ast.FunctionDef)):
                if function.decorator_list:
                    continue  # a property
                signature = getattr(owner, function.name).__doc__.splitlines()[0].split(" -> ")[0]
                names = re.findall(r"(?:\(|, )(\w+)(?=:|, |\))", signature)
                self.assertEqual(names, [argument.arg for argument in function.args.args], signature)
                compared += 1
        self.assertGreater(compared, 15)

    def test_users(self):
        done = mypy_of(RIGHT)
        self.assertEqual(done.returncode, 0, done.stdout)
        done = mypy("--strict", str(SAMPLE))
        self.assertEqual(done.returncode, 0, done.stdout)

    def test_mistakes_are_seen(self):
        done = mypy_of(WRONG)
        for line in (3, 4, 5, 6):
            self.assertIn(f"program.py:{line}: error", done.stdout)


if __name__ == "__main__":
    unittest.main(verbosity=2)
