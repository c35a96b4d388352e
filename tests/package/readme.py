"""The README's C code is compiled as it stands, and run: readme.py ROOT WORK CC MAIN ASSET_FOLDER

MAIN (readme_main.c) calls its blend() on every asset of the folder and compares with the answers stored in the asset.
"""
import re
import subprocess
import sys
from pathlib import Path


def c_blocks(text):
    return re.findall(r"^```c\n(.*?)^```", text, re.MULTILINE | re.DOTALL)


def main(root, work, compiler, main_source, asset_folder):
    blocks = c_blocks((root / "README.md").read_text())
    if not blocks:
        print("README.md has no C code")
        return 1
    work.mkdir(parents=True, exist_ok=True)
    (work / "readme_snippet.c").write_text("\n".join(blocks))
    sources = sorted((root / "runtime").glob("*.c"))
    program = work / "readme"
    subprocess.run([compiler, "-std=c99", "-Wall", "-Wextra", "-Werror", "-ffp-contract=off", "-O1", f"-I{root}/runtime",
                    f"-I{root}/formats", f"-I{work}", str(main_source), *map(str, sources), "-lm", "-o", str(program)],
                   check=True)
    assets = sorted(map(str, asset_folder.glob("*.pliant")))
    if not assets:
        print(f"skipped: the code compiles, but no asset in {asset_folder} to run it on")
        return 77
    return subprocess.run([str(program), *assets], check=False).returncode


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]).resolve(), Path(sys.argv[2]), sys.argv[3], Path(sys.argv[4]), Path(sys.argv[5])))
