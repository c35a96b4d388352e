"""frame.py [--only TEXT] [OPTION...]: what a frame costs beside linear morph targets and skinning, at 7,000 to 166,000
vertices. Bakes the sets with the default options into build/bench/frame, where an asset is kept until it is deleted, and
prints the tables of pliant_bench_frame (frame.c), which gets the other options. The two largest sets are the creature of
10,400 vertices with every triangle cut in four, once and twice. Data: PLIANT_DATA; sets that are not there are left out."""
import argparse
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "tests" / "bench"), str(ROOT / "tests" / "paper")]
import bake_cost  # noqa: E402: builds the tool, knows the sets
import shapes  # noqa: E402: reads, cuts and writes triangles

SETS = ["human_pair", "creature", "makehuman, 4 poses"]
COARSE_VERTICES = 10400


def refined(binary, folder, levels):
    """The creature's poses after so many subdivisions."""
    bake_cost.call(binary / "samples" / "creature" / "creature", "-o", folder, "--vertices", COARSE_VERTICES)
    files = [folder / f"creature_{pose}.ply" for pose in ("rest", "reach", "curl", "leap", "twist")]
    meshes = [shapes.read_ply(file) for file in files]
    poses, triangles = [positions for positions, _ in meshes], meshes[0][1]
    for _ in range(levels):
        poses, triangles = shapes.subdivide(poses, triangles)
    for file, pose in zip(files, poses):
        shapes.write_ply(file, pose, triangles)
    return files


def sets(binary, folder):
    for name, poses, _ in bake_cost.surfaces(binary, folder):
        if name in SETS:
            yield name.split(",")[0], lambda poses=poses: poses
    for levels in (1, 2):
        yield f"creature x {4**levels}", lambda levels=levels: refined(binary, folder, levels)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", default="", help="sets whose name holds this")
    arguments, options = parser.parse_known_args()
    binary = bake_cost.build(ROOT, "pliant", "creature", "pliant_bench_frame")
    kept = ROOT / "build" / "bench" / "frame"
    kept.mkdir(parents=True, exist_ok=True)
    assets = []
    with tempfile.TemporaryDirectory(prefix="pliant-frame-") as name:
        for label, poses in sets(binary, pathlib.Path(name)):
            asset = kept / f"{label.replace(' ', '_')}.pliant"
            if arguments.only not in label:
                continue
            if not asset.exists():
                files = poses()
                if not all(pathlib.Path(file).exists() for file in files):
                    print(f"{label}: its poses are not there", file=sys.stderr)
                    continue
                bake_cost.bake(binary / "baker" / "pliant", files, [], asset)
            assets.append(f"{label}={asset}")
    subprocess.run([binary / "tests" / "bench" / "pliant_bench_frame", *assets, *options], check=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
