"""bits.py TARGET ENVIRONMENT ASSETS PROGRAM SOURCES...: builds test_bits and the runtime for another platform or by another
compiler, runs it, and wants the hashes of PROGRAM, which is test_bits of this build, for ASSETS, and those in blends.txt for
tests/golden. Targets: TARGETS below. Those that nothing here can run are linked only, as a shared library. Processors and
systems are emulated, so nothing is said of speed. Exit code 77, and the reason, without what builds or runs it."""
import concurrent.futures
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import typing

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests/runtime"))
import compare_bits  # noqa: E402

# As runtime/README.md says to compile the sources without CMake.
OPTIONS = ["-std=c99", "-O3", "-fno-math-errno", "-fno-trapping-math", "-ffp-contract=off", "-Wall", "-Wextra", "-Werror",
           f"-I{ROOT / 'runtime'}", f"-I{ROOT / 'formats'}"]
WASI = pathlib.Path(__file__).with_name("wasi.mjs")
WINDOWS = ["-nostdlib", "-lucrtbase", "-lkernel32", "-Wl,--subsystem,console", "-Wl,-e,mainCRTStartup"]


class Target(typing.NamedTuple):
    triple: str = ""       # of zig; empty: this machine, by clang
    runs: typing.Optional[list] = None  # the command that runs a program; None: linked only
    options: tuple = ()
    link: tuple = ("-lm",)
    needs: str = ""        # a folder with its C library


TARGETS = {
    "clang": Target("", []),
    "windows_x64": Target("x86_64-windows-gnu", ["wine"], link=WINDOWS),
    "linux_arm64": Target("aarch64-linux-gnu", ["qemu-aarch64", "-L", "/usr/aarch64-linux-gnu"],
                          needs="/usr/aarch64-linux-gnu"),
    "linux_arm32": Target("arm-linux-gnueabihf", ["qemu-arm", "-L", "/usr/arm-linux-gnueabihf"],
                          needs="/usr/arm-linux-gnueabihf"),
    "linux_x86": Target("x86-linux-gnu", ["qemu-i386"], options=("-msse2", "-mfpmath=sse"), needs="/lib/ld-linux.so.2"),
    "wasm32": Target("wasm32-wasi", ["node", "--no-warnings", str(WASI)], options=("-msimd128",)),
    "macos_arm64": Target("aarch64-macos", link=("-shared", "-nostdlib", "-lSystem")),
    "macos_x64": Target("x86_64-macos", link=("-shared", "-nostdlib", "-lSystem")),
}


def skip(reason):
    print("skipped:", reason)
    sys.exit(77)


def call(command, **options):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, **options)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}: exit code {done.returncode}\n{(done.stdout + done.stderr)[-4000:]}")
    return done.stdout


def compile_for(target, compiler, sources, folder):
    """Objects first: two at a time, and a C library that is not linked is not built by zig either."""
    def compile_one(source):
        output = folder / f"{pathlib.Path(source).stem}.o"
        call([*compiler, *OPTIONS, *target.options, "-c", source, "-o", output])
        return output

    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        objects = list(pool.map(compile_one, sources))
    program = folder / ("bits.exe" if "windows" in target.triple else "bits")
    # zig builds what it links: optimised in less time than with its checks, and with the options of the npm package once.
    call([*compiler, "-O2", "-s", *target.options, *objects, *target.link, "-o", program])
    return program


def wine_without_setup(folder):
    """Where Wine lives in `folder`. Its own set-up registers programs and fonts for ten seconds; a program of the console
    needs system32 alone. Without Wine's libraries where Debian has them, Wine sets itself up."""
    libraries = sorted(pathlib.Path("/usr/lib").glob("*/wine/x86_64-windows/kernel32.dll"))
    if libraries:
        system = folder / "drive_c/windows/system32"
        (folder / "dosdevices").mkdir(parents=True)
        system.mkdir(parents=True)
        (folder / "dosdevices/c:").symlink_to("../drive_c")
        (folder / "dosdevices/z:").symlink_to("/")
        for library in libraries[0].parent.iterdir():
            (system / library.name).symlink_to(library)
        (folder / ".update-timestamp").write_text("disable")
    return {**os.environ, "WINEDEBUG": "-all", "WINEPREFIX": str(folder), "DISPLAY": ""}


def check_tools(target, environment):
    if target.triple and not (environment / "is_complete").exists():
        skip("zig could not be fetched")
    if not target.triple and not shutil.which("clang"):
        skip("clang is not installed (bash samples/install_packages.sh tests)")
    if target.runs and not shutil.which(target.runs[0]):
        skip(f"{target.runs[0]} is not installed (bash samples/install_packages.sh engines)")
    if target.needs and not pathlib.Path(target.needs).exists():
        skip(f"there is no {target.needs} (bash samples/install_packages.sh engines)")


def main():
    name, environment, assets, program, *sources = sys.argv[1:]
    target, environment = TARGETS[name], pathlib.Path(environment)
    check_tools(target, environment)
    if target.runs is None:
        sources = [source for source in sources if pathlib.Path(source).parent == ROOT / "runtime"]
    zig = [environment / "bin/python", "-m", "ziglang", "cc", "-target", target.triple]
    with tempfile.TemporaryDirectory(prefix="pliant-platform-") as temporary:
        folder = pathlib.Path(temporary)
        binary = compile_for(target, zig if target.triple else ["clang"], sources, folder)
        print(f"{name}: {binary.stat().st_size} bytes")
        if target.runs is None:
            return 0
        variables = wine_without_setup(folder / "wine") if "windows" in target.triple else os.environ
        found = call([*target.runs, binary, assets, compare_bits.GOLDEN], env=variables)
    wrong = compare_bits.first_difference(call([program, assets]) + compare_bits.blends(), found)
    print(wrong or f"{len(found.splitlines())} lines, the same")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
