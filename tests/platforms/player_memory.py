"""player_memory.py PLAYER COMPILER USE ASSETS BAD [FRAMES [LEAK]]: the memory of the player does not grow while it is
used. FRAMES (default: an hour at 60 a second) are simulated in a window under Xvfb by USE, which is use_player.c: the
mouse drags in the scene, the polygon and the sliders, keys, a picture and a short recording at times, and every 300
frames another file is dropped: some of ASSETS, and the file BAD. The clock is simulated, and the scene is drawn in
one frame of DRAW_EVERY, since software draws it slowly; the panels and all else are done in every frame. Memory is
read each time the first asset has been open for as long. LEAK: bytes to lose in every frame, to see this fail. Exit
code 77, and the reason, without Xvfb or OpenGL. cmake --build build/dev --target pliant_player_memory runs it, for
half an hour or more."""
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

import numpy as np

HOUR = 216000
DRAW_EVERY = 60
NAMES = ["tube_neo", "layers_tube", "twelve_poses", "tube_factored"]
# Kilobytes for 1000 frames over the second half of the use.
LARGEST_IN_USE, LARGEST_RESIDENT = 8.0, 16.0


def skip(reason):
    print("skipped:", reason)
    sys.exit(77)


def use(player, compiler, source, files, frames, leak, folder):
    """Frames, kilobytes resident and kilobytes in use."""
    library, log = folder / "use_player.so", folder / "memory.txt"
    subprocess.run([compiler, "-std=gnu99", "-O2", "-Wall", "-Wextra", "-shared", "-fPIC", source, "-ldl", "-o",
                    library], check=True)
    variables = {"PLIANT_USE_FRAMES": frames, "PLIANT_USE_FILES": ":".join(map(str, files)), "PLIANT_USE_LOG": log,
                 "PLIANT_USE_DRAW_EVERY": DRAW_EVERY, "PLIANT_USE_LEAK": leak, "LP_NUM_THREADS": 1}
    given = [f"{name}={value}" for name, value in variables.items()]
    command = ["xvfb-run", "-a", "-e", "/dev/stderr", "-s", "-screen 0 640x480x24", "env", f"LD_PRELOAD={library}", *given,
               player, files[0], "--size", "480x360"]
    done = subprocess.run(list(map(str, command)), cwd=folder, capture_output=True, text=True)
    if "P5921" in done.stderr:
        skip("no window here: " + done.stderr)
    if done.returncode != 0:
        sys.exit(f"exit code {done.returncode}: {done.stderr}")
    pictures = len(list(folder.rglob("*.png")))
    print(f"{frames} frames, {pictures} pictures written")
    frame, resident, in_use = np.loadtxt(log).T
    return frame, resident, in_use / 1024


def growth(frame, kilobytes):
    """Of the second half, in kilobytes for 1000 frames."""
    late = len(frame) // 2
    return 1000 * np.polyfit(frame[late:], kilobytes[late:], 1)[0]


def main():
    compiler, numbers = sys.argv[2], [int(text) for text in sys.argv[6:]]
    player, source, assets, bad = (pathlib.Path(sys.argv[i]).resolve() for i in (1, 3, 4, 5))
    frames, leak = (numbers + [HOUR, 0][len(numbers):])
    if not shutil.which("xvfb-run"):
        skip("xvfb-run is not installed (packages xvfb xauth)")
    files = [assets / f"{name}.pliant" for name in NAMES] + [bad]
    with tempfile.TemporaryDirectory(prefix="pliant-memory-") as name:
        folder = pathlib.Path(name)
        frame, resident, in_use = use(player, compiler, source, files, frames, leak, folder)
    if len(frame) < 6:
        sys.exit(f"only {len(frame)} readings: give more frames")
    late = len(frame) // 2
    print(f"{len(frame)} readings; in use {in_use[0]:.0f}, {in_use[late]:.0f}, {in_use[-1]:.0f} kB and resident "
          f"{resident[0]:.0f}, {resident[late]:.0f}, {resident[-1]:.0f} kB at the start, in the middle and at the end")
    grown = growth(frame, in_use), growth(frame, resident)
    print(f"second half: in use {grown[0]:+.2f} kB for 1000 frames (at most {LARGEST_IN_USE}), resident {grown[1]:+.2f} kB "
          f"(at most {LARGEST_RESIDENT})")
    return 0 if grown[0] <= LARGEST_IN_USE and grown[1] <= LARGEST_RESIDENT else 1


if __name__ == "__main__":
    sys.exit(main())
