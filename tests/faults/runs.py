"""Runs of the tool under inject.c, and what is demanded of each."""
import contextlib
import errno
import os
import pathlib
import re
import shutil
import signal
import struct
import subprocess
import tempfile
import time
from dataclasses import dataclass

from jobs import FILES, OLD

KINDS = ("alloc", "write", "message", "fsync", "rename", "open", "read", "map", "thread", "unlink", "stat", "lock", "mode",
         "process", "change")
KILL, HALF, HALF_AND_KILL = 0, -1, -2  # in place of an errno (inject.c)
PATIENCE = 60
BLAS = {"OPENBLAS_NUM_THREADS": "1", "OPENBLAS_CORETYPE": "Haswell"}  # else the tool starts itself again first
# One of these is said.
NUMBERS = {"write": {"4005"}, "fsync": {"4005"}, "rename": {"4005"}, "mode": {"4005"}, "lock": {"4002"},
           "open": {"2001", "4002", "4901"}, "read": {"2001", "4901", "4605"}, "thread": {"4901"},
           "process": {"4601", "4605"}, "alloc": {"4901", "4301", "2001", "4002", "4005", "4601"}, "map": {"4306", "2008"}}
TEMPORARY = re.compile(r"\..*\.pliant-tmp-[0-9a-f]{16}$")


@dataclass
class Fault:
    kind: str
    error: int  # errno, or KILL ...
    is_later: bool = False  # all later calls fail, too

    def name(self):
        special = {KILL: "kill", HALF: "half", HALF_AND_KILL: "half, kill"}
        return f"{self.kind} {special.get(self.error) or os.strerror(self.error)}{', all later' if self.is_later else ''}"


@dataclass
class End:
    code: int
    output: bytes
    messages: str
    counts: dict


class Place:
    """A folder with the inputs of a job, and its old outputs if it has some."""

    def __init__(self, job, asset, has_old):
        self.base = pathlib.Path(tempfile.mkdtemp(prefix="pliant_faults_"))
        self.folder, self.kept = self.base / "run", self.base / "kept"
        self.folder.mkdir()
        self.kept.mkdir()
        self.initial = {name: asset if name == "a.pliant" else FILES[name] for name in job.inputs}
        if has_old:
            self.initial.update({name: OLD for name in job.outputs})
        for name, content in self.initial.items():
            (self.kept / name).write_bytes(content)
        self.reset()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        shutil.rmtree(self.base)

    def contents(self):
        return {entry.name: pathlib.Path(entry.path).read_bytes() for entry in os.scandir(self.folder)}

    def reset(self):
        """The very same files: a program that forks has taken note of their inodes."""
        now = self.contents()
        for name in now.keys() - self.initial.keys():
            (self.folder / name).unlink()
        for name, content in self.initial.items():
            if name not in now or not (self.folder / name).samefile(self.kept / name):
                (self.folder / name).unlink(missing_ok=True)
                os.link(self.kept / name, self.folder / name)
            if (self.kept / name).stat().st_size != len(content) or now.get(name) not in (content, None):
                (self.kept / name).write_bytes(content)


def normal(name, content):
    """Without times, which differ from run to run."""
    if name.endswith((".json", ".stamp", ".html", "output")):
        return re.sub(rb"[0-9.]+(e[+-]?[0-9]+)?", b"#", content)
    return content


class Runner:
    def __init__(self, tool, library, asset=b""):
        self.tool, self.library, self.asset = tool, library, asset

    def environment(self, place, fault, number, **more):
        settings = {"LD_PRELOAD": self.library, "FAULTS_COUNTS": str(place.base / "counts"), **BLAS, **more}
        if fault:
            settings.update(FAULTS_KIND=fault.kind, FAULTS_AT=str(number), FAULTS_LATER=str(int(fault.is_later)),
                            FAULTS_ERROR=str(fault.error))
        (place.base / "counts").write_bytes(bytes(8 * (len(KINDS) + 1)))
        return {**os.environ, **settings}

    def run(self, job, place, fault=None, number=0, **more):
        """The job in its folder; its processes are gone when this returns."""
        environment = self.environment(place, fault, number, **more)
        with open(place.base / "output", "wb") as output, open(place.base / "messages", "wb") as messages:
            process = subprocess.Popen([self.tool, *job.words], cwd=place.folder, env=environment, stdin=subprocess.DEVNULL,
                                       stdout=output, stderr=messages, start_new_session=True)
            code = wait_for_all(process)
        return self.end(place, code)

    @staticmethod
    def end(place, code):
        counts = struct.unpack(f"{len(KINDS) + 1}Q", (place.base / "counts").read_bytes())
        return End(code, (place.base / "output").read_bytes(),
                   (place.base / "messages").read_text(errors="replace"), dict(zip((*KINDS, "faults"), counts)))


def wait_for_all(process):
    """The exit code, once all processes of the session are gone; None if they hang."""
    deadline = time.monotonic() + PATIENCE
    code = None
    with contextlib.suppress(subprocess.TimeoutExpired):
        code = process.wait(PATIENCE)
    while time.monotonic() < deadline:
        try:
            os.killpg(process.pid, 0)
        except ProcessLookupError:
            return code
        time.sleep(0.001)
    os.killpg(process.pid, signal.SIGKILL)
    process.wait()
    return None


class Judge:
    """Knows what the undisturbed job does."""

    def __init__(self, runner, job):
        self.job = job
        with Place(job, runner.asset, False) as place:
            self.end = runner.run(job, place)
            self.new = {name: place.contents().get(name) for name in job.outputs}
        if self.end.code != job.code or None in self.new.values():
            raise SystemExit(f"{job.name}: the undisturbed run fails: {self.end}")

    def is_new(self, name, content):
        return content is not None and normal(name, content) == normal(name, self.new[name])

    def faults_of_files(self, place, contents, may_leave=False):
        """What is wrong with the files, whatever the exit code."""
        wrong = [f"{name} is neither old nor new" for name in self.job.outputs
                 if contents.get(name) != place.initial.get(name) and not self.is_new(name, contents.get(name))]
        wrong += [f"the input {name} has changed" for name in self.job.inputs if name not in self.job.outputs
                  and contents.get(name) != place.initial[name]]
        others = contents.keys() - place.initial.keys() - set(self.job.outputs)
        return wrong + [f"leaves {'a temporary file' if TEMPORARY.match(name) else name}" for name in others
                        if not (may_leave and TEMPORARY.match(name))]

    def all_new(self, contents):
        return all(self.is_new(name, contents.get(name)) for name in self.job.outputs)

    def is_cut(self, output):
        if self.job.name == "bake_all":  # whose reasons depend on what it could read
            return output.count(b"\n") != self.end.output.count(b"\n")
        return normal("output", output) != normal("output", self.end.output)

    def faults(self, place, end, fault):
        """What is wrong with a run under a fault."""
        contents = place.contents()
        if end.code is None or end.code == -signal.SIGALRM:
            return ["hangs"]
        wrong = self.faults_of_files(place, contents, may_leave=fault.kind == "unlink")
        numbers = re.findall(r"error P(\d{4}): ", end.messages)
        allowed = {self.job.code, 1} | ({3} if fault.kind in ("open", "read", "stat") or "2008" in numbers else set())
        if end.code not in allowed:
            wrong.append(f"exit code {end.code}")
        if end.code == 0 and not self.all_new(contents):
            wrong.append("exit code 0 without the new output")
        if end.code == 0 and self.is_cut(end.output):
            wrong.append("exit code 0 without its standard output")
        if end.code != self.job.code and is_harmless(fault):
            wrong.append(f"exit code {end.code}, though nothing was lost")
        if end.code != 0 and fault.kind != "message" and not numbers:
            wrong.append("fails without a message")
        if end.code not in (0, self.job.code) and fault.kind in NUMBERS and not NUMBERS[fault.kind] & set(numbers):
            wrong.append(f"says {', '.join('P' + number for number in numbers) or 'no number'}")
        if "4902" in numbers:
            wrong.append("P4902, unexpected: " + end.messages.split("P4902: ")[1].split("\n")[0])
        return wrong


def is_harmless(fault):
    return not fault.is_later and fault.error in (HALF, errno.EINTR)
