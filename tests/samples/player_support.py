"""What tests of the player share: TEST.py CASE PLAYER. Exit code 77: this machine cannot do it (the reason is printed).

Assets come from tests/runtime/tiny_asset.py: small, but solved by the real runtime.
"""
import os
import struct
import subprocess
import sys
import zlib
from pathlib import Path

import numpy as np
from PIL import Image

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "formats" / "reference"))
PLAYER = sys.argv[2]
# Graphics drivers leak a little, which sanitizer builds would report as ours. What does not draw is still watched.
if sys.argv[1] not in ("help", "usage", "bad_asset", "benchmark"):
    os.environ["ASAN_OPTIONS"] = "detect_leaks=0"


def skip(reason):
    print("skipped:", reason)
    sys.exit(77)


def make_asset(folder, *more, poses=3):
    path = folder / "tube.pliant"
    subprocess.run([sys.executable, ROOT / "tests/runtime/tiny_asset.py", path, "--mesh", "tube", "--poses", str(poses),
                    "--dim", str(max(6, poses - 1)), "--material", "neo-hookean", *more],
                   check=True, stdout=subprocess.DEVNULL)
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


def write_path(folder, rows, name="weights.csv"):
    path = folder / name
    path.write_text("# weights\n" + "".join(",".join(map(str, row)) + "\n" for row in rows))
    return path


def with_checksums(blob):
    """The asset with the checksums that its bytes have."""
    blob = bytearray(blob)
    count, = struct.unpack_from("<I", blob, 24)
    for i in range(count):
        _, _, offset, size = struct.unpack_from("<4sIQQ", blob, 64 + 32 * i)
        struct.pack_into("<I", blob, 64 + 32 * i + 24, zlib.crc32(blob[offset:offset + size]))
    struct.pack_into("<I", blob, 28, 0)
    struct.pack_into("<I", blob, 28, zlib.crc32(blob[:64 + 32 * count]))
    return bytes(blob)
