"""wasm.py PYTHON PACKAGE FOUND SECONDS FILE...: compiles the mutator of assets with the zig of PYTHON and gives mutations of
the files to the npm package in node (wasm.mjs). Findings lie in the folder FOUND, the mutator beside it. Exit code 77, and
the reason, without node or zig."""
import shutil
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
ENTRIES = ["malloc", "LLVMFuzzerCustomMutator", "LLVMFuzzerCustomCrossOver"]


def main(python, package, found, seconds, *files):
    if not shutil.which("node") or not Path(python).exists():
        print("skipped: node is not installed, or zig could not be fetched")
        return 77
    module = Path(found).parent / "mutator.wasm"
    module.parent.mkdir(parents=True, exist_ok=True)
    sources = [str(HERE / name) for name in ("mutate_asset.c", "mutate_bytes.c")]
    exports = [f"-Wl,--export={name}" for name in ENTRIES]
    subprocess.run([python, "-m", "ziglang", "cc", "-target", "wasm32-wasi", "-std=c99", "-O2", "-mexec-model=reactor",
                    f"-I{HERE.parents[1] / 'formats'}", *sources, *exports, "-o", str(module)], check=True)
    command = ["node", str(HERE / "wasm.mjs"), package, str(module), seconds, found, *files]
    return subprocess.run(command).returncode


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
