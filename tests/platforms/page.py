"""page.py BROWSER FOLDER ENVIRONMENT TOOL ASSETS: the page of samples/web with two of the small assets, driven by page.mjs
in a browser; FOLDER keeps node's packages, the page and a picture of it. Exit code 77, and the reason, where the browser is
not installed or packages cannot be fetched."""
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


def main():
    browser, folder, environment, tool, assets = sys.argv[1], *map(pathlib.Path, sys.argv[2:])
    missing = [name for name in (browser, *BROWSERS[browser][:1]) if not shutil.which(name)]
    if missing:
        support.skip(f"{' and '.join(missing)} not installed (groups player and engines of samples/install_packages.sh)")
    if not (environment / "is_complete").exists():
        support.skip("zig could not be fetched")
    folder.mkdir(parents=True, exist_ok=True)
    modules = support.node_modules(folder, HERE)
    page = folder / "page"
    python = environment / "bin/python"
    shutil.rmtree(page, ignore_errors=True)
    subprocess.run([python, "-B", ROOT / "samples/web/build.py", page, environment / "package"], check=True)
    for name, (file, _) in ASSETS.items():
        shutil.copy(assets / file, page / f"{name}.pliant")
    subprocess.run([tool, "export", page / "averages.pliant", "--embed", "-o", page / "embedded.glb"], check=True,
                   capture_output=True)
    (folder / "expected.json").write_text(json.dumps(blends(tool, assets, folder)))
    (folder / "bad.pliant").write_bytes(b"PLNT" + bytes(1000))
    shutil.copy(HERE / "page.mjs", modules)
    done = subprocess.run([*BROWSERS[browser], "node", modules / "page.mjs", shutil.which(browser), page,
                           folder / "expected.json", folder / "bad.pliant", folder / f"{browser}.png"],
                          timeout=250, env={**os.environ, "HOME": str(folder)})
    return done.returncode


if __name__ == "__main__":
    sys.exit(main())
