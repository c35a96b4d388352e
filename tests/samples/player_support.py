"""What tests of the player share: TEST.py CASE PLAYER. Exit code 77: this machine cannot do it (the reason is printed).

Assets come from tests/runtime/tiny_asset.py: small, but solved by the real runtime.
"""
import os
import shutil
import subprocess
import sys
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # small matrices: threads of their own only wait for each other
import numpy as np  # noqa: E402
from PIL import Image, features  # noqa: E402

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "formats" / "reference"), str(ROOT / "tests"), str(ROOT / "tests" / "runtime")]
from asset_checksums import with_checksums  # noqa: E402,F401: for the tests of the player
PLAYER = str(Path(sys.argv[2]).resolve())
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


def use_window(folder, arguments, *steps, size="640x480"):
    """Opens the window with these arguments in a folder, and does the steps of use_window.py. Returns standard error."""
    if not shutil.which("xvfb-run") or not features.check("xcb"):
        skip("xvfb-run is not installed (packages xvfb xauth), or Pillow cannot look at the screen")
    script = 'player=$1; shift; count=$1; shift; "$player" "${@:1:count}" & id=$!; "${@:count+1}"; code=$?; ' \
             'kill -0 $id || code=9; kill $id; exit $code'
    command = ["xvfb-run", "-a", "-e", "/dev/stderr", "-s", f"-screen 0 {size}x24", "bash", "-c", script, "window", PLAYER,
               len(arguments) + 2, *arguments, "--size", size, sys.executable, "-B",
               Path(__file__).with_name("use_window.py"), *steps]
    result = subprocess.run(list(map(str, command)), capture_output=True, text=True, timeout=240, cwd=folder)
    if "P5921" in result.stderr:
        skip("no window here: " + result.stderr)
    assert result.returncode == 0, (result.returncode, result.stdout, result.stderr)
    return result.stderr


def read_picture(path):
    return np.asarray(Image.open(path).convert("RGB")).astype(float)


def make_named(folder, *names):
    """An asset whose poses have these names."""
    import tiny_asset
    original = tiny_asset.chunks_of

    def renamed(*arguments, **more):
        counts, origin, chunks = original(*arguments, **more)
        text = "".join(name + "\0" for name in names).encode()
        return counts, origin, [(tag, flag, text if tag == "NAME" else data) for tag, flag, data in chunks]

    tiny_asset.chunks_of = renamed
    path = folder / "named.pliant"
    path.write_bytes(tiny_asset.make_asset("tube", poses=len(names), dimension=6))
    tiny_asset.chunks_of = original
    return path


def shapes(image):
    """The part between the colour scale, which is 80 rows high, and the captions; their plates are paler than the scene."""
    plate = (image.min(axis=2) >= 251).sum(axis=1) >= 20
    below = np.nonzero(plate[len(image) // 2:])[0]
    return image[80:len(image) // 2 + below.min() if len(below) else None]


def write_path(folder, rows, name="weights.csv"):
    path = folder / name
    path.write_text("# weights\n" + "".join(",".join(map(str, row)) + "\n" for row in rows))
    return path


def warm(image):
    """The pixels of the elastic character: red well above blue."""
    return image[..., 0] - image[..., 2] > 25


def hot(image):
    """The pixels of the warm half of the scale: red well above green."""
    return (image[..., 0] - image[..., 1] > 60) & (image.mean(axis=2) < 190)


def thirds(image):
    third = image.shape[1] // 3
    return image[:, :third], image[:, third:2 * third], image[:, 2 * third:]


def make_truth(asset, folder, shift=0.0, stretch=1.0):
    """Unreduced averages, or what stands for them: the asset's poses, and its blend of all poses by the reference."""
    from pliant_reference import Asset
    reference = Asset(asset.read_bytes())
    weights = [[1, 0, 0], [0, 1, 0], [0, 0, 1], [1 / 3, 1 / 3, 1 / 3]]
    for i, row in enumerate(weights):
        z, _ = reference.minimise(np.array(row))
        shape = reference.reconstruct(reference.coordinates(z))
        shape = stretch * shape + shift * np.linalg.norm(np.ptp(shape, axis=0))
        faces = np.zeros(len(reference.triangles), dtype=[("count", "u1"), ("corners", "<i4", 3)])
        faces["count"], faces["corners"] = 3, reference.triangles
        header = (f"ply\nformat binary_little_endian 1.0\nelement vertex {len(shape)}\nproperty float x\nproperty float y\n"
                  f"property float z\nelement face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n")
        (folder / f"truth_{i}.ply").write_bytes(header.encode() + shape.astype("<f4").tobytes() + faces.tobytes())
    return write_path(folder, weights, "truth.csv"), folder / "truth_%d.ply"
