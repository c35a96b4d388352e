"""compare_arm.py FOLDER PROGRAM SOURCES...: test_bits once more, for 64-bit ARM (NEON), must tell the same hash as PROGRAM
does here. The processor is emulated, so nothing is said of speed. Exit code 77 without aarch64-linux-gnu-gcc or
qemu-aarch64."""
import pathlib
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).parents[2]
COMPILER, EMULATOR = "aarch64-linux-gnu-gcc", "qemu-aarch64"
# As runtime/CMakeLists.txt has them. Static: the emulator then needs no ARM libraries.
OPTIONS = ["-std=c99", "-O3", "-fno-math-errno", "-fno-trapping-math", "-ffp-contract=off", "-static",
           f"-I{ROOT / 'runtime'}", f"-I{ROOT / 'formats'}"]


def main():
    folder, program, sources = sys.argv[1], sys.argv[2], sys.argv[3:]
    missing = [name for name in (COMPILER, EMULATOR) if not shutil.which(name)]
    if missing:
        print(f"skipped: {' and '.join(missing)} not installed (bash samples/install_packages.sh engines)")
        return 77
    with tempfile.TemporaryDirectory(prefix="pliant-arm-") as made:
        binary = str(pathlib.Path(made) / "bits")
        subprocess.run([COMPILER, *OPTIONS, *sources, "-lm", "-o", binary], check=True)
        hashes = [subprocess.run(command, capture_output=True, text=True, check=True).stdout
                  for command in ([program, folder], [EMULATOR, binary, folder])]
    print(f"here {hashes[0].strip()}, ARM {hashes[1].strip()}")
    return 0 if hashes[0] == hashes[1] else 1


if __name__ == "__main__":
    sys.exit(main())
