#!/usr/bin/env python3
"""Makes the moving pictures of README.md: linear beside elastic, twisted_bar.webp and creature.webp.

    python3 samples/pictures/make_moving_pictures.py [--build FOLDER] [--out FOLDER]

FOLDER of --build holds the tools (default: build/release, where samples/demo.sh builds them); --out is where the pictures go
(default: samples/pictures). Poses, assets and frames stay in build/demo; assets that are there already are used again.
Takes some minutes. Needs Pillow with WebP (python3-pil), xvfb-run and DejaVu Sans (the packages of samples/demo.sh).
Exit code: 0 done, 1 a step failed, 2 something is missing.
"""
import argparse
import math
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
TOOLS = {"pliant": "baker/pliant", "creature": "samples/creature/creature", "player": "samples/player/pliant-player"}
KINDS = {"linear": (84, 110, 146), "elastic": (204, 90, 56)}  # in the colours of the player
CREATURE_POSES = ["rest", "reach", "curl", "leap", "twist"]
FRAMES_PER_SECOND, FRAMES_HELD = 25, 5  # a loop goes there and back, and rests a moment at both ends
QUALITY = 88  # of WebP; at 60 traces of earlier frames stay
GAP = 4  # columns of white between the halves
BYTES_ALLOWED = 3_000_000  # both pictures together


def stop(code, reason, hint):
    print(f"{Path(sys.argv[0]).name}: error: {reason}\nhint: {hint}", file=sys.stderr)
    sys.exit(code)


def run(*command):
    done = subprocess.run([str(word) for word in command], stdout=subprocess.DEVNULL, check=False)
    if done.returncode != 0:
        stop(1, f"{Path(str(command[0])).name} failed with exit code {done.returncode}", "its message is above")


def find_tools(build):
    tools = {name: build / path for name, path in TOOLS.items()}
    for path in tools.values():
        if not path.is_file():
            stop(2, f"{path} is not there", "bash samples/demo.sh --headless builds it; --build names another build folder")
    if not shutil.which("xvfb-run"):
        stop(2, "xvfb-run is not installed", "bash samples/install_packages.sh player")
    return tools


def load_pillow(font_size=20):
    try:
        from PIL import Image, ImageDraw, ImageFont
        font = ImageFont.truetype("DejaVuSans-Bold.ttf", font_size)
    except ImportError:
        stop(2, "Pillow is not installed for this Python", "apt-get install python3-pil, then run /usr/bin/python3")
    except OSError:
        stop(2, "the font DejaVu Sans is not installed", "apt-get install fonts-dejavu-core")
    return Image, ImageDraw, font


def require_animated_webp():
    from PIL import features
    if not features.check("webp_anim"):
        stop(2, "this Pillow writes no animated WebP", "apt-get install python3-pil, then run /usr/bin/python3")


def bar_surface(cells, layers, length):
    """Vertices and outward quadrilaterals of a bar of cross-section 1 x 1 along z; its base is at z = 0."""
    numbers, faces = {}, []

    def vertex(i, j, k):
        return numbers.setdefault((i, j, k), len(numbers))

    n, around = cells, range(cells)
    ring = [(i, 0) for i in around] + [(n, i) for i in around] + [(n - i, n) for i in around] + [(0, n - i) for i in around]
    for k in range(layers):
        for a, b in zip(ring, ring[1:] + ring[:1]):
            faces.append([vertex(*a, k), vertex(*b, k), vertex(*b, k + 1), vertex(*a, k + 1)])
    for i in around:
        for j in around:
            square = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)]
            faces.append([vertex(*corner, 0) for corner in reversed(square)])
            faces.append([vertex(*corner, layers) for corner in square])
    return [(i / n - 0.5, j / n - 0.5, k * length / layers) for i, j, k in numbers], faces


def twisted(vertices, length, degrees):
    """The vertex at height z turned about the z axis by degrees * z / length."""
    for x, y, z in vertices:
        turn = math.radians(degrees) * z / length
        yield math.cos(turn) * x - math.sin(turn) * y, math.sin(turn) * x + math.cos(turn) * y, z


def bake_bar(tools, work):
    """Two poses of a bar of 1962 vertices, twisted by 150 degrees each way; the base is fixed."""
    asset, length = work / "twisted_bar.pliant", 4.4
    if is_baked(asset, tools):
        return asset
    vertices, faces = bar_surface(cells=10, layers=44, length=length)
    poses = []
    for name, degrees in (("left", -150), ("right", 150)):
        lines = ["v %.7g %.7g %.7g" % point for point in twisted(vertices, length, degrees)]
        lines += ["f " + " ".join(str(v + 1) for v in face) for face in faces]
        poses.append(work / f"bar_{name}.obj")
        poses[-1].write_text("\n".join(lines) + "\n")
    fixed = work / "bar_fixed.txt"
    fixed.write_text("\n".join(str(v) for v, point in enumerate(vertices) if point[2] == 0) + "\n")
    return bake(tools, poses, asset, "--fix", fixed)


def bake_creature(tools, work, name="creature", *options):
    """The asset of samples/demo.sh, or with options of `pliant bake` another one of the same poses."""
    asset, folder = work / f"{name}.pliant", work / "poses"
    if is_baked(asset, tools):
        return asset
    folder.mkdir(exist_ok=True)
    run(tools["creature"], "-o", folder)
    return bake(tools, [folder / f"creature_{pose}.ply" for pose in CREATURE_POSES], asset, *options)


def is_baked(asset, tools):
    return asset.exists() and asset.stat().st_mtime >= tools["pliant"].stat().st_mtime


def bake(tools, poses, asset, *options):
    print(f"baking {asset.name}, some minutes", flush=True)
    run(tools["pliant"], "bake", *poses, *options, "-o", asset)
    return asset


def eased_path(stops, count):
    """Weights of `count` frames from the first stop over the others to the last, slow at each."""
    path, last = [], len(stops) - 1
    for frame in range(count):
        place = last * frame / (count - 1)
        i = min(int(place), last - 1)
        eased = 0.5 - 0.5 * math.cos(math.pi * (place - i))
        path.append([a + (b - a) * eased for a, b in zip(stops[i], stops[i + 1])])
    return path


def draw_frames(tools, asset, path, size, view):
    """Pictures of both kinds of blend, from one camera: {kind: [PNG file]}."""
    return {kind: draw_sequence(tools, asset, path, size, view, kind, *option)
            for kind, option in (("linear", ["--linear"]), ("elastic", []))}


def draw_sequence(tools, asset, path, size, view, kind, *options):
    """One picture for each weight of the path, drawn by the player: [PNG file], in a folder beside the asset."""
    weights = asset.with_suffix(".csv")
    weights.write_text("".join(",".join(f"{w:.5f}" for w in line) + "\n" for line in path))
    folder = asset.with_name(f"{asset.stem}_{kind}")
    folder.mkdir(exist_ok=True)
    run("xvfb-run", "-a", "-s", "-screen 0 1280x1024x24", tools["player"], asset, "--up", "z", f"--view={view}",
        "--size", size, "--path", weights, "--sequence", folder / "%03d.png", *options)
    return [folder / f"{i:03d}.png" for i in range(len(path))]


def join(pillow, pair):
    """One frame: the pictures of both kinds side by side, each with its name."""
    image_module, draw_module, font = pillow
    halves = [image_module.open(path).convert("RGB") for path in pair]
    width, height = halves[0].size
    frame = image_module.new("RGB", (2 * width + GAP, height), "white")
    for i, (kind, colour) in enumerate(KINDS.items()):
        frame.paste(halves[i], (i * (width + GAP), 0))
        draw_module.Draw(frame).text((i * (width + GAP) + 18, 14), kind, font=font, fill=colour)
    return frame


def write_loop(pillow, frames, path):
    there = [join(pillow, pair) for pair in zip(*(frames[kind] for kind in KINDS))]
    loop = there + there[-2:0:-1]
    times = [1000 // FRAMES_PER_SECOND] * len(loop)
    times[0] = times[len(there) - 1] = FRAMES_HELD * times[0]
    loop[0].save(path, save_all=True, append_images=loop[1:], duration=times, loop=0, quality=QUALITY, method=4)
    print(f"{path}: {len(loop)} frames, {sum(times) / 1000:.1f} s, {path.stat().st_size} bytes", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=Path, default=ROOT / "build/release")
    parser.add_argument("--out", type=Path, default=ROOT / "samples/pictures")
    options = parser.parse_args()
    pillow, tools, work = load_pillow(), find_tools(options.build.resolve()), ROOT / "build/demo"
    require_animated_webp()
    for folder in (work, options.out):
        folder.mkdir(parents=True, exist_ok=True)
    pictures = [
        (bake_bar, eased_path([(1, 0), (0, 1)], 46), "420x460", "30,16"),
        (bake_creature, eased_path([(0, 1, 0, 0, 0), (0, 0, 1, 0, 0), (0, 0, 0, 0, 1)], 59), "440x290", "30,12"),
    ]
    written = []
    for bake_asset, path, size, view in pictures:
        asset = bake_asset(tools, work)
        written.append(options.out / f"{asset.stem}.webp")
        write_loop(pillow, draw_frames(tools, asset, path, size, view), written[-1])
    if sum(path.stat().st_size for path in written) > BYTES_ALLOWED:
        stop(1, f"the pictures are larger than {BYTES_ALLOWED} bytes together", "draw fewer or smaller frames")


if __name__ == "__main__":
    main()
