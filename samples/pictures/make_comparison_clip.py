#!/usr/bin/env python3
"""Makes a clip that compares ways to blend the example character: comparison.gif and comparison.webm.

    /usr/bin/python3 samples/pictures/make_comparison_clip.py --build build/release -o build/clip

Four panels, side by side, show the same weights in every frame:

    control polygon      the five poses and a point on a closed path; its Wachspress coordinates are the weights
    linear               the linear blend of the aligned poses
    Algorithm 1 (2015)   the method of the paper: pliant bake --subspace krylov --energy ghost --dim D
    Pliant               pliant bake without options; D above is the dimension that it chooses

The first call bakes both assets (some two minutes on two cores). Each call draws all frames (some five minutes). Assets and
frames stay in the folder of the clip; assets that are newer than the tool are used again. Before the first call, run
bash samples/demo.sh --headless: it builds the tools and installs what they need. The script also needs python3-pil,
python3-numpy and ffmpeg; without ffmpeg it writes the GIF alone.
Exit code: 0 done, 1 a step failed or the WebM is missing, 2 something else is missing.
"""
import argparse
import json
import os
import shutil
import subprocess
import tempfile
from pathlib import Path

import control_polygon
import make_moving_pictures as moving

try:
    import gif_writer
except ImportError as missing:
    moving.stop(2, f"this Python lacks a package: {missing}",
                "apt-get install python3-pil python3-numpy, then run /usr/bin/python3")

MILLISECONDS = 60  # a frame; GIF counts in hundredths of a second
VIEW = "60,14"  # yaw and pitch from which no blend of the path leaves its panel
GAP, LABEL_HEIGHT = 4, 34
GIF_WIDTH = 830  # what a page of GitHub shows without scaling
GIF_COLOURS = 71
WEBM_QUALITY = 24  # of VP9: 0 best, 63 worst


def dimension(tools, asset):
    shown = subprocess.run([tools["pliant"], "info", "--json", asset], capture_output=True, text=True, check=False)
    if shown.returncode != 0:
        moving.stop(1, f"{asset} cannot be read: {shown.stderr.strip()}", "delete the file; the next call bakes it again")
    return json.loads(shown.stdout)["dimension"]


def bake_assets(tools, work):
    """Our asset, and that of Algorithm 1 with as many dimensions."""
    ours = moving.bake_creature(tools, work)
    d = dimension(tools, ours)
    options = ["--subspace", "krylov", "--energy", "ghost", "--dim", d]
    return ours, moving.bake_creature(tools, work, f"creature_algorithm1_{d}", *options)


def draw_panels(tools, pillow, work, steps, size):
    """[(label, colour of the label, frames)], from left to right."""
    path = control_polygon.closed_path(steps)
    ours, paper = bake_assets(tools, work)

    def blends(asset, kind, *options):
        print(f"drawing {len(path)} frames: {asset.name}, {kind}", flush=True)
        weights = [control_polygon.weights(point) for point in path]
        files = moving.draw_sequence(tools, asset, weights, "x".join(map(str, size)), VIEW, kind, *options)
        return [pillow[0].open(file).convert("RGB") for file in files]

    linear, elastic, paper_frames = blends(ours, "linear", "--linear"), blends(ours, "elastic"), blends(paper, "elastic")
    poses = [elastic[i] for i in control_polygon.frames_at_poses(steps)]
    panel = control_polygon.Panel(pillow, size, path, poses)
    return [
        ("control polygon", control_polygon.INK, [panel.draw(i) for i in range(len(path))]),
        ("linear", moving.KINDS["linear"], linear),
        (f"Algorithm 1 (2015), d = {dimension(tools, paper)}", moving.KINDS["elastic"], paper_frames),
        (f"Pliant, d = {dimension(tools, ours)}", moving.KINDS["elastic"], elastic),
    ]


def join(pillow, panels, size):
    """Frames with all panels, each above its label. Width and height are even, as VP9 needs."""
    image_module, draw_module, font = pillow
    step = size[0] + GAP
    page = image_module.new("RGB", (4 * step - GAP + size[0] % 2, size[1] + LABEL_HEIGHT + size[1] % 2), "white")
    for i, (label, colour, _) in enumerate(panels):
        place = i * step + size[0] / 2, size[1] + LABEL_HEIGHT / 2
        draw_module.Draw(page).text(place, label, font=font, fill=colour, anchor="mm")
    frames = []
    for pictures in zip(*(panel[2] for panel in panels)):
        frames.append(page.copy())
        for i, picture in enumerate(pictures):
            frames[-1].paste(picture, (i * step, 0))
    return frames


def write_gif(pillow, frames, path):
    width = min(GIF_WIDTH, frames[0].width)
    size = width, round(frames[0].height * width / frames[0].width)
    small = [frame.resize(size, pillow[0].LANCZOS) for frame in frames]
    gif_writer.write_gif(small, path, MILLISECONDS, GIF_COLOURS, fixed=[(255, 255, 255), control_polygon.BACKGROUND])


def write_webm(frames, path):
    size = f"{frames[0].width}x{frames[0].height}"
    source = ["-f", "rawvideo", "-pix_fmt", "rgb24", "-s", size, "-r", f"1000/{MILLISECONDS}", "-i", "-"]
    target = ["-c:v", "libvpx-vp9", "-pix_fmt", "yuv420p", "-crf", str(WEBM_QUALITY), "-b:v", "0", str(path)]
    command = ["ffmpeg", "-v", "error", "-y", *source, *target]
    done = subprocess.run(command, input=b"".join(frame.tobytes() for frame in frames), check=False)
    if done.returncode != 0:
        moving.stop(1, f"ffmpeg failed with exit code {done.returncode}", "its message is above; the GIF is written")


def publish(write, frames, path):
    """The file appears whole or not at all."""
    print(f"writing {path}", flush=True)
    with tempfile.TemporaryDirectory(dir=path.parent, prefix="unfinished_") as folder:
        unfinished = Path(folder, path.name)
        write(frames, unfinished)
        os.replace(unfinished, path)
    seconds = len(frames) * MILLISECONDS / 1000
    print(f"{path}: {len(frames)} frames, {seconds:.1f} s, {path.stat().st_size} bytes", flush=True)


def read_options():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=Path, default=moving.ROOT / "build/release", metavar="FOLDER",
                        help="where the tools were built (default: build/release)")
    parser.add_argument("-o", "--output", type=Path, default=moving.ROOT / "build/clip", metavar="FOLDER",
                        help="where clip, assets and frames go (default: build/clip)")
    parser.add_argument("--steps", type=int, default=25, metavar="N",
                        help="frames from one pose to the next, at 60 ms each; the path has five such legs (default: 25)")
    parser.add_argument("--size", default="300x230", metavar="WxH", help="pixels of a panel (default: 300x230)")
    options = parser.parse_args()
    try:
        options.size = tuple(int(side) for side in options.size.split("x"))
        if len(options.size) != 2 or min(options.size) < 32 or options.steps < 1:
            raise ValueError
    except ValueError:
        parser.error("--size takes width and height, such as 300x230, 32 or more each; --steps 1 or more")
    return options


def main():
    options = read_options()
    pillow, tools = moving.load_pillow(15), moving.find_tools(options.build.resolve())
    options.output.mkdir(parents=True, exist_ok=True)
    frames = join(pillow, draw_panels(tools, pillow, options.output, options.steps, options.size), options.size)
    publish(lambda *to: write_gif(pillow, *to), frames, options.output / "comparison.gif")
    if not shutil.which("ffmpeg"):
        moving.stop(1, "no comparison.webm: ffmpeg is not installed", "apt-get install ffmpeg, then run this again")
    publish(write_webm, frames, options.output / "comparison.webm")


if __name__ == "__main__":
    main()
