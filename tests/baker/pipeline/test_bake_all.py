"""test_bake_all.py PLIANT CHECKOUT: `pliant bake-all` with twelve small characters. Twice does nothing the second time;
killed in the middle it goes on where it was; contents count, not times; failures, crashes, interrupts and too little memory
end as they should."""
import json
import os
import pathlib
import pty
import re
import signal
import sys
import tempfile
import time

import support
from support import QUICK, check, poses, write_gltf, write_json

TOOL, SOURCE = support.Tool(sys.argv[1]), pathlib.Path(sys.argv[2])
TWELVE = [f"hero{i:02d}" for i in range(12)]


def manifest_of(folder, names, **more):
    for i, name in enumerate(names):
        poses(folder / "poses" / name, bend=0.6 + 0.05 * i, turn=0.03 * i)
    bakes = [{"name": name, "poses": [f"poses/{name}/rest.obj", f"poses/{name}/bent.obj"], "output": f"out/{name}.pliant",
              **more.get(name, {})}
             for name in names]
    (folder / "out").mkdir()
    return write_json(folder / "all.json", {"defaults": {**QUICK, **more.get("defaults", {})}, "bakes": bakes})


def run(manifest, *options):
    """Outcomes by name, and the finished process."""
    result = TOOL.run("bake-all", manifest, "--json", *options)
    if not result.stdout.startswith("{"):
        print(result.stderr)
    return {bake["name"]: bake["outcome"] for bake in json.loads(result.stdout)["bakes"]}, result


def done(outcomes, outcome):
    return sorted(name for name in outcomes if outcomes[name] == outcome)


def wait_until(condition, seconds=120):
    end = time.monotonic() + seconds
    while not condition():
        if time.monotonic() > end:
            check(False, "waited too long")
            return
        time.sleep(0.01)


def stamps(folder):
    return sorted(path.name.split(".")[0] for path in (folder / "out").glob("*.stamp"))


def children_of(pid):
    try:
        return [int(child) for child in pathlib.Path(f"/proc/{pid}/task/{pid}/children").read_text(encoding="utf-8").split()]
    except OSError:
        return []


def is_running(pid):
    try:
        return pathlib.Path(f"/proc/{pid}/stat").read_text(encoding="utf-8").rsplit(")", 1)[1].split()[0] != "Z"
    except OSError:
        return False


def test_twelve(folder):
    manifest = manifest_of(folder, TWELVE)
    result = TOOL.run("bake-all", manifest, "--jobs", "2", "--report", folder / "report.json")
    check(result.returncode == 0 and len(list((folder / "out").glob("*.pliant"))) == 12,
          f"twelve are baked {result.stderr if result.returncode else ''}")
    plan, _, summary = result.stdout.partition("12 of 12 to be baked")
    check(plan.count("to be baked") == 12 and plan.count("no asset yet") == 12 and " MiB" in plan,
          "the plan is printed first")
    check(len(re.findall(r"(?m)^hero\d\d +baked +3 +\d+ +\d\.\d\de-\d\d +\d+\.\d KiB +\d+\.\d$", summary)) == 12,
          f"one line a bake in the summary\n{summary}")
    report = json.loads((folder / "report.json").read_text(encoding="utf-8"))
    check(len(report["bakes"]) == 12 and all(bake["dimension"] == 3 and bake["seconds"] > 0 for bake in report["bakes"]),
          "and in the report")
    judge = support.validator(SOURCE, "bake_all_report.schema.json")
    if judge:
        check(judge(report) == [], f"the report holds to its schema {judge(report)}")
        report["bakes"][0]["outcome"] = "fine"
        check(judge(report) != [], "and a spoilt one does not")

    before = {path: (path.stat().st_ino, path.stat().st_mtime_ns) for path in (folder / "out").iterdir()}
    outcomes, result = run(manifest)
    after = {path: (path.stat().st_ino, path.stat().st_mtime_ns) for path in (folder / "out").iterdir()}
    check(done(outcomes, "up to date") == TWELVE and result.returncode == 0 and before == after,
          "the second time does nothing")
    check(TOOL.run("bake-all", manifest).stdout.count("hero03") == 1, "and prints one table")
    check(TOOL.run("bake-all", manifest, "--quiet").stdout == "", "none with --quiet")
    os.utime(folder / "poses/hero03/bent.obj")
    check(done(run(manifest)[0], "up to date") == TWELVE, "a pose is touched: nothing is done")
    support.sheet(folder / "poses/hero03/bent.obj", 0.9)
    check(done(run(manifest)[0], "baked") == ["hero03"], "a pose is changed: its bake alone is done")
    check(done(run(manifest, "--only", "hero05", "--force")[0], "baked") == ["hero05"], "--only and --force: that one")
    (folder / "out/hero07.pliant").unlink()
    dry, _ = run(manifest, "--dry-run")
    check(done(dry, "to be baked") == ["hero07"] and not (folder / "out/hero07.pliant").exists(), "--dry-run bakes nothing")
    check(done(run(manifest)[0], "baked") == ["hero07"], "an asset is gone: it is baked")


def test_killed(folder):
    manifest = manifest_of(folder, TWELVE)
    process = TOOL.start("bake-all", manifest, "--jobs", "2")
    wait_until(lambda: len(stamps(folder)) >= 3 or process.poll() is not None)
    children = children_of(process.pid)
    process.kill()
    process.communicate(timeout=60)
    wait_until(lambda: not any(is_running(child) for child in children), 20)
    finished = stamps(folder)
    check(3 <= len(finished) < 12, f"killed after {len(finished)} of twelve; its children have ended")
    before = {name: (folder / f"out/{name}.pliant").stat().st_ino for name in finished}
    outcomes, result = run(manifest, "--jobs", "2")
    check(result.returncode == 0 and done(outcomes, "up to date") == finished, "what was finished is not done again")
    check(all((folder / f"out/{name}.pliant").stat().st_ino == before[name] for name in finished), "nor written")
    check(done(outcomes, "baked") == sorted(set(TWELVE) - set(finished)), "the rest is")
    left = [path.name for path in (folder / "out").iterdir() if not path.name.endswith((".pliant", ".stamp"))]
    check(left == [], f"nothing else is left there {left}")


def test_interrupted(folder):
    manifest = manifest_of(folder, TWELVE[:6])
    process = TOOL.start("bake-all", manifest, "--json")
    wait_until(lambda: len(stamps(folder)) >= 1 or process.poll() is not None)
    children = children_of(process.pid)
    process.send_signal(signal.SIGINT)
    output, _ = process.communicate(timeout=60)
    outcomes = {bake["name"]: bake["outcome"] for bake in json.loads(output)["bakes"]}
    check(process.returncode == 130, f"interrupted: exit code {process.returncode}")
    check(done(outcomes, "not started") != [] and not any(is_running(child) for child in children),
          f"its children have ended {outcomes}")
    finished = stamps(folder)
    check(done(run(manifest)[0], "up to date") == finished, "and what was finished stays")


def test_terminal_ends(folder):
    """Its summary has nowhere to go then."""
    manifest = manifest_of(folder, TWELVE[:6])
    pid, terminal = pty.fork()
    if pid == 0:
        signal.signal(signal.SIGHUP, signal.SIG_DFL)  # the test may run under nohup
        os.execv(sys.argv[1], [sys.argv[1], "bake-all", str(manifest)])
    wait_until(lambda: len(stamps(folder)) >= 1)
    children = children_of(pid)
    os.close(terminal)
    code = os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1])
    check(code == 130 and not any(is_running(child) for child in children), f"its terminal ends: exit code {code}")


def test_interrupted_early(folder):
    """While stamps are judged, which reads all inputs: 2 GiB of zeros take many seconds."""
    manifest = manifest_of(folder, TWELVE[:1])
    run(manifest)
    with open(folder / "large", "wb") as large:
        large.truncate(2 << 30)
    stamp = folder / "out" / f"{TWELVE[0]}.pliant.stamp"
    content = json.loads(stamp.read_text(encoding="utf-8"))
    content["inputs"].insert(0, {"path": str(folder / "large"), "sha256": "0" * 64})
    write_json(stamp, content)
    process = TOOL.start("bake-all", manifest)
    wait_until(lambda: support.has_open(process, folder / "large") or process.poll() is not None)
    start = time.monotonic()
    process.send_signal(signal.SIGINT)
    process.communicate(timeout=120)
    check(process.returncode == 130 and time.monotonic() - start < 2,
          f"exit code {process.returncode} after {time.monotonic() - start:.1f} s")


def test_failures(folder):
    names = ["a", "b", "c", "d"]
    manifest = manifest_of(folder, names, c={"tolerance": 1e-8})
    (folder / "poses/b/bent.obj").write_text("v 0 0 nan\nf 1 1 1\n", encoding="utf-8")
    outcomes, result = run(manifest)
    check(result.returncode == 1 and outcomes == {"a": "baked", "b": "failed", "c": "misses tolerance", "d": "baked"},
          f"the others are baked {outcomes}")
    error = json.loads(result.stdout)["bakes"][1]["error"]
    check(error["number"] == 2105 and "poses/b/bent.obj:1: vertex 0 has the coordinate" in error["what"], f"why: {error}")
    check("b: error P2105" in result.stderr and "c: error P4405" in result.stderr, "the errors stand under the names")
    poses(folder / "poses/b")
    handler = signal.signal(signal.SIGCHLD, signal.SIG_IGN)  # as CI agents and servers pass it on
    with TOOL.start("bake-all", manifest, "--json") as ignoring:
        bakes = json.loads(ignoring.communicate(timeout=300)[0])["bakes"]
    signal.signal(signal.SIGCHLD, handler)
    outcomes = {bake["name"]: bake["outcome"] for bake in bakes}
    check(outcomes == {"a": "up to date", "b": "baked", "c": "misses tolerance", "d": "up to date"},
          f"where SIGCHLD is ignored: {outcomes}")
    (folder / "out/b.pliant").unlink()
    outcomes, result = run(manifest)
    check(result.returncode == 4 and outcomes["b"] == "baked", f"only a tolerance is missed: exit code {result.returncode}")
    value = json.loads(manifest.read_text(encoding="utf-8"))
    value["bakes"][2]["best_effort"] = True
    write_json(manifest, value)
    for text in ("written all the same", "and the second time"):
        outcomes, result = run(manifest)
        check(result.returncode == 4 and outcomes["c"] == "misses tolerance" and (folder / "out/c.pliant").exists(),
              f"--best-effort: {text}")
        check("mean_error" in json.loads(result.stdout)["bakes"][2], "with its error")
    check("c: started" not in result.stderr, "which bakes nothing")
    value["bakes"][2]["best_effort"] = False
    write_json(manifest, value)
    c = json.loads(run(manifest)[1].stdout)["bakes"][2]
    check(c["outcome"] == "misses tolerance" and not {"file_size", "elements", "mean_error"} & set(c),
          f"the figures of an older asset are not those of a bake that writes none: {c}")
    (folder / "poses/a/bent.obj").write_text("v 0 0 nan\nf 1 1 1\n", encoding="utf-8")
    outcomes, result = run(manifest, "--force", "--fail-fast")
    check(result.returncode == 1 and outcomes["a"] == "failed" and done(outcomes, "not started") == ["b", "c", "d"],
          f"--fail-fast starts no more {outcomes}")


def test_crash(folder):
    """A bake that is killed from outside stands for one that crashes."""
    if not pathlib.Path(f"/proc/{os.getpid()}/task/{os.getpid()}/children").exists():
        print("skipped: a crash; this system does not list children")
        return
    (folder / "poses").mkdir()
    support.sheet(folder / "poses/rest.obj", 0, n=40)
    support.sheet(folder / "poses/bent.obj", 1.5, n=40)
    poses(folder / "poses/small")
    large = {"name": "large", "poses": ["poses/rest.obj", "poses/bent.obj"]}
    small = {"name": "small", "poses": ["poses/small/rest.obj", "poses/small/bent.obj"], **QUICK}
    manifest = write_json(folder / "all.json", {"bakes": [large, small]})
    process = TOOL.start("bake-all", manifest, "--json")
    started = ""
    while "large: started" not in started:
        line = process.stderr.readline()
        if not line:
            break
        started += line
    wait_until(lambda: children_of(process.pid) or process.poll() is not None, 20)
    for child in children_of(process.pid):
        os.kill(child, signal.SIGKILL)
    output, errors = process.communicate(timeout=120)
    bakes = {bake["name"]: bake for bake in json.loads(output)["bakes"]}
    check(process.returncode == 1 and bakes["large"]["outcome"] == "crashed" and bakes["large"]["signal"] == 9,
          f"a crash is told {bakes['large']}")
    check("error P4602: large" in errors and bakes["small"]["outcome"] == "baked", "and harms no other")


def test_young_children(folder):
    """A signal to the whole group, at moments when some bakes do not listen yet: none of them crashed."""
    poses(folder / "poses")
    bakes = [{"name": f"bake_{i}", "poses": ["poses/rest.obj", "poses/bent.obj"], **QUICK} for i in range(12)]
    manifest = write_json(folder / "all.json", {"bakes": bakes})
    for delay in (0.1, 0.15, 0.2, 0.25, 0.3):
        process = TOOL.start("bake-all", manifest, "--force", "--jobs", "4", start_new_session=True)
        time.sleep(delay)
        os.killpg(process.pid, signal.SIGTERM)
        errors = process.communicate(timeout=60)[1]
        check("P4602" not in errors, f"interrupted after {delay} s, no bake crashed: {errors}")


def is_baking(pid):
    try:
        return b"--dry-run" not in pathlib.Path(f"/proc/{pid}/cmdline").read_bytes()
    except OSError:
        return False


def test_orphans(folder):
    """A bake that would take a minute ends with its parent, though nobody tells it and it writes nothing."""
    (folder / "poses").mkdir()
    support.sheet(folder / "poses/rest.obj", 0, n=40)
    support.sheet(folder / "poses/bent.obj", 1.5, n=40)
    manifest = write_json(folder / "all.json", {"bakes": [{"name": "large", "poses": ["poses/rest.obj", "poses/bent.obj"]}]})
    process = TOOL.start("bake-all", manifest, "--quiet")
    wait_until(lambda: any(map(is_baking, children_of(process.pid))) or process.poll() is not None, 60)
    children = children_of(process.pid)
    process.kill()
    process.wait(timeout=60)
    end = time.monotonic() + 10
    while any(map(is_running, children)) and time.monotonic() < end:
        time.sleep(0.05)
    left = [child for child in children if is_running(child)]
    check(left == [], f"killed: {len(children)} bakes end with it")
    for child in left:
        os.kill(child, signal.SIGKILL)


def test_memory(folder):
    names = ["a", "b", "c"]
    manifest = manifest_of(folder, names)
    outcomes, result = run(manifest, "--memory", "100KiB")
    check(result.returncode == 1 and done(outcomes, "too large") == names and "error P4603: a" in result.stderr,
          f"no memory for one {outcomes}")
    dry = json.loads(TOOL.run("bake-all", manifest, "--dry-run", "--json").stdout)
    largest = max(bake["estimate"]["memory"] for bake in dry["bakes"])
    outcomes, result = run(manifest, "--jobs", "3", "--memory", f"{int(1.5 * largest)}B")
    steps = re.findall(r"(?m)^pliant bake-all: (?:(\w): started|\[\d/3\] (\w): baked)", result.stderr)
    check(done(outcomes, "baked") == names and [a + b for a, b in steps] == ["a", "a", "b", "b", "c", "c"],
          f"memory for one: one after the other {steps}")
    together, result = run(manifest, "--jobs", "3", "--force")
    steps = re.findall(r"(?m)^pliant bake-all: (?:(\w): started|\[\d/3\] (\w): baked)", result.stderr)
    check(done(together, "baked") == names and [a for a, b in steps[:3]] == names, f"memory for all: together {steps}")
    write_gltf(folder / "hero.gltf", folder)
    dry_run = ["bake", folder / "hero.gltf", "-o", folder / "hero.pliant", "--dry-run", "--json"]
    without = json.loads(TOOL.run(*dry_run).stdout)["estimate"]
    with (folder / "skin.png").open("ab") as image:
        image.write(bytes(8 << 20))
    estimate = json.loads(TOOL.run(*dry_run).stdout)["estimate"]
    check(estimate["memory"] - without["memory"] == 5 * (8 << 20), f"images take memory {without} {estimate}")


def test_configurations(folder):
    """Defaults, then the configuration that a bake names, then the bake itself;
    the configuration's paths are its own folder's."""
    poses(folder / "deep/poses")
    write_json(folder / "deep/troll.json", {"poses": ["poses/rest.obj", "poses/bent.obj"], "seed": 2, "dim": 4})
    manifest = write_json(folder / "all.json", {"defaults": {**QUICK, "seed": 1},
                                                "bakes": [{"name": "troll", "config": "deep/troll.json", "dim": 2}]})
    result = TOOL.run("bake-all", "all.json", "-q", cwd=folder)
    certificate = json.loads(TOOL.run("info", "--json", folder / "troll.pliant").stdout)["certificate"]
    check(result.returncode == 0 and certificate["seed"] == 2 and certificate["subspace"]["dimension"] == 2,
          f"the later beat the earlier {manifest.name}")


with tempfile.TemporaryDirectory(prefix="pliant-bake-all-") as name:
    for number, test in enumerate((test_twelve, test_killed, test_interrupted, test_terminal_ends, test_interrupted_early,
                                   test_failures, test_crash, test_young_children, test_orphans, test_memory,
                                   test_configurations)):
        place = pathlib.Path(name) / str(number)
        place.mkdir()
        test(place)
support.finish()
