"""test_validator.py TOOL BUILD ASSET...: the Khronos validator finds no error and no warning in what `pliant export` writes."""
import json
import pathlib
import sys

from support import check, export, run_node

# Told about every file with our extension: a validator that does not know it cannot look into it, nor see that the view is used.
EXPECTED = ("UNSUPPORTED_EXTENSION", "UNUSED_OBJECT /bufferViews/0")


def main():
    tool, build, *assets = sys.argv[1:]
    folder = pathlib.Path("validator")
    folder.mkdir(exist_ok=True)
    files = {}
    for path in assets:
        for options in (["--morph"], ["--embed"], ["--embed", "--morph"]):
            output = folder / (pathlib.Path(path).stem + "".join(options) + ".glb")
            export(tool, path, output, *options)
            files[str(output.resolve())] = options
    report = json.loads(run_node(build, "validate.mjs", *files))
    check(set(report) == set(files), "the validator answered about other files")
    for path, found in report.items():
        messages = [m for m in found["messages"] if not ("--embed" in files[path] and m.startswith(EXPECTED))]
        check(found["errors"] == 0 and found["warnings"] == 0 and not messages, f"{path}: {found}")
    print(f"{len(report)} files: no errors, no warnings")
    return 0


sys.exit(main())
