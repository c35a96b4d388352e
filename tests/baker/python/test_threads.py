"""Long work leaves the interpreter to others, and ends when it is told to."""
import os
import signal
import subprocess
import sys
import threading
import time
import unittest
from pathlib import Path

import numpy as np
import pliant
import shapes

QUICK = {"dim": 3, "elements": 18, "check_samples": 2, "fresh_samples": 1}
POSES, FACES = shapes.tubes()
# Some 2500 vertices in four poses: minutes of work.
LONG = shapes.tubes((0.0, 1.0, -1.0, 1.8), rings=100, sides=25)

# Bakes until it is stopped. Says when a bake has begun, and how long it took from the signal to the exception.
CHILD = """
import os, signal, sys, threading, time
sys.path.insert(0, sys.argv[1])
import pliant, shapes
poses, faces = shapes.tubes((0.0, 1.0, -1.0, 1.8), rings=100, sides=25)
first = threading.Thread(target=int) # with the first thread ThreadSanitizer starts one of its own
first.start()
first.join()
told, before = set(), len(os.listdir('/proc/self/task'))
def progress(stage, done, total):
    if stage not in told: print(stage, flush=True)
    told.add(stage)
try:
    pliant.bake(poses, faces, progress=progress)
except KeyboardInterrupt:
    print('interrupted at', time.time(), flush=True)
# A thread that was joined stays listed until the kernel has taken it away; one that still works does so for minutes.
for _ in range(200):
    if len(os.listdir('/proc/self/task')) > before: time.sleep(0.01)
print('threads', len(os.listdir('/proc/self/task')) - before, flush=True)
small = shapes.tubes()
print('after', len(pliant.bake(*small, dim=3, elements=18, check_samples=2, fresh_samples=1)), flush=True)
"""

# The main thread ends while a daemon thread works.
DAEMON = """
import atexit, queue, sys, threading, time
atexit.register(lambda: sys.argv[2] == "finish" and finish())
sys.path.insert(0, sys.argv[1])
import numpy as np, pliant, shapes
poses, faces = shapes.tubes()
asset, energy = pliant.bake(poses, faces, dim=3, elements=18, check_samples=2, fresh_samples=1), pliant.energy(poses, faces)
def blend(): asset.blend([[1, 0]] * 500)
def hessian(): energy.hessian(poses[0])
def bake(): pliant.bake(poses, faces)
def listen(): pliant.bake(poses, faces, progress=lambda *_: time.sleep(0.01))
def refuse():
    try: asset.blend([-1, 0])
    except pliant.Error: pass
def loop():
    while True: globals()[sys.argv[2]]()
def finish(jobs=queue.Queue()):
    def take():
        while jobs.get(): pliant.average(poses, faces, [1, 1]), jobs.task_done()
    for _ in range(20): jobs.put(1)
    threading.Thread(target=take, daemon=True).start()
    jobs.join()
if sys.argv[2] == "finish": sys.exit()
threading.Thread(target=loop, daemon=True).start()
time.sleep(0.3)
"""


class Child:
    """A process that bakes, up to a stage."""

    def __init__(self, stage, **environment):
        self.process = subprocess.Popen([sys.executable, "-c", CHILD, str(Path(__file__).parent)], stdout=subprocess.PIPE,
                                        stderr=subprocess.PIPE, text=True, env={**os.environ, **environment})
        for line in self.process.stdout:
            if line.strip() == stage:
                return
        raise AssertionError(self.process.communicate()[1])


class Interrupting(unittest.TestCase):
    # A second is what is promised on an idle machine, and looked at there; here others may work, so a hang is what fails.
    def interrupt(self, stage):
        child = Child(stage)
        time.sleep(0.3)
        sent = time.time()
        child.process.send_signal(signal.SIGINT)
        out, err = child.process.communicate(timeout=120)
        words = out.split()
        self.assertIn("interrupted", words, err)
        delay = float(words[words.index("at") + 1]) - sent
        print(f"{stage}: KeyboardInterrupt {delay:.2f} s after SIGINT")
        self.assertLess(delay, 20)
        self.assertLessEqual(int(words[words.index("threads") + 1]), 0, "the work goes on")
        self.assertIn("after", words)  # the next bake is as good as any
        self.assertEqual(child.process.returncode, 0)

    def test_ctrl_c_in_the_mean(self):
        self.interrupt("mean")

    def test_ctrl_c_in_averages_on_threads(self):
        self.interrupt("averages")

    # Without numpy's threads: they do not block SIGTERM, and METIS has its own handler there for moments (README,
    # "SIGTERM").
    def test_termination(self):
        child = Child("mean", OPENBLAS_NUM_THREADS="1")
        child.process.send_signal(signal.SIGTERM)
        child.process.communicate(timeout=120)
        self.assertEqual(child.process.returncode, -signal.SIGTERM)

    def test_handler_of_ones_own(self):
        class Stop(Exception):
            pass

        def handle(number, frame):
            raise Stop

        old = signal.signal(signal.SIGUSR1, handle)
        timer = threading.Timer(0.5, os.kill, (os.getpid(), signal.SIGUSR1))
        timer.start()
        try:
            with self.assertRaises(Stop):
                pliant.bake(*LONG)
        finally:
            timer.join()
            signal.signal(signal.SIGUSR1, old)

    def test_exception_of_progress(self):
        def progress(stage, done, total):
            raise LookupError(stage)

        with self.assertRaises(LookupError):
            pliant.bake(*LONG, progress=progress)
        with self.assertRaises(LookupError):
            pliant.average(*LONG, [1, 1, 1, 1], progress=progress)

    # It would wait for itself.
    def test_work_within_progress(self):
        def progress(stage, done, total):
            pliant.average(POSES, FACES, [1, 1])

        with self.assertRaisesRegex(RuntimeError, "at work already"):
            pliant.bake(POSES, FACES, progress=progress, **QUICK)
        self.assertGreater(len(pliant.bake(POSES, FACES, **QUICK)), 0)


class Ending(unittest.TestCase):
    def test_daemon_threads(self):
        for work in ("blend", "hessian", "bake", "listen", "refuse", "finish"):
            with self.subTest(work):
                done = subprocess.run([sys.executable, "-c", DAEMON, str(Path(__file__).parent), work], capture_output=True,
                                      text=True, check=False, timeout=120)
                self.assertEqual(done.returncode, 0, done.stderr)


class Sharing(unittest.TestCase):
    # Else a child that is forked meanwhile would wait for the import.
    def test_the_hessian_imports_nothing(self):
        class Finder:
            def find_spec(self, name, path=None, target=None):
                found.append(name)

        energy, found = pliant.energy(POSES, FACES), []
        sys.meta_path.insert(0, Finder())
        try:
            energy.hessian(POSES[0])
        finally:
            del sys.meta_path[0]
        self.assertEqual(found, [])

    @unittest.skipIf("libtsan" in os.environ.get("LD_PRELOAD", ""), "ThreadSanitizer takes no threads in a forked child")
    def test_children_forked_while_a_thread_works(self):
        def loop():
            while not is_over.is_set():
                energy.hessian(LONG[0][0])

        energy, is_over = pliant.energy(*LONG), threading.Event()
        thread = threading.Thread(target=loop)
        thread.start()
        try:
            for _ in range(4):
                time.sleep(0.1)
                child = os.fork()
                if child == 0:
                    try:
                        signal.alarm(60)
                        energy.hessian(LONG[0][0])
                        os._exit(0)
                    finally:
                        os._exit(1)
                self.assertEqual(os.waitpid(child, 0)[1], 0)
        finally:
            is_over.set()
            thread.join()

    @unittest.skipIf("libtsan" in os.environ.get("LD_PRELOAD", ""), "ThreadSanitizer takes no threads in a forked child")
    def test_child_forked_during_a_bake(self):
        def progress(stage, done, total):
            if stage != "check" or children:
                return
            children.append(os.fork())
            if children[0] == 0:
                try:
                    pliant.average(POSES, FACES, [1, 1])
                    os._exit(0)
                finally:
                    os._exit(1)

        children = []
        pliant.bake(POSES, FACES, progress=progress, **QUICK)
        self.assertEqual(os.waitpid(children[0], 0)[1], 0)

    @unittest.skipIf("libtsan" in os.environ.get("LD_PRELOAD", ""), "ThreadSanitizer takes no threads in a forked child")
    def test_child_forked_during_a_bake_that_leaves_the_callback(self):
        def bake_again():
            pliant.bake(POSES, FACES, **QUICK)

        # The work may have ended before its last steps are told: then the child has its result, too.
        for ends, expected in ((lambda: None, (RuntimeError, None)), (bake_again, (RuntimeError, None)),
                               (sys.exit, (SystemExit,))):
            def progress(stage, done, total):
                if stage == "check" and not children:
                    children.append(os.fork())
                    if children[0] == 0:
                        signal.alarm(60)
                        ends()

            parent, children, outcome = os.getpid(), [], None
            try:
                pliant.bake(POSES, FACES, progress=progress, **QUICK)
            except BaseException as error:
                outcome = type(error)
            if os.getpid() != parent:
                os._exit(outcome not in expected)
            self.assertIsNone(outcome)
            self.assertEqual(os.waitpid(children[0], 0)[1], 0)

    def test_others_work_during_a_bake(self):
        counts, is_over = [0], threading.Event()

        def count():
            while not is_over.is_set():
                counts[0] += 1
                time.sleep(0)

        during_bakes = 0
        counter = threading.Thread(target=count)
        counter.start()
        try:
            for _ in range(100):  # one bake is so short that the system may not let the other thread run at all
                seen = []
                pliant.bake(POSES, FACES, progress=lambda *_: seen.append(counts[0]), **QUICK)
                during_bakes += seen[-1] - seen[0]
                if during_bakes > 100:
                    break
        finally:
            is_over.set()
            counter.join()
        self.assertGreater(during_bakes, 100, "the other thread stood still")

    def test_bakes_take_turns_and_blends_do_not_wait(self):
        asset = pliant.bake(POSES, FACES, **QUICK)
        expected, made, errors = bytes(asset), [], []

        def bake():
            try:
                made.append(bytes(pliant.bake(POSES, FACES, threads=1 + len(made), **QUICK)))
            except BaseException as error:
                errors.append(error)

        bakers = [threading.Thread(target=bake) for _ in range(3)]
        for baker in bakers:
            baker.start()
        blends = 0
        while any(baker.is_alive() for baker in bakers):
            asset.blend([1, 1])
            blends += 1
        for baker in bakers:
            baker.join()
        self.assertEqual(errors, [])
        self.assertEqual(made, [expected] * 3)
        self.assertGreater(blends, 10)

    def test_progress_is_told_in_order_on_the_calling_thread(self):
        steps = []
        pliant.bake(POSES, FACES, progress=lambda *step: steps.append((*step, threading.current_thread())), **QUICK)
        self.assertTrue(all(0 <= done <= 1 and total == 1 for _, done, total, _ in steps))
        self.assertEqual([done for _, done, *_ in steps], sorted(done for _, done, *_ in steps))
        self.assertEqual(steps[-1][1], 1)
        self.assertEqual({thread for *_, thread in steps}, {threading.current_thread()})
        stages = list(dict.fromkeys(stage for stage, *_ in steps))
        self.assertEqual((stages[0], stages[-1]), ("poses", "check"))


if __name__ == "__main__":
    unittest.main(verbosity=2)
