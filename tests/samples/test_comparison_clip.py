"""The script that makes the comparison clip, on tiny assets in place of the creature's: test_comparison_clip.py BUILD.

Exit code 77: this machine cannot draw (the reason is printed). Without ffmpeg the WebM alone is left out.
"""
import math
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from PIL import Image

ROOT = Path(__file__).resolve().parents[2]
PICTURES = ROOT / "samples" / "pictures"
sys.path.insert(0, str(PICTURES))
import control_polygon  # noqa: E402

STEPS, WIDTH, HEIGHT, GAP = 2, 80, 64, 4
FRAMES = control_polygon.POSES * STEPS


def skip(reason):
    print("skipped:", reason)
    sys.exit(77)


def make_asset(path, *options):
    subprocess.run([sys.executable, ROOT / "tests/runtime/tiny_asset.py", path, "--mesh", "tube", "--poses", "5", *options],
                   check=True, stdout=subprocess.DEVNULL)


def make_clip(build, folder):
    """The script takes assets that are newer than the tool as its own. Those of both methods must differ."""
    make_asset(folder / "creature.pliant", "--dim", "6", "--material", "neo-hookean")
    make_asset(folder / "creature_algorithm1_6.pliant", "--dim", "4", "--material", "edge", "--seed", "2")
    command = [sys.executable, "-B", PICTURES / "make_comparison_clip.py", "--build", build, "-o", folder,
               "--steps", str(STEPS), "--size", f"{WIDTH}x{HEIGHT}"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=240)
    if "P5921" in done.stderr or "xvfb-run is not installed" in done.stderr or "DejaVu Sans is not" in done.stderr:
        skip(done.stderr)
    return done


def panels_of(gif):
    """[frame][panel]: pixels."""
    frames = []
    for i in range(gif.n_frames):
        gif.seek(i)
        pixels = np.asarray(gif.convert("RGB")).astype(float)
        frames.append([pixels[:HEIGHT, left:left + WIDTH] for left in range(0, 4 * (WIDTH + GAP), WIDTH + GAP)])
    return frames


def outline(panel, sign):
    """The pixels of a warm (1: elastic) or cool (-1: linear) character, row by row from the first to the last."""
    mask = sign * (panel[..., 0] - panel[..., 2]) > 20 if sign > 0 else \
        (panel[..., 2] - panel[..., 0] > 20) & (panel.mean(axis=2) < 175)
    return np.maximum.accumulate(mask, axis=1) & np.maximum.accumulate(mask[:, ::-1], axis=1)[:, ::-1]


def overlap(a, b):
    return (a & b).sum() / (a | b).sum()


def check_path():
    path = control_polygon.closed_path(STEPS)
    weights = np.array([control_polygon.weights(point) for point in path])
    assert np.abs(weights @ np.array(control_polygon.CORNERS) - path).max() < 1e-6, "the weights do not give the point"
    for pose, frame in enumerate(control_polygon.frames_at_poses(STEPS)):
        assert weights[frame][pose] > 1 - 1e-6, f"pose {pose} is not reached"
    assert weights.min(axis=1).max() > 0.19, "the path does not visit the middle"
    assert math.dist(control_polygon.point_at(1), path[0]) < 1e-9, "the path is not closed"


def check_gif(path):
    gif = Image.open(path)
    assert gif.n_frames == FRAMES and gif.info["loop"] == 0, f"{gif.n_frames} frames"
    frames = panels_of(gif)
    between = frames[STEPS // 2]
    for a in range(4):
        for b in range(a):
            assert np.abs(between[a] - between[b]).mean() > 0.3, f"panels {a} and {b} show the same"
    steps = [sum(np.abs(a - b).mean() for a, b in zip(frames[i], frames[i - 1])) for i in range(FRAMES)]
    assert 0 < steps[0] <= max(steps[1:]), f"the first frame does not follow the last one: {steps}"
    same = overlap(outline(frames[0][1], -1), outline(frames[0][3], 1))
    other = min(overlap(outline(frame[1], -1), outline(frame[3], 1)) for frame in frames)
    assert same > max(0.7, other + 0.15), f"linear and Pliant overlap by {same:.2f} at a pose, and by {other:.2f} at least"


def check_webm(path):
    command = ["ffprobe", "-v", "error", "-count_frames", "-show_entries", "stream=codec_name,nb_read_frames",
               "-of", "csv=p=0", path]
    shown = subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()
    assert shown == f"vp9,{FRAMES}", shown


def main():
    check_path()
    with tempfile.TemporaryDirectory(prefix="pliant_clip_") as temporary:
        folder = Path(temporary)
        done = make_clip(Path(sys.argv[1]), folder)
        has_ffmpeg = shutil.which("ffmpeg") is not None
        assert done.returncode == (0 if has_ffmpeg else 1), f"exit code {done.returncode}: {done.stderr}"
        check_gif(folder / "comparison.gif")
        if has_ffmpeg:
            check_webm(folder / "comparison.webm")
        else:
            assert "apt-get install ffmpeg" in done.stderr, done.stderr
            print("skipped the WebM: ffmpeg is not installed")
        assert not list(folder.glob("unfinished_*")), "something unfinished is left behind"


main()
