"""bits.py TARGET ENVIRONMENT ASSETS PROGRAM SOURCES...: builds test_bits and the runtime for another platform with zig, runs
it, and wants the hash of PROGRAM, which is test_bits for this machine. Targets: TARGETS below. Those that nothing here can
run are linked only, as a shared library. Processors and systems are emulated, so nothing is said of speed. Exit code 77, and
the reason, without what runs it."""
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
# As runtime/README.md says to compile the sources without CMake.
OPTIONS = ["-std=c99", "-O3", "-fno-math-errno", "-fno-trapping-math", "-ffp-contract=off", "-Wall", "-Wextra", "-Werror",
           f"-I{ROOT / 'runtime'}", f"-I{ROOT / 'formats'}"]
WASI = pathlib.Path(__file__).with_name("wasi.mjs")

# Of zig; the program that runs the result, or None; more options.
TARGETS = {
    "windows_x64": ("x86_64-windows-gnu", ["wine"], []),
    "linux_arm64": ("aarch64-linux-musl", ["qemu-aarch64"], []),
    "wasm32": ("wasm32-wasi", ["node", "--no-warnings", str(WASI)], ["-msimd128"]),
    "macos_arm64": ("aarch64-macos", None, ["-shared"]),
    "macos_x64": ("x86_64-macos", None, ["-shared"]),
}


def skip(reason):
    print("skipped:", reason)
    sys.exit(77)


def compile_for(target, environment, sources, output):
    triple, _, options = TARGETS[target]
    zig = [str(environment / "bin/python"), "-m", "ziglang", "cc"]
    libraries = [] if "windows" in triple else ["-lm"]
    done = subprocess.run([*zig, "-target", triple, *OPTIONS, *options, *sources, *libraries, "-o", str(output)],
                          capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{triple}:\n{done.stderr[-4000:]}")


def hash_of(command, folder):
    # Wine: no window for its first start, no messages of its own.
    environment = {**os.environ, "WINEDEBUG": "-all", "WINEPREFIX": str(folder / "wine"), "DISPLAY": ""}
    done = subprocess.run(command, capture_output=True, text=True, env=environment)
    if done.returncode != 0:
        sys.exit(f"{' '.join(command)}: exit code {done.returncode}\n{done.stdout}{done.stderr}")
    return done.stdout.strip()


def main():
    target, environment, assets, program, *sources = sys.argv[1:]
    runner = TARGETS[target][1]
    if not (pathlib.Path(environment) / "is_complete").exists():
        skip("zig could not be fetched")
    if runner and not shutil.which(runner[0]):
        skip(f"{runner[0]} is not installed (bash samples/install_packages.sh engines)")
    if runner is None:
        sources = [source for source in sources if pathlib.Path(source).parent.name == "runtime" and "tests" not in source]
    with tempfile.TemporaryDirectory(prefix="pliant-platform-") as name:
        folder = pathlib.Path(name)
        binary = folder / ("bits.exe" if "windows" in target else "bits")
        compile_for(target, pathlib.Path(environment), sources, binary)
        print(f"{target}: {binary.stat().st_size} bytes")
        if runner is None:
            return 0
        here, there = hash_of([program, assets], folder), hash_of([*runner, str(binary), assets], folder)
    print(f"here {here}, {target} {there}")
    return 0 if here == there else 1


if __name__ == "__main__":
    sys.exit(main())
