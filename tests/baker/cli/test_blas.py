"""test_blas.py TOOL: the tool takes the kernels of OpenBLAS for AVX2 where the processor has it, whatever OpenBLAS would
take, and leaves the choice of the environment alone. OpenBLAS reports its choice with OPENBLAS_VERBOSE=2, the tool with
`info --build`. A bake with the tool's choice has the bytes of one with the environment's."""
import json
import math
import os
import pathlib
import subprocess
import sys
import tempfile


def kernels(tool, **environment):
    """The last choice that OpenBLAS reports while the tool prints its version."""
    kept = {name: value for name, value in os.environ.items() if not name.startswith("OPENBLAS_")}
    result = subprocess.run([tool, "--version"], env={**kept, **environment, "OPENBLAS_VERBOSE": "2"}, capture_output=True,
                            text=True, check=True)
    reported = [line.split(":")[1].strip() for line in result.stderr.splitlines() if line.startswith("Core:")]
    return reported[-1] if reported else None


def run(tool, *arguments, **environment):
    kept = {name: value for name, value in os.environ.items() if not name.startswith("OPENBLAS_")}
    return subprocess.run([tool, *map(str, arguments)], env={**kept, **environment}, capture_output=True, text=True,
                          check=True).stdout


def write_strip(path, bend):
    """A strip of 40 x 4 squares, bent by so many radians."""
    with open(path, "w", encoding="ascii") as file:
        for i in range(41):
            angle, way = bend * i / 40, 10 * i / 40
            x, z = (way, 0) if bend == 0 else (10 / bend * math.sin(angle), 10 / bend * (1 - math.cos(angle)))
            for j in range(5):
                file.write(f"v {x} {j / 4} {z}\n")
        for i in range(40):
            for a in (5 * i + j + 1 for j in range(4)):
                file.write(f"f {a} {a + 5} {a + 6} {a + 1}\n")


def bake(tool, poses, asset, **environment):
    run(tool, "bake", *poses, "-o", asset, "--quiet", "--preview", **environment)
    return asset.read_bytes()


def test_bytes(tool, kernel):
    with tempfile.TemporaryDirectory(prefix="pliant-blas-") as name:
        folder = pathlib.Path(name)
        poses = [folder / "flat.obj", folder / "bent.obj"]
        for path, bend in zip(poses, (0, 2.5)):
            write_strip(path, bend)
        chosen = bake(tool, poses, folder / "a.pliant")
        given = bake(tool, poses, folder / "a.pliant", OPENBLAS_CORETYPE=kernel, OPENBLAS_NUM_THREADS="1")
    print("bytes", len(chosen), "the same" if chosen == given else "FAILED")
    return chosen == given


def main():
    tool = sys.argv[1]
    if kernels(tool) is None:
        print("skipped: this BLAS does not report its kernels")
        return 77
    flags = pathlib.Path("/proc/cpuinfo").read_text(encoding="ascii", errors="replace").split()
    expected = "Haswell" if "avx2" in flags and "fma" in flags else kernels(tool, OPENBLAS_NUM_THREADS="1")
    for environment, wanted in (({}, expected), ({"OPENBLAS_NUM_THREADS": "1", "OPENBLAS_CORETYPE": ""}, expected),
                                ({"OPENBLAS_CORETYPE": "Sandybridge"}, "Sandybridge")):
        found = kernels(tool, **environment)
        print(environment, "kernels", found)
        if found != wanted:
            print(f"FAILED  expected {wanted}")
            return 1
        told = json.loads(run(tool, "info", "--build", "--json", **environment))["blas"]
        if not told.startswith("OpenBLAS ") or not told.endswith(f", {wanted}"):
            print(f"FAILED  info --build says {told!r}")
            return 1
    return 0 if test_bytes(tool, expected) else 1


if __name__ == "__main__":
    sys.exit(main())
