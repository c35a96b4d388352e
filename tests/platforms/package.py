"""package.py FOLDER ENVIRONMENT ASSETS MUSEUM PROGRAM: the npm package. Its blends have the bits of PROGRAM, which is
test_bits of this machine, and those in tests/golden/blends.txt; it survives the museum; its module has at most LARGEST
bytes, compressed. `npm pack` makes an archive that installs offline, against which types.ts type-checks, and which bundlers
take. Exit code 77, and the reason, without node, and for the last part without the npm registry."""
import gzip
import pathlib
import re
import shutil
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path[:0] = [str(ROOT / "tests" / part) for part in ("baker/output/engines", "runtime")]
import compare_bits  # noqa: E402
import support  # noqa: E402: installs node's packages

LARGEST = 40000  # bytes, compressed
# call_indirect of a type, with five bytes for its table: Chromium 91 and node 16 refuse the module.
OVERLONG = re.compile(rb"\x11(?:[\x00-\x7f]|[\x80-\xff]{4}[\x00-\x7f])\x80{4}\x00")
CHECK = ["--noEmit", "--strict", "--target", "es2022", "--module", "nodenext", "--moduleResolution", "nodenext"]


def run(*command, **options):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, **options)
    support.check(done.returncode == 0, f"{' '.join(map(str, command))}: {done.returncode}\n{done.stdout}{done.stderr}")
    return done.stdout.strip()


def install(folder, package):
    """An outside project with the package from its archive."""
    run("npm", "pack", "--offline", "--silent", "--pack-destination", folder, cwd=package)
    (archive,) = folder.glob("pliant-*.tgz")
    project = folder / "project"
    shutil.rmtree(project, ignore_errors=True)
    project.mkdir()
    (project / "package.json").write_text('{ "private": true, "type": "module" }')
    run("npm", "install", "--offline", "--legacy-peer-deps", "--no-audit", "--no-fund", archive, cwd=project)
    return project


def check_types(project, modules):
    for name in ("three", "@types"):
        (project / "node_modules" / name).symlink_to(modules / "node_modules" / name)
    shutil.copy(HERE / "types.ts", project)
    run("node", modules / "node_modules/typescript/bin/tsc", *CHECK, "types.ts", cwd=project)
    broken = (project / "types.ts").read_text().replace("// @ts-expect-error", "//")
    (project / "broken.ts").write_text(broken)
    failing = subprocess.run(["node", modules / "node_modules/typescript/bin/tsc", *CHECK, "broken.ts"], cwd=project)
    support.check(failing.returncode != 0, "the types refuse nothing")


def main():
    folder, environment, assets, museum, program = map(pathlib.Path, sys.argv[1:])
    if not shutil.which("node") or not shutil.which("npm"):
        support.skip("node and npm are not installed (group engines of samples/install_packages.sh)")
    if not (environment / "is_complete").exists():
        support.skip("zig could not be fetched")
    package = environment / "package"
    module = (package / "pliant.wasm").read_bytes()
    support.check(not OVERLONG.search(module), "the module needs reference types")
    size = len(gzip.compress(module, 9))
    print(f"pliant.wasm: {size} bytes compressed")
    support.check(size <= LARGEST, f"more than {LARGEST}")
    here = run(program, assets) + "\n" + compare_bits.blends()
    there = run("node", HERE / "package.mjs", package, assets, compare_bits.GOLDEN, museum)
    wrong = compare_bits.first_difference(here, there)
    support.check(not wrong, wrong)
    folder.mkdir(parents=True, exist_ok=True)
    project, modules = install(folder, package), support.node_modules(folder, HERE)
    check_types(project, modules)
    run("node", HERE / "bundle.mjs", modules, project)
    return 0


if __name__ == "__main__":
    sys.exit(main())
