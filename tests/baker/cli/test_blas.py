"""test_blas.py TOOL: the tool takes the kernels of OpenBLAS for AVX2 where the processor has it, whatever OpenBLAS would
take, and leaves the choice of the environment alone. OpenBLAS reports its choice with OPENBLAS_VERBOSE=2."""
import os
import pathlib
import subprocess
import sys


def kernels(tool, **environment):
    """The last choice that OpenBLAS reports while the tool prints its version."""
    kept = {name: value for name, value in os.environ.items() if not name.startswith("OPENBLAS_")}
    result = subprocess.run([tool, "--version"], env={**kept, **environment, "OPENBLAS_VERBOSE": "2"}, capture_output=True,
                            text=True, check=True)
    reported = [line.split(":")[1].strip() for line in result.stderr.splitlines() if line.startswith("Core:")]
    return reported[-1] if reported else None


def main():
    tool = sys.argv[1]
    if kernels(tool) is None:
        print("skipped: this BLAS does not report its kernels")
        return 77
    flags = pathlib.Path("/proc/cpuinfo").read_text(encoding="ascii", errors="replace").split()
    expected = "Haswell" if "avx2" in flags and "fma" in flags else kernels(tool, OPENBLAS_NUM_THREADS="1")
    for environment, wanted in (({}, expected), ({"OPENBLAS_NUM_THREADS": "1"}, expected),
                                ({"OPENBLAS_CORETYPE": "Sandybridge"}, "Sandybridge")):
        found = kernels(tool, **environment)
        print(environment, "kernels", found)
        if found != wanted:
            print(f"FAILED  expected {wanted}")
            return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
