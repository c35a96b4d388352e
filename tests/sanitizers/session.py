"""A session with the tool: every verb on small bodies of every kind. Under a sanitizer, or valgrind, whose report is a
failure:

session.py [options] TOOL [KIND...]      kinds: averages layers scene solid all-bakes interrupt (default: these) slice
                                         slice-bytes

--valgrind     start the tool under valgrind
--rings N      of the tubes that are baked (default 9); above 260 loops over faces are split over threads
--threads N    of a bake (default 2)

A step fails if its exit code is not the expected one, or if a report of a sanitizer is in what it writes.
"""
import argparse
import io
import json
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time

from PIL import Image

TESTS = pathlib.Path(__file__).resolve().parents[1]
sys.path[:0] = [str(TESTS / "baker/python"), str(TESTS / "bad_input")]
import gltf_files  # noqa: E402
import shapes  # noqa: E402

REPORT = re.compile(r"(?:ERROR|WARNING): \w+Sanitizer|runtime error:")
QUICK = ["--dim", "3", "--elements", "18", "--check-samples", "2", "--fresh-samples", "1"]
# The tool starts itself again unless these are set, and /proc/self/exe is valgrind then.
VALGRIND = ["env", "OPENBLAS_NUM_THREADS=1", "OPENBLAS_CORETYPE=Haswell", "valgrind", "--quiet", "--error-exitcode=99"]


class Session:
    def __init__(self, options, folder):
        self.options, self.folder, self.failures, self.steps = options, folder, 0, 0
        self.tool = [*(VALGRIND if options.valgrind else []), options.tool]

    def judge(self, words, seconds, expected, returned, errors):
        is_good = returned == expected and not REPORT.search(errors)
        self.steps += 1
        self.failures += not is_good
        print(f"{'ok    ' if is_good else 'FAILED'} {seconds:6.1f} s  pliant {' '.join(words)}", flush=True)
        if not is_good:
            print(f"exit code {returned}, expected {expected}", errors, sep="\n", flush=True)

    def run(self, *words):
        """One call of the tool in the session's folder."""
        words, start = [str(word) for word in words], time.monotonic()
        done = subprocess.run([*self.tool, *words], cwd=self.folder, stdin=subprocess.DEVNULL, capture_output=True,
                              text=True, check=False)
        self.judge(words, time.monotonic() - start, 0, done.returncode, done.stderr)

    def bake(self, *words):
        self.run("bake", *words, *QUICK, "--threads", self.options.threads)

    def use(self, asset, weights, *exports):
        """What is done with an asset after its bake. An export is its options."""
        self.run("blend", asset, "--weights", weights, "-o", "blend.ply")
        self.run("validate", asset)
        self.run("info", asset, "--json")
        for options in exports:
            self.run("export", asset, *options, "-o", "out.glb")
        self.run("report", asset, "-o", "page.html")


def tubes(session, angles):
    poses, faces = shapes.tubes(angles, rings=session.options.rings, sides=8)
    for i, pose in enumerate(poses):
        shapes.write_obj(session.folder / f"pose_{i}.obj", pose, faces)
    return [f"pose_{i}.obj" for i in range(len(poses))]


def averages(session):
    """Three poses of a surface, from files of three formats."""
    poses = tubes(session, (0.0, 1.2, -0.8))
    session.run("average", *poses, "--weights", "1,2,1", "-o", "mean.ply")
    session.run("average", *poses[:2], "--weights", "1,1", "-o", "half.ply", "--material", "arap")
    session.run("check", *poses, "--json")
    session.bake(poses[0], "mean.ply", poses[2], "-o", "tube.pliant", "--report", "tube.json", "--depfile", "tube.d",
                 "--stamp", "tube.stamp")
    (session.folder / "path.csv").write_text("1,0,0\n0,1,1\n", encoding="utf-8")
    session.use("tube.pliant", "1,1,0", [], ["--skin", 4], ["--meshopt"], ["--path", "path.csv"],
                ["--embed"])
    session.run("report", "tube.json", "-o", "tube.html")
    session.run("measure", "tube.pliant", poses[0], "mean.ply", poses[2], "--samples", 2)
    session.bake(*poses[:2], "-o", "flat.pliant", "--position-error", "0", "--subspace", "krylov", "--continuity", "off")
    session.bake(*poses[:2], "-o", "ghost.pliant", "--energy", "ghost", "--ghost-vertices", 20)


def layers(session):
    """A rest shape with two layers."""
    poses = tubes(session, (0.0, 0.9, -0.7))
    session.run("average", *poses, "--blend", "layers", "--weights=1,-0.5", "-o", "sum.ply")
    session.bake(*poses, "--blend", "layers", "--range=-0.5:1", "-o", "layers.pliant")
    session.use("layers.pliant", "1,0.5", ["--quantize", "1e-4"])
    session.run("measure", "layers.pliant", *poses, "--samples", 2)


def write_scene(path, rings):
    """A GLB: a tube with two morph targets, texture coordinates, colours, a material and its image."""
    (rest, *targets), faces = shapes.tubes((0.0, 0.8, -0.6), rings=rings, sides=8)
    made = gltf_files.Gltf()
    coordinates = made.accessor([(float(x), float(y)) for x, y, _ in rest])
    colours = made.accessor([(i % 256, 7, 9, 255) for i in range(len(rest))], 5121, normalized=True)
    primitive = made.mesh([tuple(map(float, row)) for row in rest], [tuple(map(int, face)) for face in faces],
                          [[tuple(map(float, row)) for row in target - rest] for target in targets], ["one", "two"],
                          TEXCOORD_0=coordinates, COLOR_0=colours)
    primitive["material"] = 0
    png = io.BytesIO()
    Image.new("RGBA", (2, 2), "red").save(png, "PNG")
    made.json.update(materials=[{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}], textures=[{"source": 0}],
                     images=[{"bufferView": made.view(png.getvalue()), "mimeType": "image/png"}])
    path.write_bytes(made.glb())


def scene(session):
    """A glTF file with morph targets: layers by their names, materials and an image."""
    bake_scene(session)
    session.run("blend", "face.pliant", "--set", "one=1", "-o", "face.ply")
    session.use("face.pliant", "0.5,1", ["--no-normals"])
    session.run("average", "face.glb#rest", "face.glb#target=one", "--weights", "1,1", "-o", "half.ply")


def bake_solid(session):
    """A bar of tetrahedra and what `pliant pose` makes of it, with a surface of its own."""
    (rest, *_), tets = shapes.bars()
    shapes.write_medit(session.folder / "bar.mesh", rest, tets)
    script = "box 0 0 0  0.1 1 1  hold\nbox 0.9 0 0  1 1 1  move 0 0.2 0\n"
    (session.folder / "bend.txt").write_text(script, encoding="utf-8")
    session.run("pose", "bar.mesh", "bend.txt", "-o", "bent.msh", "--ply", "bent.ply")
    surface, faces = shapes.tube(0.0, rings=5, sides=6)
    shapes.write_obj(session.folder / "skin.obj", 0.6 * surface, faces)
    session.bake("bar.mesh", "bent.msh", "--surface", "skin.obj", "-o", "bar.pliant")


def solid(session):
    """Solids of both materials."""
    bake_solid(session)
    session.run("average", "bar.mesh", "bent.msh", "--weights", "1,1", "-o", "half.ply", "--all")
    session.use("bar.pliant", "1,2", ["--morph"])
    session.bake("bar.mesh", "bent.msh", "--material", "mooney-rivlin", "--energy", "cubature", "-o", "rubber.pliant")
    session.run("measure", "rubber.pliant", "bar.mesh", "bent.msh", "--samples", 1)


def all_bakes(session):
    """A manifest: two bakes at the same time, then none, because nothing changed."""
    if session.options.valgrind:  # the children start as /proc/self/exe, which is valgrind
        return
    poses = tubes(session, (0.0, 1.2))
    manifest = {"defaults": {"dim": 3, "elements": 18, "check_samples": 2, "fresh_samples": 0},
                "bakes": [{"name": "one", "poses": poses}, {"name": "two", "poses": poses, "seed": 2}]}
    (session.folder / "all.json").write_text(json.dumps(manifest), encoding="utf-8")
    for _ in range(2):
        session.run("bake-all", "all.json", "--jobs", 2)


def slice_of_all(session):
    """A bake of each kind and each verb that computes, once: what every run of the suite does under sanitizers."""
    poses = tubes(session, (0.0, 1.2))
    session.run("average", *poses, "--weights", "1,1", "-o", "mean.ply")
    session.bake(*poses, "mean.ply", "-o", "tube.pliant", "--report", "tube.json")
    session.run("measure", "tube.pliant", *poses, "mean.ply", "--samples", 1)
    session.run("report", "tube.json", "-o", "tube.html")
    bake_scene(session)
    bake_solid(session)
    session.run("blend", "bar.pliant", "--weights", "1,2", "-o", "blend.ply")


def bake_scene(session):
    """A bake of layers from a glTF file with an image, and what is written of it."""
    write_scene(session.folder / "face.glb", session.options.rings)
    session.bake("face.glb", "-o", "face.pliant")
    session.run("export", "face.pliant", "--meshopt", "-o", "out.glb")


def interrupt(session):
    """A bake is interrupted while its threads compute averages."""
    words = ["bake", *tubes(session, (0.0, 1.2, -0.8)), "-o", "never.pliant", "--verbose", "--check-samples", "1000",
             "--threads", str(session.options.threads)]
    start = time.monotonic()
    child = subprocess.Popen([*session.tool, *words], cwd=session.folder, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                             stderr=subprocess.STDOUT, text=True)
    said = ""
    for line in child.stdout:
        said += line
        if "averages" in line:
            child.send_signal(signal.SIGINT)
    session.judge(words, time.monotonic() - start, 130, child.wait(), said)


KINDS = {"averages": averages, "layers": layers, "scene": scene, "solid": solid, "all-bakes": all_bakes,
         "interrupt": interrupt}
SLICES = {"slice": slice_of_all, "slice-bytes": bake_scene}


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--valgrind", action="store_true")
    parser.add_argument("--rings", type=int, default=9)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("tool")
    parser.add_argument("kinds", nargs="*")
    options = parser.parse_args()
    options.tool = str(pathlib.Path(options.tool).resolve())
    if options.valgrind and not shutil.which("valgrind"):
        print("skipped: there is no valgrind (bash samples/install_packages.sh tests)")
        return 77
    failures, steps, start = 0, 0, time.monotonic()
    for kind in options.kinds or KINDS:
        with tempfile.TemporaryDirectory(prefix="pliant_session_") as folder:
            session = Session(options, pathlib.Path(folder))
            {**KINDS, **SLICES}[kind](session)
            failures, steps = failures + session.failures, steps + session.steps
    print(f"{steps} calls of the tool, {failures} failed, {time.monotonic() - start:.0f} s")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
