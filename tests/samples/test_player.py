"""Runs the player as a user would: test_player.py CASE PLAYER. Exit code 77: this machine cannot do it (the reason is printed).

Assets come from tests/runtime/tiny_asset.py: small, but solved by the real runtime.
"""
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from PIL import Image

ROOT = Path(__file__).resolve().parents[2]
PLAYER = sys.argv[2]
# Graphics drivers leak a little, which sanitizer builds would report as ours. What does not draw is still watched.
if sys.argv[1] not in ("help", "usage", "bad_asset", "benchmark"):
    os.environ["ASAN_OPTIONS"] = "detect_leaks=0"


def skip(reason):
    print("skipped:", reason)
    sys.exit(77)


def make_asset(folder, poses=3):
    path = folder / "tube.pliant"
    subprocess.run([sys.executable, ROOT / "tests/runtime/tiny_asset.py", path, "--mesh", "tube", "--poses", str(poses),
                    "--dim", "6", "--material", "neo-hookean"], check=True, stdout=subprocess.DEVNULL)
    return path


def run(*arguments, expected=0):
    """Runs the player; returns standard output and error."""
    result = subprocess.run([PLAYER, *map(str, arguments)], capture_output=True, text=True, timeout=240)
    if result.returncode == 1 and "P5921" in result.stderr and expected != 1:
        skip("no OpenGL 3.3 here: " + result.stderr)
    assert result.returncode == expected, f"exit code {result.returncode}, not {expected}: {result.stderr}"
    return result.stdout, result.stderr


def refused(*arguments, code, number):
    """Runs the player on something wrong: exit code, number, one line for the error and one for the remedy."""
    _, err = run(*arguments, expected=code)
    lines = err.splitlines()
    assert len(lines) == 2, err
    assert lines[0].startswith(f"pliant-player: error P{number}: ") and lines[1].startswith("hint: "), err
    return lines[0]


def picture(asset, folder, *arguments, size="320x240"):
    path = folder / "picture.png"
    run(asset, "--screenshot", path, "--size", size, *arguments)
    return np.asarray(Image.open(path).convert("RGB")).astype(float)


def warm(image):
    """The pixels of the elastic character: red well above blue."""
    return image[..., 0] - image[..., 2] > 25


def cool(image):
    """The pixels of the linear character: blue well above red, unlike the pale backdrop and the grey shadow."""
    return (image[..., 2] - image[..., 0] > 20) & (image.mean(axis=2) < 175)


def case_help(folder):
    out, _ = run("--help")
    for word in ("--screenshot", "--sheet", "--weights", "--frames", "--up", "Exit code"):
        assert word in out, f"--help does not explain {word}"
    out, _ = run("--version")
    assert re.fullmatch(r"pliant-player \d+\.\d+\.\d+\n", out), out


def case_usage(folder):
    asset = make_asset(folder)
    out = folder / "x.png"
    refused(code=2, number=5901)
    refused(asset, "--no-such-option", code=2, number=5901)
    refused(asset, "--size", "0x10", code=2, number=5901)
    refused(asset, "--size", "1e9x10", code=2, number=5901)
    refused(asset, "--view", "1", code=2, number=5901)
    refused(asset, "--up", "w", code=2, number=5901)
    refused(asset, "--frames", "0", code=2, number=5901)
    refused(asset, "--screenshot", out, "--frames", "3", code=2, number=5901)
    for weights in ("1,x,0", "-1,1,1", "nan,1,1", "0,0,0", "1,,1", "1,1,1,"):
        refused(asset, "--screenshot", out, f"--weights={weights}", code=2, number=5902)
    line = refused(asset, "--screenshot", out, "--weights", "1,1", code=2, number=5902)
    assert "2 weights for 3 poses" in line, line
    assert not out.exists()


def case_bad_asset(folder):
    good = make_asset(folder).read_bytes()
    bad = folder / "bad.pliant"
    refused(folder / "missing.pliant", "--frames", "1", code=3, number=5911)
    refused(folder, "--frames", "1", code=3, number=5911)
    flipped = bytearray(good)
    flipped[len(good) // 2] ^= 1  # only the checksums notice
    for content in (b"", b"PLIANT", bytes(4096), good[:-1], good[:100], bytes(flipped)):
        bad.write_bytes(content)
        line = refused(bad, "--frames", "1", code=3, number=5912)
        assert str(bad) in line, line


def case_screenshot(folder):
    asset = make_asset(folder)
    image = picture(asset, folder)
    assert image.shape == (240, 320, 3), image.shape
    assert image.std() > 5, "the picture is constant"
    assert 0.02 < warm(image).mean() < 0.8, f"the character covers {warm(image).mean():.3f} of the picture"
    assert image[:4].min() > 150, "the backdrop is not pale"
    rows, columns = np.nonzero(warm(image))
    assert rows.min() > 2 and rows.max() < 237 and columns.min() > 2 and columns.max() < 317, "the character leaves the picture"
    turned = picture(asset, folder, "--view=-60,40")
    assert np.abs(turned - image).mean() > 1, "--view changes nothing"


def case_corner(folder):
    """In a corner both blends are the pose itself: same outline, other colour. Between corners the shape is another one."""
    asset = make_asset(folder)
    elastic = warm(picture(asset, folder, "--weights", "0,1,0"))
    linear = cool(picture(asset, folder, "--weights", "0,1,0", "--linear"))
    other = warm(picture(asset, folder, "--weights", "0,0,1"))

    def outline(mask):
        """Row by row from the first pixel to the last: highlights inside have no colour."""
        return np.maximum.accumulate(mask, axis=1) & np.maximum.accumulate(mask[:, ::-1], axis=1)[:, ::-1]

    def overlap(a, b):
        a, b = outline(a), outline(b)
        return (a & b).sum() / (a | b).sum()

    assert overlap(elastic, linear) > 0.9, f"the corner's outlines overlap by {overlap(elastic, linear):.3f}"
    assert overlap(elastic, other) < 0.9, f"two poses overlap by {overlap(elastic, other):.3f}"


def case_panels(folder):
    asset = make_asset(folder)
    without = picture(asset, folder, "--no-hud", size="960x600")
    panels = picture(asset, folder, "--hud", size="960x600")
    both = picture(asset, folder, "--both", size="960x600")
    ink = [((image.max(axis=2) < 120) & (image[..., 0] < image[..., 2])).sum() for image in (without, panels)]
    assert ink[1] > ink[0] + 300, f"--hud writes no text: {ink} dark pixels without and with"
    half = both.shape[1] // 2
    assert cool(both[:, :half]).any() and warm(both[:, half:]).any(), "--both: linear left, elastic right"
    assert not warm(both[:, :half]).any(), "--both: the elastic character reaches into the left half"


def case_sheet(folder):
    asset = make_asset(folder)
    path = folder / "sheet.png"
    run(asset, "--sheet", path, "--size", "120x100")
    image = np.asarray(Image.open(path).convert("RGB")).astype(float)
    assert image.shape[0] > 200 and image.shape[1] > 400, image.shape
    assert warm(image).mean() > 0.01 and cool(image).mean() > 0.003, "a kind of blend is missing on the sheet"


def case_whole_or_nothing(folder):
    asset = make_asset(folder)
    refused(asset, "--screenshot", folder / "missing" / "x.png", "--size", "64x64", code=1, number=5931)
    place = folder / "place"
    place.mkdir()
    refused(asset, "--screenshot", place, "--size", "64x64", code=1, number=5931)
    pipe = folder / "pipe"
    os.mkfifo(pipe)
    refused(asset, "--screenshot", pipe, "--size", "64x64", code=1, number=5931)
    assert pipe.is_fifo(), "the pipe was replaced by a file"
    assert sorted(p.name for p in folder.iterdir()) == ["pipe", "place", "tube.pliant"], "something was left behind"


def case_benchmark(folder):
    asset = make_asset(folder)
    out, _ = run(asset, "--frames", "50", "--json")
    report = json.loads(out)
    assert report["frames"] == 50 and report["poses"] == 3 and report["dimension"] == 6 and report["blend"] == "elastic", out
    for name in ("solve_us", "reconstruct_us", "normals_us"):
        assert 0 < report[name]["median"] <= report[name]["p95"], out
    assert report["evaluations"]["median"] >= 1, out
    linear, _ = run(asset, "--frames", "50", "--json", "--linear")
    assert json.loads(linear)["evaluations"]["p95"] == 0, linear
    text, _ = run(asset, "--frames", "3")
    assert "median" in text and "reconstruct" in text, text


def case_window(folder):
    if not shutil.which("xvfb-run"):
        skip("xvfb-run is not installed (packages xvfb xauth)")
    asset = make_asset(folder, poses=5)
    command = ["xvfb-run", "-a", "-s", "-screen 0 1280x1024x24", PLAYER, asset, "--size", "480x320", "--exit-after", "1"]
    result = subprocess.run(command, capture_output=True, text=True, timeout=240)
    assert result.returncode == 0, result.stderr


def case_error_numbers(folder):
    """The table in the player's README lists the numbers of error.h and main.cpp, no more and no fewer."""
    player = ROOT / "samples" / "player"
    enumeration = re.search(r"enum class ErrorNumber[^}]*}", (player / "error.h").read_text()).group()
    used = set(re.findall(r"= (\d{4})", enumeration)) | set(re.findall(r"error P(\d{4})", (player / "main.cpp").read_text()))
    listed = set(re.findall(r"^\| P(\d{4}) \|", (player / "README.md").read_text(), re.MULTILINE))
    assert used == listed, f"only in the code: {used - listed}, only in the table: {listed - used}"


with tempfile.TemporaryDirectory(prefix="pliant_player_") as temporary:
    globals()["case_" + sys.argv[1]](Path(temporary))
