"""test_stamps.py PLIANT CHECKOUT: stamps say what an asset was baked from; manifests are checked,
and mistakes in them named."""
import hashlib
import json
import pathlib
import re
import resource
import sys
import tempfile

import support
from support import QUICK, QUICK_OPTIONS, check, poses, write_gltf, write_json

TOOL, SOURCE = support.Tool(sys.argv[1]), pathlib.Path(sys.argv[2])


def digest(path):
    return hashlib.sha256(path.read_bytes()).hexdigest()


def test_stamp(folder):
    rest, bent = poses(folder / "poses")
    (folder / "out").mkdir()
    result = TOOL.run("bake", "poses/rest.obj", "poses/bent.obj", "-o", "out/a.pliant", "--stamp", "out/a.stamp",
                      *QUICK_OPTIONS, cwd=folder)
    stamp = json.loads((folder / "out/a.stamp").read_text(encoding="utf-8"))
    wanted = [{"path": "../poses/rest.obj", "sha256": digest(rest)}, {"path": "../poses/bent.obj", "sha256": digest(bent)}]
    check(result.returncode == 0 and stamp["inputs"] == wanted,
          f"inputs, seen from the asset, and their SHA-256 {stamp['inputs']}")
    check(stamp["output"] == digest(folder / "out/a.pliant"), "the asset's SHA-256")
    check(stamp["options"]["poses"] == ["../poses/rest.obj", "../poses/bent.obj"] and "threads" not in stamp["options"],
          "options that count")
    check(str(folder) not in json.dumps(stamp), "no absolute path")


def outcomes(manifest, *options, cwd=None):
    result = TOOL.run("bake-all", manifest, "--json", "--quiet", *options, cwd=cwd)
    return {bake["name"]: bake for bake in json.loads(result.stdout)["bakes"]}, result


def test_what_counts(folder):
    """A tree may be moved and seen from elsewhere; options, version, inputs and the asset itself count."""
    first = folder / "first"
    poses(first / "poses")
    write_json(first / "m.json",
               {"defaults": QUICK,
                "bakes": [{"name": "a", "poses": ["poses/rest.obj", "poses/bent.obj"], "output": "a.pliant"}]})
    check(outcomes(first / "m.json")[0]["a"]["outcome"] == "baked", "baked")
    check(outcomes("m.json", cwd=first)[0]["a"]["outcome"] == "up to date", "seen from another folder: up to date")
    moved = folder / "moved elsewhere"
    first.rename(moved)
    check(outcomes(moved / "m.json")[0]["a"]["outcome"] == "up to date", "the tree moved: up to date")

    def reason(text, *options):
        bakes, result = outcomes(moved / "m.json", "--dry-run", *options)
        got = bakes["a"].get("reason", "")
        check(got == text and result.returncode == 0, f"{text}: {got} {result.stderr}")

    reason("forced", "--force")
    manifest = json.loads((moved / "m.json").read_text(encoding="utf-8"))
    for key, value, text in (("seed", 9, "other options"), ("threads", 2, ""), ("report", "r.json", "r.json is missing"),
                             ("dim", 4, "other options")):
        changed = json.loads(json.dumps(manifest))
        changed["bakes"][0][key] = value
        write_json(moved / "m.json", changed)
        reason(text)
    write_json(moved / "m.json", manifest)
    stamp = moved / "a.pliant.stamp"
    text = stamp.read_text(encoding="utf-8")
    stamp.write_text(re.sub(r"pliant \d+\.\d+\.\d+", "pliant 0.0.0", text), encoding="utf-8")
    reason("another version of the baker")
    for damaged, words in (("{", "no stamp"), ("[]", "no stamp"), (text.replace('"inputs"', '"x"'), "the stamp is damaged"),
                           (text.replace('"path": "poses/rest.obj"', '"path": 7'), "the stamp is damaged"),
                           ("[" * 100000, "no stamp")):
        stamp.write_text(damaged, encoding="utf-8")
        reason(words)
    stamp.write_text(text, encoding="utf-8")
    asset = moved / "a.pliant"
    blob = bytearray(asset.read_bytes())
    blob[-1] ^= 1
    asset.write_bytes(blob)
    reason("the asset has changed")
    asset.unlink()
    reason("no asset yet")


def test_other_inputs(folder):
    """What else is read counts, too; a file that is gone has changed."""
    poses(folder / "poses")
    manifest = write_json(folder / "m.json",
                          {"defaults": QUICK,
                           "bakes": [{"name": "a", "poses": ["poses/rest.obj", "poses/bent.obj"], "fix": "f.txt"}]})
    # the row in the middle, where the strip is not bent
    (folder / "f.txt").write_text("5\n16\n27\n38\n49\n60\n", encoding="utf-8")
    bakes, result = outcomes(manifest)
    check(bakes["a"]["outcome"] == "baked", f"with fixed vertices {result.stderr}")
    check(outcomes(manifest)[0]["a"]["outcome"] == "up to date", "and again")
    (folder / "f.txt").write_text("5\n16\n27\n38\n49\n", encoding="utf-8")
    check(outcomes(manifest, "--dry-run")[0]["a"]["reason"] == "f.txt has changed", "one vertex less is a change")
    (folder / "f.txt").unlink()
    bakes, result = outcomes(manifest)
    check(bakes["a"]["reason"] == "f.txt has changed" and bakes["a"]["outcome"] == "failed" and result.returncode == 1,
          "a file that is gone, too")


def test_links(folder):
    """What a link leads to may change: of a pose, of a buffer beside it, of the folder that both are in."""
    for version in ("v1", "v2"):
        (folder / version / "buffers").mkdir(parents=True)
        write_gltf(folder / version / "a.gltf", folder / version)
        (folder / version / "mesh data.bin").rename(folder / version / "buffers" / "1.bin")
        data = bytearray((folder / version / "buffers" / "1.bin").read_bytes())
        data[12 * 21 + 12 * 20 + 10] ^= 1 # of the target's last vertex
        (folder / version / "buffers" / "2.bin").write_bytes(data)
        (folder / version / "mesh data.bin").symlink_to("buffers/1.bin")
    (folder / "now").symlink_to("v1")
    manifest = write_json(folder / "m.json", {"defaults": QUICK, "bakes": [{"name": "a", "poses": ["now/a.gltf"]}]})
    bakes, result = outcomes(manifest)
    check(bakes["a"]["outcome"] == "baked", f"by links {result.stderr}")
    check(outcomes(manifest, "--dry-run")[0]["a"]["outcome"] == "up to date", "and again")
    for version in ("v1", "v2"):
        (folder / version / "skin.png").rename(folder / f"{version}.png")
        (folder / version / "skin.png").symlink_to(f"../{version}.png") # which is not read
    outcomes(manifest, "--force")
    check(outcomes(manifest, "--dry-run")[0]["a"]["outcome"] == "up to date", "and stays so")
    (folder / "v1" / "skin.png").unlink()
    (folder / "v1.png").rename(folder / "v1" / "skin.png")
    verdict = outcomes(manifest, "--dry-run")[0]["a"]
    check(verdict.get("reason") == "skin.png has changed", f"a file in the place of a link: {verdict}")
    outcomes(manifest)
    for link, target in ((folder / "v1" / "mesh data.bin", "buffers/2.bin"), (folder / "now", "v2")):
        link.unlink()
        link.symlink_to(target)
        verdict = outcomes(manifest, "--dry-run")[0]["a"]
        check(verdict.get("reason") == "mesh data.bin has changed", f"{link.name} leads elsewhere: {verdict}")
        outcomes(manifest)


def test_links_before_dots(folder):
    """Where a link leads, ".." goes up from."""
    for name, height in (("here", 1), ("there", 2)):
        (folder / name / "inner").mkdir(parents=True)
        write_gltf(folder / name / "a.gltf", folder / name)
        data = bytearray((folder / name / "mesh data.bin").read_bytes())
        data[12 * 21 + 12 * 20 + 11] ^= height # of the target's last vertex
        (folder / name / "mesh data.bin").write_bytes(data)
    (folder / "here" / "link").symlink_to("../there/inner")
    for pose in ("link/../a.gltf", "../there/a.gltf"):
        result = TOOL.run("bake", "a.gltf#rest", pose + "#target=target_1", "-o", "a.pliant", "--depfile", "a.d",
                          *QUICK_OPTIONS, cwd=folder / "here")
        check(result.returncode == 0 and pose in (folder / "here" / "a.d").read_text(encoding="utf-8"),
              f"{pose} is another file than a.gltf {result.stderr}")


def test_roots_behind_links(folder):
    """A tree that is reached through a link is the same tree."""
    poses(folder / "real" / "a")
    write_json(folder / "real" / "a" / "a.json", {**QUICK, "poses": ["rest.obj", "bent.obj"], "output": "../out/a.pliant"})
    write_json(folder / "real" / "m.json", {"bakes": [{"name": "a", "config": "a/a.json"}]})
    (folder / "real" / "out").mkdir()
    (folder / "link").symlink_to("real")
    outcomes(folder / "link" / "m.json")
    for root in ("real", "link"):
        verdict = outcomes(folder / root / "m.json", "--dry-run")[0]["a"]
        check(verdict["outcome"] == "up to date", f"through {root}: {verdict}")


def test_report_of_failed_bake(folder):
    """An asset that cannot be written leaves the old report as it was. Files end one byte short of the asset."""
    report = folder / "a.json"
    words = ["bake", *poses(folder), "-o", folder / "a.pliant", "--report", report, *QUICK_OPTIONS]
    check(TOOL.run(*words).returncode == 0, "a report")
    before = report.read_bytes()
    size = (folder / "a.pliant").stat().st_size - 1
    check(len(before) < size, f"a report of {len(before)} bytes is smaller than the asset")
    with TOOL.start(*words, "--seed", "7",
                    preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))) as limited:
        said = limited.communicate(timeout=300)[1]
    check(limited.returncode == 1 and "error P4005" in said and report.read_bytes() == before,
          f"the old report stays: {said}")


def with_image(folder, uri):
    """The manifest of a bake from g/a.gltf with this image, which is not there."""
    (folder / "g").mkdir()
    write_gltf(folder / "g" / "a.gltf", folder / "g")
    (folder / "g" / "skin.png").rename(folder / "skin.png")
    text = (folder / "g" / "a.gltf").read_text(encoding="utf-8")
    (folder / "g" / "a.gltf").write_text(text.replace("skin.png", uri), encoding="utf-8")
    return write_json(folder / "m.json", {"defaults": QUICK, "bakes": [{"name": "a", "poses": ["g/a.gltf"]}]})


def test_folders_behind_links(folder):
    """What a refused link of a folder leads to has not changed."""
    manifest = with_image(folder, "textures/skin.png")
    (folder / "g" / "textures").symlink_to("..")
    bakes, result = outcomes(manifest)
    check(bakes["a"]["outcome"] == "baked", f"an image behind a link that leads out {result.stderr}")
    check(outcomes(manifest, "--dry-run")[0]["a"]["outcome"] == "up to date", "and again")
    (folder / "g" / "textures").unlink()
    (folder / "g" / "textures").mkdir()
    (folder / "skin.png").rename(folder / "g" / "textures" / "skin.png")
    verdict = outcomes(manifest, "--dry-run")[0]["a"]
    check(verdict.get("reason") == "skin.png has changed", f"a folder in the place of the link: {verdict}")


def test_names_of_other_bytes(folder):
    """A file whose name is not UTF-8 is not taken for unchanged."""
    manifest = with_image(folder, "%ff.png")
    bakes, result = outcomes(manifest)
    check(bakes["a"]["outcome"] == "baked", f"an image that is missing {result.stderr}")
    (folder / "skin.png").rename(pathlib.Path(str(folder / "g") + "/\udcff.png"))
    check(outcomes(manifest, "--dry-run")[0]["a"]["outcome"] != "up to date", "and now is there")


def refused(folder, value, number, text, what):
    path = write_json(folder / "bad.json", value)
    result = TOOL.run("bake-all", path)
    check(result.returncode == 3 and f"error {number}: {path}" in result.stderr and text in result.stderr
          and result.stdout == "", f"{what}: {result.stderr.strip()}")


def test_manifests(folder):
    good = {"name": "a", "poses": ["a.obj", "b.obj"]}
    refused(folder, {}, "P2707", "has no bakes", "no bakes")
    refused(folder, {"bakes": []}, "P2707", "has no bakes", "an empty list")
    refused(folder, {"bakes": [{"poses": ["a.obj"]}]}, "P2707", "neither a name nor an output", "no name")
    refused(folder, {"bakes": [{"name": "a"}]}, "P2707", "bakes[0]: the bake 'a' has no poses", "no poses")
    refused(folder, {"bakes": [good, good]}, "P2708", "bakes[0] and bakes[1] have the name 'a'", "a name twice")
    refused(folder, {"bakes": [good, {**good, "name": "b", "output": "x/../a.pliant"}]}, "P2708", "have the output",
            "an output twice")
    other = {**good, "name": "b"}
    refused(folder, {"bakes": [{**good, "report": "r.json"}, {**other, "report": "./r.json"}]}, "P2708",
            "bakes[0] and bakes[1] have the output", "a report twice")
    refused(folder, {"bakes": [{**good, "depfile": "b.pliant"}, other]}, "P2708", "have the output", "an asset as depfile")
    refused(folder, {"bakes": [{**good, "report": "bad.json"}]}, "P2708", "the manifest and bakes[0] have the output",
            "the manifest itself")
    refused(folder, {"bakes": [{**good, "depfile": "c.obj"}, {**other, "poses": ["a.obj", "c.obj"]}]}, "P2708",
            "c.obj, which is written for bakes[0]", "a pose as depfile")
    for name in ("../up", "/up", "--up", "a\0b", "a\nb", ".", "a\x1b[31m"):
        refused(folder, {"bakes": [{**good, "name": name}]}, "P2707", "is no name", f"the name {name!r}")
    refused(folder, {"bakes": [good], "default": {}}, "P2704", 'did you mean "defaults"', "a key misspelt")
    refused(folder, {"bakes": [{**good, "tolerence": 1}]}, "P2704", 'bakes[0]: there is no key \'tolerence\'',
            "a key of a bake misspelt")
    refused(folder, {"bakes": [good], "defaults": {"output": "a"}}, "P2704", "defaults: there is no key 'output'",
            "an output for all")
    refused(folder, {"bakes": [{**good, "stamp": "a"}]}, "P2704", "there is no key 'stamp'",
            "a stamp, which bake-all sees to")
    refused(folder, {"bakes": [{**good, "dim": 0}]}, "P2706", "1 to 256", "a dimension out of range")
    refused(folder, {"bakes": [good], "defaults": {"dim": "3"}}, "P2705", "defaults: \"dim\" is a string",
            "a string for a number")
    refused(folder, {"bakes": [7]}, "P2705", "bakes[0]: is a number", "a number for a bake")
    manifest, config = folder / "good.json", write_json(folder / "bake.json", {"seed": 3})
    write_gltf(folder / "a.gltf", folder)
    one = {**good, "config": "bake.json", "report": "r.json"}
    write_json(manifest, {"bakes": [one, {"name": "b", "poses": ["a.gltf"]}]})
    for report in (config, folder / "r.json", manifest):
        result = TOOL.run("bake-all", manifest, "--report", report)
        check(result.returncode == 3 and "error P2708" in result.stderr, f"--report {report.name}: {result.stderr}")
    write_json(manifest, {"bakes": [{**good, "depfile": "mesh data.bin"}, {"name": "b", "poses": ["a.gltf"]}]})
    result = TOOL.run("bake-all", manifest)
    check(result.returncode == 3 and "bakes[1] reads" in result.stderr, f"a buffer as depfile: {result.stderr}")
    result = TOOL.run("bake-all", write_json(folder / "good.json", {"bakes": [{**good, "config": "none.json"}]}))
    check(result.returncode == 3 and "error P2001" in result.stderr, "a configuration that is not there")
    result = TOOL.run("bake-all", write_json(folder / "good.json", {"bakes": [good]}), "--only", "b")
    check(result.returncode == 2 and "error P1304" in result.stderr, f"--only of a bake that there is not {result.stderr}")
    judge = support.validator(SOURCE, "bake_manifest.schema.json")
    if judge:
        check(judge({"defaults": QUICK, "bakes": [good, {"config": "b.json"}]}) == [], "the schema takes a good manifest")
        for bad in ({}, {"bakes": []}, {"bakes": [{"poses": ["a", "b"]}]}, {"bakes": [{**good, "dim": 0}]},
                    {"bakes": [{**good, "stamp": "a"}]},
                    {"bakes": [good], "defaults": {"output": "a"}}, {"bakes": [good], "default": {}}):
            check(judge(bad) != [], f"and refuses {bad}")


with tempfile.TemporaryDirectory(prefix="pliant-stamps-") as name:
    tests = (test_stamp, test_what_counts, test_other_inputs, test_links, test_links_before_dots, test_roots_behind_links,
             test_report_of_failed_bake, test_folders_behind_links, test_names_of_other_bytes, test_manifests)
    for number, test in enumerate(tests):
        place = pathlib.Path(name) / str(number)
        place.mkdir()
        test(place)
support.finish()
