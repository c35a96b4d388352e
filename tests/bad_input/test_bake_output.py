"""test_bake_output.py PLIANT: bakes that do not end well. Interrupted: exit code 130, nothing new, the old file untouched.
Cut short by a limit on the size of files: exit code 1, the same. Two at once to one output: both succeed, one whole asset
stays."""
import os
import pathlib
import re
import resource
import signal
import struct
import subprocess
import sys
import tempfile
import time

import generate

TESTS = pathlib.Path(__file__).resolve().parents[1]
sys.path[:0] = [str(TESTS), str(TESTS / "runtime"), str(TESTS.parent / "formats" / "reference")]
from asset_checksums import with_checksums  # noqa: E402
from still_asset import make_still_asset  # noqa: E402

TOOL = sys.argv[1]
failures = []


def check(condition, text):
    print(("ok      " if condition else "FAILED  ") + text)
    if not condition:
        failures.append(text)


def bake(poses, output, *options, **keywords):
    return subprocess.Popen([TOOL, "bake", *map(str, poses), "-o", str(output), "--quiet", *options],
                            stdin=subprocess.DEVNULL,
                            stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, **keywords)


def take_signals(number, ignored):
    signal.signal(number, signal.SIG_DFL)  # the test may run under nohup
    for other in ignored:
        signal.signal(other, signal.SIG_IGN)


def test_interrupt(folder, poses, number, ignored=()):
    name = number.name
    (folder / "out").mkdir(exist_ok=True)
    target = folder / "out" / "a.pliant"
    target.write_bytes(b"old")
    process = bake(poses, target, preexec_fn=lambda: take_signals(number, ignored))
    time.sleep(1) # long enough to be at work; a bake of this mesh takes many seconds
    for other in ignored:
        process.send_signal(other)
        time.sleep(0.2)
        check(process.poll() is None, f"{name}: {other.name} is ignored, as under nohup")
    is_working = process.poll() is None
    process.send_signal(number)
    _, errors = process.communicate(timeout=60)
    if not is_working:
        print(f"skipped {name}: the bake was done too soon")
        return
    check(process.returncode == 130, f"{name}: exit code {process.returncode}, wanted 130")
    check(target.read_bytes() == b"old" and os.listdir(folder / "out") == ["a.pliant"],
          f"{name}: the old file alone is there")
    check(errors == "pliant bake: interrupted, nothing was written\n", f"{name}: {errors!r}")


def test_interrupt_of_many(folder, poses):
    """What was written before an interrupt stays, and is counted."""
    command = [TOOL, "average", *map(str, poses), "--grid", "1000", "-o", str(folder / "grid_%d.ply"), "--quiet"]
    process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    while not list(folder.glob("grid_*.ply")) and process.poll() is None:
        time.sleep(0.01)
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate(timeout=60)
    written = len(list(folder.glob("grid_*.ply")))
    found = re.fullmatch(r"pliant average: interrupted, (\d+) files were written, each whole\n", errors)
    check(process.returncode == 130 and (found and int(found[1]) == written or written == 1),
          f"{written} averages are there: {errors!r}")


def limit_file_size():
    resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000))


def test_cut_short(folder, poses):
    (folder / "limited").mkdir()
    target = folder / "limited" / "a.pliant"
    target.write_bytes(b"old")
    process = bake(poses, target, preexec_fn=limit_file_size)
    _, errors = process.communicate(timeout=300)
    check(process.returncode == 1 and "error P4005" in errors,
          f"cut short: exit code {process.returncode}, {errors.strip()}")
    check(target.read_bytes() == b"old" and os.listdir(folder / "limited") == ["a.pliant"],
          "cut short: the old file alone is there")


def test_two_bakes(folder, poses):
    (folder / "two").mkdir()
    target = folder / "two" / "a.pliant"
    processes = [bake(poses, target) for _ in range(2)]
    errors = [process.communicate(timeout=300)[1] for process in processes]
    check(all(process.returncode == 0 for process in processes), f"two bakes at once succeed {errors}")
    check(os.listdir(folder / "two") == ["a.pliant"], "two bakes: one file is there")
    valid = subprocess.run([TOOL, "validate", str(target)], stdin=subprocess.DEVNULL, capture_output=True, text=True,
                           timeout=300)
    check(valid.returncode == 0, f"two bakes: it is valid {valid.stderr}")


def run(*arguments):
    return subprocess.run([TOOL, *map(str, arguments)], stdin=subprocess.DEVNULL, capture_output=True, text=True,
                          timeout=300)


def change_number(blob, wanted, place, value):
    """The asset with another number in a chunk, checksums made right again."""
    blob = bytearray(blob)
    (count,) = struct.unpack_from("<I", blob, 24)
    for entry in range(64, 64 + 32 * count, 32):
        tag, _, offset = struct.unpack_from("<4sIQ", blob, entry)
        if tag == wanted:
            struct.pack_into("<f", blob, offset + place, value)
            return with_checksums(blob)
    raise AssertionError(f"no chunk {wanted}")


def change_text(blob, said, other):
    """The asset with its only text of a pattern changed to another, which is not longer."""
    (found,) = re.findall(said, blob)
    return with_checksums(blob.replace(found, other.ljust(len(found))))


def change_first_answer(blob):
    """Only solving finds out."""
    return change_number(blob, b"ANSW", 64 + 4 * struct.unpack_from("<I", blob, 44)[0], 1e3)


def test_no_shape(folder, poses):
    """The format takes any numbers; an export needs a shape."""
    asset, changed = folder / "plain.pliant", folder / "changed.pliant"
    check(run("bake", *poses, "-o", asset, "--quiet", "--position-error", "0").returncode == 0, "a good bake")
    blob = asset.read_bytes()
    upper_range = 4 * ((struct.unpack_from("<I", blob, 40)[0] + 15) // 16 * 16)
    for chunk, place, value in ((b"REST", 0, float("inf")), (b"REST", 0, float("nan")), (b"REST", 0, 3e38),
                                (b"MRNG", upper_range, 3e38)):
        changed.write_bytes(change_number(blob, chunk, place, value))
        check(run("validate", changed).returncode == 0, f"{value} keeps the rules of the format")
        for options in ([], ["--quantize", "1e-3"], ["--meshopt"], *([["--skin", "2"]] if chunk == b"REST" else [])):
            result = run("export", changed, "-o", folder / "changed.glb", *options)
            check(result.returncode == 3 and "error P5102" in result.stderr,
                  f"{value} exported with {options}: {result.returncode} {result.stderr}")


def test_large_exports(folder):
    """Few bytes can have many vertices in many dimensions, or many parts."""
    asset = folder / "still.pliant"
    for vertices, parts, text in ((400, 0, None), (70000, 0, "columns of its 70000 vertices in 256 dimensions"),
                                  (1000, 300, "301 parts in 256 dimensions")):
        asset.write_bytes(make_still_asset(vertices, 256, parts))
        check(run("validate", asset).returncode == 0, f"{vertices} vertices keep the rules of the format")
        result = run("export", asset, "-o", folder / "still.glb")
        is_right = result.returncode == 3 and "P5102" in result.stderr and text in result.stderr if text \
            else result.returncode == 0
        check(is_right, f"exported {vertices} vertices in {parts} parts: {result.returncode} {result.stderr}")


def test_wrong_partners(folder, poses):
    asset, changed = folder / "a.pliant", folder / "changed.pliant"
    check(run("bake", *poses, "-o", asset, "--quiet").returncode == 0, "a good bake")
    swapped = run("measure", asset, *reversed(poses), "--samples", "1")
    check(swapped.returncode == 3 and "error P5104" in swapped.stderr,
          f"measured with poses in another order: {swapped.stderr}")
    for said, other in ((rb'"continuity": "auto"', b'"blend": "layers"'), (rb'"thickness": 0.00\d', b'"thickness": 1e9'),
                        (rb'"thickness": 0.00\d', b'"thickness": -1'),
                        (rb'"aligned": true,\s*"solver": "\w+"', b'"aligned":false,"fixed_vertices":[1.5]'),
                        (rb'"aligned": true,\s*"solver": "\w+"', b'"aligned":false,"fixed_vertices":[3,2]')):
        changed.write_bytes(change_text(asset.read_bytes(), said, other))
        damaged = run("measure", changed, *poses, "--samples", "1")
        check(damaged.returncode == 3 and "error P5103" in damaged.stderr, f"measured with {other}: {damaged.stderr}")
    changed.write_bytes(change_first_answer(asset.read_bytes()))
    unreproduced = run("validate", changed)
    check(unreproduced.returncode == 3 and "error P5105" in unreproduced.stderr,
          f"a stored answer changed: {unreproduced.stderr}")
    check(run("validate", asset).returncode == 0, "the unchanged asset is valid")
    missed = run("bake", *poses, "-o", folder / "missed.pliant", "--tolerance", "1e-8", "--best-effort")
    check(missed.returncode == 4 and "warning P4404" in missed.stderr,
          f"best effort: exit code {missed.returncode}, {missed.stderr}")
    check((folder / "missed.pliant").exists(), "best effort: the asset is written")
    preview = run("bake", *poses, "-o", folder / "preview.pliant", "--tolerance", "1e-8", "--preview")
    check(preview.returncode == 4 and "warning P4404" in preview.stderr
          and "leave out --preview or --time-limit 0" in preview.stderr,
          f"a preview that misses its tolerance: exit code {preview.returncode}, {preview.stderr}")
    check(run("validate", folder / "preview.pliant").returncode == 0, "the preview is written, and valid")
    config = folder / "preview.json"
    config.write_text('{"preview": true, "tolerance": 1e-8}', encoding="utf-8")
    longer = run("bake", "--config", config, *poses, "-o", folder / "preview.pliant", "--time-limit", "1")
    check(longer.returncode == 4 and "raise --time-limit" in longer.stderr,
          f"a limit of time overrides that of a preview: exit code {longer.returncode}, {longer.stderr}")


def test_drawn_surface(folder):
    generate.generate("output_is_surface", folder)
    solids, shell, asset, plain = ([folder / "solid.msh", folder / "solid_bent.msh"], folder / "shell.obj",
                                   folder / "d.pliant", folder / "p.pliant")
    quick = ["--quiet", "--check-samples", "2", "--fresh-samples", "0", "--dim", "4"]
    baked = run("bake", *solids, "--surface", shell, "-o", asset, *quick)
    check(baked.returncode == 0, f"a solid that draws a surface {baked.stderr}")
    check(run("bake", *solids, "-o", plain, *quick).returncode == 0, "the same without")
    check(run("validate", asset).returncode == 0, "with a surface it is valid")
    measured = run("measure", asset, *solids, "--surface", shell, "--samples", "2")
    check(measured.returncode == 0 and "relative L2: mean" in measured.stdout, f"measured at its surface {measured.stderr}")
    for name, arguments, number in [("without the surface", [asset], "P5106"),
                                    ("a surface that it has not", [plain, "--surface", shell], "P5106"),
                                    ("from blends", [asset, "--from-blend", "--surface", shell], "P1210"),
                                    ("another surface", [asset, "--surface", folder / "other.obj"], "P5104")]:
        (folder / "other.obj").write_text(shell.read_text().replace("v 1 1 2", "v 1 1 2.5"))
        result = run("measure", arguments[0], *solids, *arguments[1:], "--samples", "1")
        check(f"error {number}" in result.stderr, f"measured {name}: {result.stderr}")
    blend = run("blend", asset, "--weights", "1,1", "-o", folder / "blend.ply")
    check(blend.returncode == 0 and b"element vertex 6\n" in (folder / "blend.ply").read_bytes(),
          f"the surface is written {blend.stderr}")


def main():
    with tempfile.TemporaryDirectory(prefix="pliant-test-") as name:
        folder = pathlib.Path(name)
        small = [folder / "good.obj", folder / "bent.obj"]
        generate.generate("good", folder)
        large = [folder / "large.obj", folder / "large_bent.obj"]
        generate.write_mesh(large[0], generate.sheet(generate.saddle, n=120))
        generate.write_mesh(large[1], generate.sheet(generate.roof, n=120))
        test_interrupt(folder, large, signal.SIGINT)
        test_interrupt(folder, large, signal.SIGHUP)
        test_interrupt(folder, large, signal.SIGTERM, ignored=[signal.SIGHUP])
        test_interrupt_of_many(folder, small)
        test_cut_short(folder, small)
        test_wrong_partners(folder, small)
        test_no_shape(folder, small)
        test_large_exports(folder)
        test_drawn_surface(folder)
        test_two_bakes(folder, small)
    return 1 if failures else 0


sys.exit(main())
