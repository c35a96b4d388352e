"""pliant.batch on two local workers: twelve characters of which one worker is killed, failures, a client of one's own, no
Dask at all. PLIANT_TOOL names the tool. Skips where Dask could not be installed."""
import importlib.util
import json
import logging
import os
import signal
import subprocess
import sys
import tempfile
import threading
import time
import types
import unittest
from pathlib import Path

import pliant.batch
from pliant.batch import _farm, _plan, _worker

TOOL, SOURCE = os.environ["PLIANT_TOOL"], Path(os.environ["PLIANT_SOURCE"])
sys.path.insert(0, str(SOURCE / "tests/baker/pipeline"))
import support  # noqa: E402  the characters of the tests of bake-all

HAS_DASK = importlib.util.find_spec("distributed") is not None
IS_LINUX = sys.platform == "linux"
SLOW = {"dim": 12, "elements": 60, "check_samples": 60}  # two seconds instead of a third of one
TWELVE = [f"hero{i:02d}" for i in range(12)]


def manifest_of(folder, names, **more):
    for i, name in enumerate(names):
        support.poses(folder / "poses" / name, bend=0.6 + 0.05 * i, turn=0.03 * i)
    bakes = [{"name": name, "poses": [f"poses/{name}/rest.obj", f"poses/{name}/bent.obj"], "output": f"out/{name}.pliant",
              **more.get(name, {})}
             for name in names]
    (folder / "out").mkdir()
    return support.write_json(folder / "all.json", {"defaults": support.QUICK, "bakes": bakes})


def processes():
    """(id, parent, session, command line) of all that run."""
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            words = [os.fsdecode(word) for word in (folder / "cmdline").read_bytes().split(b"\0")]
            state, parent, _, session = (folder / "stat").read_text().rsplit(")", 1)[1].split()[:4]
        except OSError:
            continue
        if state != "Z":
            yield int(folder.name), int(parent), int(session), words


def running_with(manifest):
    """(id, parent, name of the bake) of the bakes of a manifest."""
    return [(pid, parent, words[words.index("--only") + 1]) for pid, parent, _, words in processes()
            if str(manifest) in words and "bake-all" in words and "--only" in words]


def processes_of_session(leader):
    return [pid for pid, _, session, _ in processes() if session == leader]


def wait_until(condition, seconds=30):
    end = time.monotonic() + seconds
    while not condition():
        if time.monotonic() > end:
            return False
        time.sleep(0.005)
    return True


class Killer(threading.Thread):
    """Kills the worker of a bake in the middle of the bake, and sees whether the bake ends with it."""

    def __init__(self, manifest, name):
        super().__init__(daemon=True)
        self.manifest, self.asset = manifest, manifest.parent / f"out/{name}.pliant"
        self.worker = self.finished_before = self.has_ended = self.is_written = None

    def bakes(self):
        """(id, id of bake-all) of the bake itself, not of its plan."""
        return [(pid, parent) for pid, parent, _, words in processes()
                if "bake" in words and "--dry-run" not in words and any(word.endswith(str(self.asset)) for word in words)]

    def run(self):
        if not wait_until(self.bakes):
            return
        bake, parent = self.bakes()[0]
        (self.worker,) = [worker for pid, worker, _ in running_with(self.manifest) if pid == parent]
        os.kill(self.worker, signal.SIGKILL)
        self.finished_before = len(list(self.asset.parent.glob("*.stamp")))
        self.has_ended = wait_until(lambda: not {bake, parent} & {pid for pid, *_ in processes()}, 60)
        self.is_written = self.asset.exists()


class Folder(unittest.TestCase):
    def setUp(self):
        holder = tempfile.TemporaryDirectory(prefix="pliant-batch-")
        self.addCleanup(holder.cleanup)
        self.folder = Path(holder.name)

    def outcomes(self, summary):
        return {bake["name"]: bake["outcome"] for bake in summary.bakes}

    def names_of_outputs(self):
        return sorted(path.name for path in (self.folder / "out").iterdir())

    def assets(self):
        return {path.name: path.read_bytes() for path in (self.folder / "out").glob("*.pliant")}

    def large_and_small(self):
        """A manifest of a bake that takes many seconds, and one that does not."""
        support.poses(self.folder / "poses/a")
        support.sheet(self.folder / "poses/rest.obj", 0, n=40)
        support.sheet(self.folder / "poses/bent.obj", 1.5, n=40)
        large = {"name": "large", "poses": ["poses/rest.obj", "poses/bent.obj"]}
        small = {"name": "a", "poses": ["poses/a/rest.obj", "poses/a/bent.obj"], **support.QUICK}
        return support.write_json(self.folder / "all.json", {"bakes": [large, small]})


@unittest.skipUnless(HAS_DASK, "Dask is not installed")
class OnTwoWorkers(Folder):
    @unittest.skipUnless(IS_LINUX, "finds the workers in /proc")
    def test_one_is_killed(self):
        manifest = manifest_of(self.folder, TWELVE, hero03=SLOW)
        killer, seen, start = Killer(manifest, "hero03"), [], time.monotonic()
        killer.start()
        summary = pliant.batch.run(manifest, workers=2, tool=TOOL,
                                   progress=lambda record, *counts: seen.append((record["name"], *counts)))
        killer.join()
        print(f"worker {killer.worker} was killed after {killer.finished_before} of twelve; "
              f"all in {time.monotonic() - start:.1f} s")
        self.assertIsNotNone(killer.worker)
        self.assertLess(killer.finished_before, 11)
        self.assertEqual((killer.has_ended, killer.is_written), (True, False),
                         "the bake of the killed worker went on without it")
        self.assertEqual(set(self.outcomes(summary).values()), {"baked"})
        self.assertEqual(([bake["name"] for bake in summary.bakes], sorted(name for name, *_ in seen)), (TWELVE, TWELVE))
        self.assertEqual([counts for _, *counts in seen], [[done, 12] for done in range(1, 13)])
        self.assertEqual(self.names_of_outputs(),
                         sorted([f"{n}.pliant" for n in TWELVE] + [f"{n}.pliant.stamp" for n in TWELVE]))
        self.assertEqual(summary.exit_code, 0)
        self.assertEqual(running_with(manifest), [])
        self.check_same_as_bake_all(manifest, summary)
        self.check_nothing_to_do(manifest)

    def check_same_as_bake_all(self, manifest, summary):
        before = self.assets()
        done = support.Tool(TOOL).run("bake-all", manifest, "--json")
        self.assertEqual({bake["outcome"] for bake in json.loads(done.stdout)["bakes"]}, {"up to date"},
                         "bake-all goes on from there")
        done = support.Tool(TOOL).run("bake-all", manifest, "--force", "--jobs", "2", "--json")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(before, self.assets())

        made, told = summary.as_dict(), json.loads(done.stdout)
        times = {"seconds", "peak_memory"}  # the worker that knew them may be the one that was killed
        self.assertEqual({key: made[key] for key in made if key not in ("seconds", "bakes")},
                         {key: told[key] for key in told if key not in ("seconds", "bakes")})
        for bake, other in zip(made["bakes"], told["bakes"]):
            self.assertEqual({key: bake[key] for key in bake if key not in times | {"reason"}},
                             {key: other[key] for key in other if key not in times | {"reason"}})
            self.assertLessEqual(set(bake), set(other))
        self.assertGreaterEqual(sum(bake.get("peak_memory", 0) > 1e6 for bake in made["bakes"]), 9)
        self.assertRegex(str(summary), r"(?m)^hero11 +baked +3 +\d+ +\d\.\d\de-\d\d +\d+\.\d KiB +\d+\.\d$")
        self.assertEqual(len(str(summary).splitlines()), 13)

    def check_nothing_to_do(self, manifest):
        before = {path: (path.stat().st_ino, path.stat().st_mtime_ns) for path in (self.folder / "out").iterdir()}
        seen = []
        summary = pliant.batch.run(manifest, workers=2, tool=TOOL, progress=lambda *_: seen.append(_))
        self.assertEqual(set(self.outcomes(summary).values()), {"up to date"})
        self.assertEqual(seen, [])
        self.assertEqual(before,
                         {path: (path.stat().st_ino, path.stat().st_mtime_ns) for path in (self.folder / "out").iterdir()})

    @unittest.skipUnless(IS_LINUX, "finds the bakes in /proc")
    def test_ctrl_c(self):
        manifest = self.large_and_small()
        words = [sys.executable, "-m", "pliant.batch", manifest, "--workers", "2", "--tool", TOOL]
        process = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True)
        self.assertTrue(wait_until(lambda: (self.folder / "a.pliant.stamp").exists() or process.poll() is not None))
        self.assertNotEqual(running_with(manifest), [])
        os.killpg(process.pid, signal.SIGINT)  # as a terminal does
        output, errors = process.communicate(timeout=60)
        self.assertEqual((process.returncode, output), (130, ""), errors)
        self.assertIn("what was finished stays", errors)
        self.assertNotIn("Traceback", errors)
        self.assertTrue(wait_until(lambda: not processes_of_session(process.pid), 10), "processes are left")
        self.assertFalse((self.folder / "large.pliant").exists())


@unittest.skipUnless(HAS_DASK, "Dask is not installed")
class WithClient(Folder):
    """A cluster of the user's, with two workers that have MEMORY."""

    @classmethod
    def setUpClass(cls):
        import distributed
        cls.cluster = distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address="127.0.0.1:0",
                                               resources={"MEMORY": 1e9})
        cls.client = distributed.Client(cls.cluster)

    @classmethod
    def tearDownClass(cls):
        cls.client.close()
        cls.cluster.close()

    def run_here(self, manifest, **options):
        return pliant.batch.run(manifest, client=self.client, **{"workers": 2, "tool": TOOL, **options})

    def test_failures_harm_no_other(self):
        manifest = manifest_of(self.folder, ["a", "b", "c", "d"], c={"tolerance": 1e-8})
        (self.folder / "poses/b/bent.obj").write_text("v 0 0 nan\nf 1 1 1\n")
        with self.assertLogs("pliant.batch", "WARNING") as log:
            summary = self.run_here(manifest)
        self.assertEqual(self.outcomes(summary), {"a": "baked", "b": "failed", "c": "misses tolerance", "d": "baked"})
        self.assertEqual(summary.exit_code, 1)
        self.assertIn("error P2105", summary.messages["b"])
        self.assertIn("error P4405", summary.messages["c"])
        self.assertEqual(set(summary.messages), {"b", "c"})
        self.assertTrue(any("b: error P2105" in line for line in log.output), log.output)
        support.poses(self.folder / "poses/b")
        summary = self.run_here(manifest, only=["b"])
        self.assertEqual((self.outcomes(summary), summary.exit_code), ({"b": "baked"}, 0))
        self.assertEqual(self.outcomes(self.run_here(manifest, only="d", force=True)), {"d": "baked"})

    def test_a_bake_too_large(self):
        manifest = manifest_of(self.folder, ["a"])
        with self.assertLogs("pliant.batch", "WARNING"):
            summary = pliant.batch.run(manifest, tool=TOOL, memory=1e5)
        self.assertEqual(self.outcomes(summary), {"a": "too large"})
        self.assertIn("P4603", summary.messages["a"])

    @unittest.skipUnless(IS_LINUX, "finds the bakes in /proc")
    def test_exception_of_progress_ends_all(self):
        manifest = self.large_and_small()

        def progress(record, done, total):
            raise LookupError(record["name"])

        with self.assertRaisesRegex(LookupError, "^a$"):
            self.run_here(manifest, progress=progress)
        self.assertTrue(wait_until(lambda: not running_with(manifest)), "a bake goes on")
        self.assertFalse((self.folder / "large.pliant").exists())

    def test_a_bake_that_could_not_tell(self):
        manifest = manifest_of(self.folder, ["a", "b"])
        tool = self.folder / "pliant"  # "b" is baked, and then its first process is killed all the same
        tool.write_text(f'#!/bin/sh\ncase "$*" in *--dry-run*) ;; *"--only b"*) '
                        f'mkdir {self.folder}/once 2>/dev/null && {TOOL} "$@" && kill -9 $$ ;; '
                        f'esac\nexec {TOOL} "$@"\n')
        tool.chmod(0o755)
        with self.assertLogs("pliant.batch", "WARNING"):
            summary = self.run_here(manifest, tool=tool)
        self.assertEqual(self.outcomes(summary), {"a": "baked", "b": "baked"})
        self.assertNotIn("seconds", summary.bakes[1])

    def tool_that_ends_once(self, how):
        """The tool, but its first bake of "b" ends so."""
        tool = self.folder / "pliant"
        tool.write_text(f'#!/bin/sh\ncase "$*" in *--dry-run*) ;; *"--only b"*) '
                        f'mkdir {self.folder}/once 2>/dev/null && {how} ;; esac\n'
                        f'exec {TOOL} "$@"\n')
        tool.chmod(0o755)
        return tool

    def test_a_bake_is_killed_from_outside(self):
        manifest = manifest_of(self.folder, ["a", "b"])
        tool = self.tool_that_ends_once("kill -9 $$")
        with self.assertLogs("pliant.batch", "WARNING") as log:
            summary = self.run_here(manifest, tool=tool)
        self.assertEqual(self.outcomes(summary), {"a": "baked", "b": "baked"})
        self.assertIn("b: the tool was killed by signal 9; it is tried again", "".join(log.output))
        (self.folder / "once").rmdir()
        with self.assertLogs("pliant.batch", "WARNING"):
            summary = self.run_here(manifest, tool=tool, force=True, retries=0)
        self.assertEqual(self.outcomes(summary), {"a": "baked", "b": "crashed"})
        self.assertEqual((summary.bakes[1]["signal"], summary.exit_code), (9, 1))

    def test_a_bake_is_interrupted_before_its_plan(self):
        manifest = manifest_of(self.folder, ["a", "b"])
        tool = self.tool_that_ends_once("exit 130")  # as while it judges stamps: without a summary
        with self.assertLogs("pliant.batch", "WARNING") as log:
            summary = self.run_here(manifest, tool=tool)
        self.assertEqual(self.outcomes(summary), {"a": "baked", "b": "baked"})
        self.assertIn("b: the tool was interrupted; it is tried again", "".join(log.output))

    def test_a_manifest_is_refused(self):
        manifest = manifest_of(self.folder, ["hero"])
        with self.assertRaises(pliant.Error) as caught:
            self.run_here(manifest, only=["heroe"])
        self.assertEqual((caught.exception.number, caught.exception.hint), ("P1304", "did you mean hero?"))
        manifest.write_text('{"bakes": []}')
        with self.assertRaises(pliant.Error) as caught:
            self.run_here(manifest)
        self.assertEqual((caught.exception.number, caught.exception.exit_code), ("P2707", 3))

    def test_memory_bounds_what_runs_together(self):
        import distributed
        manifest = manifest_of(self.folder, ["a", "b", "c"])
        dry = json.loads(support.Tool(TOOL).run("bake-all", manifest, "--json", "--dry-run").stdout)
        memory = 1.5 * max(bake["estimate"]["memory"] for bake in dry["bakes"])
        tool, steps = self.folder / "pliant", self.folder / "steps"
        tool.write_text(f'#!/bin/sh\ncase "$*" in *"--only"*) echo start >> {steps}; {TOOL} "$@"; echo end >> {steps} ;; '
                        f'*) exec {TOOL} "$@" ;; esac\n')
        tool.chmod(0o755)
        with distributed.LocalCluster(n_workers=1, threads_per_worker=3, processes=False, dashboard_address="127.0.0.1:0",
                                      resources={"MEMORY": memory}) as cluster, distributed.Client(cluster) as client:
            summary = pliant.batch.run(manifest, client=client, tool=tool)
        self.assertEqual(self.outcomes(summary), dict.fromkeys("abc", "baked"))
        self.assertEqual(steps.read_text().split(), ["start", "end"] * 3)

    def test_workers_that_cannot(self):
        import distributed
        manifest = manifest_of(self.folder, ["a"])
        with self.assertRaisesRegex(RuntimeError, "worker tcp://.*: tool: there is no program /no/such/pliant"):
            self.run_here(manifest, tool="/no/such/pliant")
        with distributed.LocalCluster(n_workers=1, threads_per_worker=1, processes=False,
                                      dashboard_address="127.0.0.1:0") as bare:
            with distributed.Client(bare) as client, self.assertRaisesRegex(
                    RuntimeError, "resource MEMORY.*--resources MEMORY="):
                pliant.batch.run(manifest, client=client, tool=TOOL)
        for wrong in ({"memory": 1e9}, {"workers": 0}, {"retries": -1}, {"only": []}):
            with self.assertRaisesRegex(ValueError, next(iter(wrong))):
                self.run_here(manifest, **wrong)

    def test_files_that_are_not_shared(self):
        manifest = manifest_of(self.folder, ["a"])
        digest, token = _worker.digest_of(str(manifest)), self.folder / "out/token"
        seen = self.client.run(_worker.look_around, TOOL, str(manifest), "0" * 64, [])
        self.assertTrue(all("sees another file as" in place.wrong for place in seen.values()), seen)
        seen = self.client.run(_worker.look_around, TOOL, str(self.folder / "none.json"), digest, [])
        self.assertTrue(all("cannot read the manifest" in place.wrong for place in seen.values()), seen)
        seen = self.client.run(_worker.look_around, TOOL, str(manifest), digest, [str(token)])
        self.assertTrue(all("sees another folder, or none, as" in place.wrong for place in seen.values()), seen)
        token.touch()
        seen = self.client.run(_worker.look_around, TOOL, str(manifest), digest, [str(token)])
        self.assertTrue(all(place.wrong == "" and place.version.startswith("pliant ") and place.memory == 1e9
                            for place in seen.values()), seen)

    def test_command_line(self):
        manifest = manifest_of(self.folder, ["a", "b"])
        words = [sys.executable, "-m", "pliant.batch", manifest, "--scheduler", self.client.scheduler.address, "--workers",
                 "2", "--tool", TOOL]
        done = subprocess.run([*words, "--json"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual([bake["outcome"] for bake in json.loads(done.stdout)["bakes"]], ["baked", "baked"])
        self.assertIn("[2/2] ", done.stderr)
        done = subprocess.run([*words, "--only", "c"], capture_output=True, text=True)
        self.assertEqual((done.returncode, done.stdout), (2, ""))
        self.assertIn("P1304", done.stderr)
        done = subprocess.run([*words, "--memory", "1e400"], capture_output=True, text=True)
        self.assertEqual((done.returncode, done.stdout), (2, ""))
        self.assertNotIn("Traceback", done.stderr)


class WithoutDask(Folder):
    def test_import_error_names_the_remedy(self):
        program = ("import sys\nsys.modules['distributed'] = None\nimport pliant\n"
                   "try:\n    pliant.batch.run('all.json')\nexcept ImportError as error:\n    print(error)\n")
        done = subprocess.run([sys.executable, "-W", "error", "-c", program], capture_output=True, text=True)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertIn("pip install", done.stdout)

    def test_ctrl_c_while_a_result_comes(self):
        """It waits for Dask's call, which would log a traceback else, and is heard after it."""
        class Future:
            status, calls, ended = "finished", 0, 0

            def result(self, timeout):
                self.calls += 1
                if self.calls == 1:
                    raise TimeoutError
                os.kill(os.getpid(), signal.SIGINT)
                time.sleep(0.01)
                self.ended += 1

        future = Future()
        with self.assertRaises(KeyboardInterrupt):
            _farm._result_of(future, TimeoutError)
        self.assertEqual((future.calls, future.ended), (2, 1))
        self.assertIs(signal.getsignal(signal.SIGINT), signal.default_int_handler)

    def test_a_closing_worker_logs_no_closed_connection(self):
        """Its heartbeat may find the connection closed; Dask would log a traceback."""
        worker = types.SimpleNamespace(status=types.SimpleNamespace(name="running"))
        previous = signal.getsignal(signal.SIGINT)
        self.addCleanup(signal.signal, signal.SIGINT, previous)
        log = logging.getLogger("distributed.worker")
        self.addCleanup(setattr, log, "filters", list(log.filters))
        _worker.dask_setup(worker)
        seen = []
        for status, error in [("running", OSError("gone")), ("closing", OSError("gone")), ("closing", ValueError("wrong"))]:
            worker.status.name = status
            with self.assertLogs(log, "ERROR") as heard:
                try:
                    raise error
                except Exception:
                    log.exception(f"{status}: {error}")
                log.error("end")
            seen.append([record.getMessage() for record in heard.records][:-1])
        self.assertEqual(seen, [["running: gone"], [], ["closing: wrong"]])

    def test_messages_by_name(self):
        lines = ("pliant bake-all: a: error P2105: x\npliant bake-all: a:   hint: y\n"
                 "pliant bake-all: error P4603: a: b: too much\n  hint: less\n")
        self.assertEqual(_plan.messages_of(lines, ["a", "a: b"]),
                         {"a": "error P2105: x\n  hint: y", "a: b": "error P4603: too much\n  hint: less"})


if __name__ == "__main__":
    unittest.main(verbosity=2)
