"""test_write_faults.py TOOL: the writer when the world is against it. TOOL is load_poses_tool, which writes pose 0.
A full disk, a limit on the size of files, kill -9 at any moment, two writers at once: the old file or the new one is there,
whole, and nothing else."""
import math
import os
import pathlib
import random
import resource
import signal
import subprocess
import sys
import tempfile
import time

TOOL = sys.argv[1]
SEGMENTS = 200
failures = []


def check(condition, text):
    print(("ok      " if condition else "FAILED  ") + text)
    if not condition:
        failures.append(text)


def write_sheet(path, height):
    """A wavy sheet of SEGMENTS x SEGMENTS quads: about one megabyte when written."""
    n = SEGMENTS + 1
    with open(path, "w", encoding="ascii") as file:
        for i in range(n):
            for k in range(n):
                file.write(f"v {i} {k} {height * math.sin(0.1 * i) * math.cos(0.07 * k):.6f}\n")
        for i in range(SEGMENTS):
            for k in range(SEGMENTS):
                a = i * n + k + 1
                file.write(f"f {a} {a + 1} {a + n + 1} {a + n}\n")


def command(output, *poses, repeat=1):
    return [TOOL, "--write", str(output), "--repeat", str(repeat), *map(str, poses)]


def run(output, *poses, **keywords):
    return subprocess.run(command(output, *poses), stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=120,
                          **keywords)


def limit_file_size():
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (100_000, 100_000))


def test_file_size_limit(folder, poses):
    output = folder / "limited"
    output.mkdir()
    (output / "out.ply").write_bytes(b"old")
    result = run(output / "out.ply", *poses, preexec_fn=limit_file_size)
    check(result.returncode == 1 and "error P4005" in result.stderr, "a write that is cut short: exit code 1, P4005")
    check((output / "out.ply").read_bytes() == b"old", "the old file is untouched")
    check(os.listdir(output) == ["out.ply"], "nothing else is left")


def test_full_disk(folder, poses):
    disk = folder / "disk"
    disk.mkdir()
    mounted = os.geteuid() == 0 and subprocess.run(["mount", "-t", "tmpfs", "-o", "size=64k", "none", str(disk)],
                                                   capture_output=True).returncode == 0
    if not mounted:
        print("skipped a full disk: cannot mount one here")
        return
    try:
        (disk / "out.ply").write_bytes(b"old")
        result = run(disk / "out.ply", *poses)
        check(result.returncode == 1 and "error P4005" in result.stderr and "No space left" in result.stderr,
              "a full disk: exit code 1, P4005, and the reason")
        check((disk / "out.ply").read_bytes() == b"old" and os.listdir(disk) == ["out.ply"], "the old file alone is there")
    finally:
        subprocess.run(["umount", str(disk)], check=True)


def test_kill(folder, poses, wanted):
    output = folder / "killed"
    output.mkdir()
    target = output / "out.ply"
    target.write_bytes(b"old")
    chance = random.Random(5)
    left_temporary = 0
    for _ in range(25):
        before = target.stat().st_ino
        process = subprocess.Popen(command(target, *poses, repeat=1_000_000), stdin=subprocess.DEVNULL,
                                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        deadline = time.monotonic() + 60
        while target.stat().st_ino == before and time.monotonic() < deadline: # until it writes
            time.sleep(0.005)
        time.sleep(0.05 * chance.random())
        process.kill()
        process.wait()
        content = target.read_bytes()
        if content not in (b"old", wanted):
            check(False, f"after kill -9 the file is neither the old nor the new one: {len(content)} bytes")
            return
        left_temporary += len(os.listdir(output)) - 1
    check(True, f"25 kills: the file was whole every time ({left_temporary} temporaries were seen)")
    check(target.read_bytes() == wanted, "at least one writer got through (else the test shows nothing)")
    result = run(target, *poses)
    check(result.returncode == 0 and os.listdir(output) == ["out.ply"], "the next writer clears away what the dead left")


def test_two_writers(folder, poses, first, second):
    output = folder / "two"
    output.mkdir()
    target = output / "out.ply"
    writers = [subprocess.Popen(command(target, *order, repeat=100), stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
               for order in (poses, poses[::-1])]
    seen = set()
    while any(writer.poll() is None for writer in writers):
        if target.exists():
            seen.add(target.read_bytes())
    check(all(writer.wait() == 0 for writer in writers), "two writers at once: both succeed")
    seen.add(target.read_bytes())
    check(seen <= {first, second}, f"whoever reads meanwhile sees a whole file ({len(seen)} different ones seen)")
    check(os.listdir(output) == ["out.ply"], "nothing else is left")


def main():
    with tempfile.TemporaryDirectory(prefix="pliant-test-") as name:
        folder = pathlib.Path(name)
        poses = [folder / "a.obj", folder / "b.obj"]
        write_sheet(poses[0], 3)
        write_sheet(poses[1], 5)
        wanted = []
        for order in (poses, poses[::-1]):
            result = run(folder / "wanted.ply", *order)
            check(result.returncode == 0, f"writes at all {result.stderr}")
            wanted.append((folder / "wanted.ply").read_bytes())
        test_file_size_limit(folder, poses)
        test_full_disk(folder, poses)
        test_kill(folder, poses, wanted[0])
        test_two_writers(folder, poses, *wanted)
    return 1 if failures else 0


sys.exit(main())
