"""The tool where the system gives little: test_limits.py PLIANT. Messages that cannot be written, closed descriptors, little
address space. No case may end in a signal, work without end, or leave a file that is not whole."""
import json
import pathlib
import resource
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2]))
from layered_tube import tube, write_obj  # noqa: E402

TOOL = sys.argv[1]
SANITIZED = b"__asan_init" in pathlib.Path(TOOL).read_bytes()
BAKE = ("bake", "rest.obj", "bent.obj", "--dim", "2", "--check-samples", "2", "--fresh-samples", "1")
work = None


def shell(redirections, *arguments):
    line = f'exec "$0" "$@" {redirections}'
    return subprocess.run(["bash", "-c", line, TOOL, *arguments], cwd=work, capture_output=True, text=True, check=False,
                          timeout=60)


def bytes_of(name):
    path = work / name
    data = path.read_bytes() if path.exists() else b""
    path.unlink(missing_ok=True)
    return data


def check_messages(good):
    """Standard error that is full or closed changes nothing; standard output that is full is an error of its own."""
    for streams in ("2>/dev/full", "2>&-", "<&- 2>&-"):
        done = shell(streams, *BAKE, "-o", "a.pliant")
        assert done.returncode == 0 and bytes_of("a.pliant") == good, (streams, done)
        assert shell(streams, "check", "none.obj", "bent.obj").returncode == 3, streams
    for words in (("--version",), ("--help",), ("help", "bake"), (*BAKE, "-o", "a.pliant"),
                  ("check", "rest.obj", "bent.obj")):
        for streams in (">/dev/full", ">&-"):
            done = shell(streams, *words)
            assert done.returncode == 1 and "error P4903: " in done.stderr, (words, streams, done)
    assert bytes_of("a.pliant") == good, "the asset is whole all the same"
    done = subprocess.run(["bash", "-c", '"$0" help --man | true; exit ${PIPESTATUS[0]}', TOOL], check=False)
    assert done.returncode in (0, 141), "a reader that is gone ends the tool as any other program"


def check_batch(good):
    (work / "all.json").write_text(json.dumps({"bakes": [{"poses": ["rest.obj", "bent.obj"], "output": "b.pliant", "dim": 2,
                                                          "check_samples": 2, "fresh_samples": 1}]}))
    for streams, code in (("<&- >&-", 1), ("2>&- >/dev/null", 0), ("<&- 2>&- >/dev/null", 0)):
        done = shell(streams, "bake-all", "all.json", "--force")
        assert done.returncode == code and bytes_of("b.pliant") == good, (streams, done)


def check_memory(good):
    """From the limit on at which the system can load the program at all: of the address space, and of writable memory."""
    address_space = [(resource.RLIMIT_AS, size) for size in (72, 80, 100, 150, 200, 260, 300, 400, 600)]
    data = [(resource.RLIMIT_DATA, size) for size in (60, 100, 150, 300, 600)]
    for kind, mebibytes in data + address_space:
        for options in ((), ("--threads", "1"), ("--solver", "eigen")):
            def limit():
                resource.setrlimit(kind, (mebibytes << 20, mebibytes << 20))

            done = subprocess.run([TOOL, *BAKE, *options, "-o", "a.pliant"], cwd=work, capture_output=True, text=True,
                                  check=False, timeout=60, preexec_fn=limit)
            where = (kind, mebibytes, options, done)
            if done.returncode == 127 or "OpenBLAS blas_thread_init" in done.stderr:
                continue  # before our first line: a library could not be loaded, or threads of OpenBLAS not be started
            asset = bytes_of("a.pliant")
            assert done.returncode in (0, 1), where
            if done.returncode == 1:
                assert not asset and any(f"error P{n}: " in done.stderr for n in (4306, 4901, 4301)), where
            elif options != ("--solver", "eigen"):
                assert asset == good, where
    assert done.returncode == 0, "600 MiB are enough"


with tempfile.TemporaryDirectory(prefix="pliant_limits_") as temporary:
    work = pathlib.Path(temporary)
    for name, angles in (("rest", (0, 0)), ("bent", (0, 1.2))):
        write_obj(work / f"{name}.obj", tube(*angles))
    assert shell("", *BAKE, "-o", "good.pliant").returncode == 0
    asset = (work / "good.pliant").read_bytes()
    check_messages(asset)
    check_batch(asset)
    if not SANITIZED:  # its shadow memory takes terabytes of address space
        check_memory(asset)
    assert not [path for path in work.iterdir() if "pliant-tmp" in path.name], "leftovers"
print("passed")
