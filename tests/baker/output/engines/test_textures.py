"""test_textures.py TOOL BUILD: what a glTF source is painted with comes through bake and export. A generated tube
(textured.py) keeps parts, texture coordinates, colours, materials and image in every kind of export; the Khronos validator
finds nothing; and three.js draws them as it draws the source, in both poses. Blender, if there is one, finds materials and
image."""
import json
import pathlib
import shutil
import subprocess
import sys

import textured
from support import HERE, SKIPPED, Glb, blender, blender_report, check, export, run_node
from test_validator import remarks

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[3]))
from asset_checksums import with_checksums  # noqa: E402

KINDS = {"morph": [], "embed": ["--embed"], "skin": ["--skin", "6"], "integers": ["--quantize", "1e-4"],
         "all": ["--meshopt", "--embed", "--skin", "6"]}


def bake(tool, source, output):
    result = subprocess.run([tool, "bake", source, "--blend", "average", "-o", output, "--dim", "6", "--elements", "10",
                             "--no-align", "--quiet"], capture_output=True, text=True, timeout=200)
    check(result.returncode == 0, f"bake: exit code {result.returncode}\n{result.stdout}{result.stderr}")


def check_painting(kind, glb, source):
    """Of the JSON and the bytes: all as in the source, part by part."""
    primitives, wanted = glb.json["meshes"][0]["primitives"], source.json["meshes"][0]["primitives"]
    check(len(primitives) == len(wanted) == 3, f"{kind}: {len(primitives)} primitives")
    first = 0
    for i, (one, other) in enumerate(zip(primitives, wanted)):
        check(one.get("material") == other.get("material"), f"{kind}: material of part {i}")
        names = {name for name in one["attributes"] if name.startswith(("TEXCOORD", "COLOR"))}
        check(names == {name for name in other["attributes"] if name != "POSITION"}, f"{kind}: part {i} has {names}")
        for name in names:
            if "--meshopt" not in KINDS[kind]:
                wanted_rows = source.accessor(other["attributes"][name])
                check((glb.accessor(one["attributes"][name])[:len(wanted_rows)] == wanted_rows).all(),
                      f"{kind}: {name} of part {i}")
        if "--meshopt" not in KINDS[kind]:
            corners = source.accessor(other["indices"]).reshape(-1, 1)
            check((glb.accessor(one["indices"])[:len(corners)] == corners).all(), f"{kind}: faces of part {i}")
        count = source.json["accessors"][other["attributes"]["POSITION"]]["count"]
        box = 2 if "targets" in one else 0
        check(one["extras"]["pliant"]["first_vertex"] == first, f"{kind}: first vertex of part {i}")
        check({glb.json["accessors"][a]["count"] for a in one["attributes"].values()} == {count + box},
              f"{kind}: vertices of part {i}")
        first += count
    for key in ("materials", "textures", "samplers"):
        check(glb.json[key] == source.json[key], f"{kind}: {key} are {glb.json[key]}")
    for key in ("extensionsUsed", "extensionsRequired"):
        check(set(source.json[key]) <= set(glb.json[key]), f"{kind}: {key} are {glb.json[key]}")
    image, = glb.json["images"]
    bytes_in, bytes_out = source.view(source.json["images"][0]["bufferView"]), glb.view(image["bufferView"])
    check((image["mimeType"], image["name"], bytes_in) == ("image/png", "stripes", bytes_out), f"{kind}: image {image}")
    if "--embed" in KINDS[kind]:
        check(glb.binary.count(bytes_in) == 1, f"{kind}: the image is there twice")


def check_seam(glb):
    """The texture's seam does not show in the light: its two vertices have one normal."""
    normals = glb.attribute("NORMAL").reshape(textured.ALONG + 1, textured.ROUND + 1, 3)
    check(abs(normals[:, 0] - normals[:, -1]).max() < 1e-5,
          f"normals at the seam differ by {abs(normals[:, 0] - normals[:, -1]).max()}")


def check_other_vertices(tool, asset, folder):
    """P4505: a scene of one vertex more than the asset draws."""
    blob = asset.read_bytes()
    old, new = b'"vertex_count":17}', b'"vertex_count":18}'
    check(blob.count(old) == 2, f"{blob.count(old)} parts of 17 vertices")
    at = blob.rindex(old)
    damaged = folder / "damaged.pliant"
    damaged.write_bytes(with_checksums(blob[:at] + new + blob[at + len(old):]))
    said = export(tool, damaged, folder / "damaged.glb", code=3)
    check("error P4505" in said.stderr and not (folder / "damaged.glb").exists(), f"said: {said.stderr}")


def check_pictures(report, kinds, need):
    check("failed" not in report and not report["said"], f"three.js says {report}")
    for shown in report["shown"]:
        check(shown["covered"] > 0.1 and len(shown["colours"]) >= need,
              f"{kinds[shown['file'] - 1]}: next to nothing: {shown}")
        check(shown["far"] < 0.02, f"{kinds[shown['file'] - 1]}, pose {shown['pose']}: drawn otherwise: {shown}")


def draw(build, folder, source, files):
    browser = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
    if not browser:
        print("skipped: chromium is not installed (group engines of samples/install_packages.sh)")
        sys.exit(SKIPPED)
    paths = [source, *files]
    return json.loads(run_node(build, "three.mjs", browser, HERE / "textures.html", folder.resolve(), str(len(paths)),
                               *[path.resolve() for path in paths]))


def main():
    tool, build = sys.argv[1:]
    folder = pathlib.Path("textures")
    folder.mkdir(exist_ok=True)
    source, asset = folder / "source.glb", folder / "tube.pliant"
    textured.write(source, with_transform=True)
    bake(tool, source, asset)
    files = {}
    for kind, options in KINDS.items():
        files[kind] = folder / f"{kind}.glb"
        said = export(tool, asset, files[kind], *options)
        check("3 parts with the materials of the source, 1 image\n" in said.stdout, f"said: {said.stdout}")
        check_painting(kind, Glb(files[kind]), Glb(source))
    check_seam(Glb(files["morph"]))
    check_other_vertices(tool, asset, folder)
    report = json.loads(run_node(build, "validate.mjs", source, *files.values()))
    for path, found in report.items():
        check(found["errors"] == 0, f"{path}: {found}")
        if pathlib.Path(path).stem not in KINDS:
            continue
        options = KINDS[pathlib.Path(path).stem]
        check(found["warnings"] == 0 and not remarks(found, options), f"{path}: {found}")
    if blender():
        report = blender_report(blender(), files["morph"].resolve())
        check(report["materials"] == ["stripes", "lid", None] and ["stripes", 32, 8] in report["images"]
              and report["places"] == 1, f"Blender: {report}")
    report = draw(build, folder, source, files.values())
    check_pictures(report, list(files), 4)
    print(json.dumps({"files": len(files), "far": max(shown["far"] for shown in report["shown"]),
                      "pictures": len(report["shown"])}))
    return 0


if __name__ == "__main__":
    sys.exit(main())
