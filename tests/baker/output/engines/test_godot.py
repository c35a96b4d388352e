"""test_godot.py TOOL ASSET: Godot 3's headless server imports the GLB of `pliant export`, in floats and in integers, and has
all vertices, targets and the animation."""
import json
import pathlib
import shutil
import subprocess
import sys
import time

import numpy as np

from support import HERE, Glb, check, export, skip

KINDS = {"floats": [], "integers": ["--quantize", "1e-4"]}
PROJECT = 'config_version=4\n\n[application]\n\nconfig/name="pliant"\n'


def import_files(program, project):
    """Runs the editor until it has imported, and then ends it. Its --quit ends it after the first frame, whether the thread
    that scans the project has found the files by then or not (godotengine/godot#77508). The .md5 file is the last that an
    import writes.
    """
    with open(project / "editor.log", "w") as log:
        editor = subprocess.Popen([program, "--path", project, "--editor"], stdout=log, stderr=log, stdin=subprocess.DEVNULL)
        deadline = time.monotonic() + 200
        while (len(list(project.glob(".import/*.glb-*.md5"))) < len(KINDS) and editor.poll() is None
               and time.monotonic() < deadline):
            time.sleep(0.2)
        editor.kill()
        editor.wait()
    check(len(list(project.glob(".import/*.glb-*.scn"))) == len(KINDS),
          f"not imported: {(project / 'editor.log').read_text()[-2000:]}")


def main():
    tool, asset = sys.argv[1:]
    program = shutil.which("godot3-server")
    if not program:
        skip("godot3-server is not installed (group engines of samples/install_packages.sh)")
    project = pathlib.Path("godot").resolve()
    shutil.rmtree(project, ignore_errors=True)
    project.mkdir()
    (project / "project.godot").write_text(PROJECT)
    shutil.copy(HERE / "godot.gd", project / "godot.gd")
    for kind, options in KINDS.items():
        export(tool, asset, project / f"{kind}.glb", *options)
    import_files(program, project)
    result = subprocess.run([program, "--path", project, "-s", "godot.gd"], capture_output=True, text=True, timeout=100)
    lines = [line for line in result.stdout.splitlines() if line.startswith("REPORT ")]
    check(len(lines) == len(KINDS), f"no report: {result.stdout[-2000:]}{result.stderr[-2000:]}")
    for kind, line in zip(KINDS, lines):
        check_report(Glb(project / f"{kind}.glb"), json.loads(line[len("REPORT "):]))
    return 0


def check_report(glb, report):
    primitive = glb.primitive()
    check(report["vertices"] == glb.own_count() + 2, f"vertices: {report}")
    check(report["indices"] == len(glb.accessor(primitive["indices"])), f"indices: {report}")
    first = [glb.attribute("POSITION")[0] + glb.attribute("POSITION", j)[0] for j in range(report["targets"])]
    check(np.allclose(report["first_vertex"], first, rtol=1e-5, atol=1e-5), f"first vertex: {report['first_vertex']}")
    check(report["targets"] == len(primitive["targets"]), f"targets: {report}")
    check(abs(report["weight"] - 0.25) < 1e-6, f"weight: {report}")
    check(report["tracks"] >= len(primitive["targets"]) and abs(report["length"] - 6) < 0.1, f"animation: {report}")
    print(json.dumps({key: report[key] for key in ("vertices", "targets", "tracks", "length", "names")}))


sys.exit(main())
