"""test_three.py TOOL BUILD SHAPES ASSET: three.js in headless Chromium draws the GLB of `pliant export`, plain and in
compressed integers, as it draws the positions that the C runtime makes: positions to 1e-5 of the diagonal and as near as
asked, pictures nearly the same (normals are fitted in one, recomputed in the other), culling by a box of all shapes."""
import json
import pathlib
import shutil
import subprocess
import sys

from support import HERE, Glb, check, export, run_node, skip, weight_count


def main():
    tool, build, program, asset = sys.argv[1:]
    browser = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
    if not browser:
        skip("chromium is not installed (group engines of samples/install_packages.sh)")
    folder = pathlib.Path("three")
    folder.mkdir(exist_ok=True)
    shapes = folder / "shape.bin"
    check(subprocess.run([program, asset, shapes], timeout=60).returncode == 0, f"{program} fails")
    for options, tolerance in ([], 1e-5), (["--meshopt"], 1.2e-4):
        glb = folder / f"shape{''.join(options)}.glb"
        export(tool, asset, glb, *options)
        check_file(build, browser, folder, glb, shapes, tolerance)
    return 0


def check_file(build, browser, folder, glb, shapes, tolerance):
    mesh = Glb(glb).json["meshes"][0]
    counts = [weight_count(mesh["extras"]["pliant"]), len(mesh["weights"]), Glb(glb).own_count()]
    report = json.loads(run_node(build, "three.mjs", browser, HERE / "three.html", folder.resolve(),
                                 ",".join(map(str, counts)), glb.resolve(), shapes.resolve()))
    check("failed" not in report and not report["said"], f"three.js says {report}")
    check([report["vertices"], report["targets"]] == [counts[2] + 2, counts[1]], f"counts: {report}")
    check(report["cullingHolds"], "the box that three.js culls by does not hold all shapes")
    check(report["names"] == mesh["extras"]["targetNames"], f"names: {report['names']}")
    check(report["animation"] < 1e-6, f"the animation gives other weights: {report['animation']}")
    for shape in report["shapes"]:
        check(shape["farthest"] < tolerance, f"a vertex lies {shape['farthest']:.1e} of the diagonal away")
        check(shape["covered"] > 0.03, f"the picture shows next to nothing: {shape}")
        check(shape["mean"] < 4 and shape["far"] < 0.02, f"the pictures differ: {shape}")
    print(json.dumps(report["shapes"]))


sys.exit(main())
