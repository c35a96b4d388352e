"""page.py BROWSER FOLDER ENVIRONMENT TOOL PLAYER ASSETS: the page of samples/web with two of the small assets, driven by
page.mjs in a browser; PLAYER may be empty; FOLDER keeps node's packages, the page and a picture of it. Exit code 77, and the
reason, where the browser is not installed or packages cannot be fetched."""
import json
import os
import pathlib
import shutil
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path[:0] = [str(ROOT / part) for part in ("tests/baker/output/engines", "tests/paper")]
import support  # noqa: E402: installs node's packages
import shapes  # noqa: E402: reads PLY

BROWSERS = {"chromium": [], "firefox-esr": ["xvfb-run", "-a", "-s", "-screen 0 1280x1000x24"]}
ASSETS = {"averages": ("tube_factored.pliant", [0.25, 0.5, 0.25]), "layers": ("layers_tube.pliant", [0.75, 0, 0.5])}


def blends(tool, assets, folder):
    """What the C library makes of both assets, as the PLY files of `pliant blend` have it."""
    out = {}
    for name, (file, weights) in ASSETS.items():
        ply = folder / f"{name}.ply"
        text = ",".join(map(str, weights))
        subprocess.run([tool, "blend", assets / file, "--weights", text, "-o", ply], check=True, capture_output=True)
        points, _ = shapes.read_ply(ply)
        out[name] = {"weights": weights, "positions": points.ravel().tolist()}
    return out


def players_picture(player, asset, weights, picture):
    text = ",".join(map(str, weights))
    subprocess.run([player, asset, "--plain", "--view", "0,0", "--weights", text, "--size", "640x480",
                    "--screenshot", picture], check=True, capture_output=True)
    return str(picture)


def drive(browser, folder, script, *arguments, timeout=250):
    """Runs one of the scripts for node beside this file on the page in `folder`."""
    modules = support.node_modules(folder, HERE)
    for name in (script, "tab.mjs"):
        shutil.copy(HERE / name, modules)
    return subprocess.run([*BROWSERS[browser], "node", modules / script, shutil.which(browser), folder / "page", *arguments],
                          timeout=timeout, env={**os.environ, "HOME": str(folder)}).returncode


def main():
    browser, player = sys.argv[1], sys.argv[5]
    folder, environment, tool, assets = map(pathlib.Path, (*sys.argv[2:5], sys.argv[6]))
    missing = [name for name in (browser, *BROWSERS[browser][:1]) if not shutil.which(name)]
    if missing:
        support.skip(f"{' and '.join(missing)} not installed (groups player and engines of samples/install_packages.sh)")
    if not (environment / "is_complete").exists():
        support.skip("zig could not be fetched")
    folder.mkdir(parents=True, exist_ok=True)
    page = folder / "page"
    python = environment / "bin/python"
    shutil.rmtree(page, ignore_errors=True)
    subprocess.run([python, "-B", ROOT / "samples/web/build.py", page, "--package", environment / "package"], check=True)
    for name, (file, _) in ASSETS.items():
        shutil.copy(assets / file, page / f"{name}.pliant")
    subprocess.run([tool, "export", page / "averages.pliant", "--embed", "-o", page / "embedded.glb"], check=True,
                   capture_output=True)
    expected = blends(tool, assets, folder)
    if player:
        expected["player"] = players_picture(player, page / "averages.pliant", ASSETS["averages"][1],
                                             folder / "player.png")
    (folder / "expected.json").write_text(json.dumps(expected))
    (folder / "bad.pliant").write_bytes(b"PLNT" + bytes(1000))
    return drive(browser, folder, "page.mjs", folder / "expected.json", folder / "bad.pliant", folder / f"{browser}.png")


if __name__ == "__main__":
    sys.exit(main())
