"""Faults injected into the tool: run.py PLIANT INJECT.so [options]. README.md says what is demanded of each run."""
import argparse
import concurrent.futures
import errno
import os
import struct
import subprocess
import sys
import time

import power
from jobs import JOBS
from runs import HALF, HALF_AND_KILL, KILL, End, Fault, Judge, Place, Runner

FAULTS = [
    ("write", (errno.ENOSPC, errno.EIO, errno.EINTR, HALF), errno.ENOSPC),
    ("message", (errno.EIO,), errno.EIO),
    ("fsync", (errno.EIO, errno.EINVAL), errno.EIO),
    ("rename", (errno.EIO, errno.EACCES), errno.EIO),
    ("open", (errno.EMFILE, errno.EACCES), errno.EMFILE),
    ("read", (errno.EIO, errno.EINTR), errno.EIO),
    ("map", (errno.ENOMEM,), errno.ENOMEM),
    ("thread", (errno.EAGAIN,), errno.EAGAIN),
    ("unlink", (errno.EIO,), errno.EIO),
    ("stat", (errno.EIO,), errno.EIO),
    ("lock", (errno.ENOLCK, errno.EWOULDBLOCK), errno.EWOULDBLOCK),
    ("mode", (errno.EPERM,), errno.EPERM),
    ("process", (errno.EAGAIN,), errno.EMFILE),
]


class Findings:
    """What went wrong, by job, fault and text; and how many runs there were."""

    def __init__(self):
        self.runs = 0
        self.wrong = {}

    def add(self, where, number, texts, messages=""):
        self.runs += 1
        for text in texts:
            self.wrong.setdefault((where, text), []).append((number, "\n".join(messages.strip().splitlines()[-2:])[-300:]))

    def merge(self, other):
        self.runs += other.runs
        for key, value in other.wrong.items():
            self.wrong.setdefault(key, []).extend(value)

    def print(self):
        for (where, text), cases in self.wrong.items():
            numbers = ", ".join(str(number) for number, _ in cases[:6])
            print(f"FAILED  {where}: {text}: at {numbers}{' ...' if len(cases) > 6 else ''} ({len(cases)} in all)")
            if cases[0][1]:
                print("        " + cases[0][1].replace("\n", "\n        "))


def fail_each(runner, judge, fault, has_old, step=1):
    """Runs the job afresh for the n-th call and every step-th after it, until there is no such call."""
    findings, number = Findings(), step // 2 + 1
    with Place(judge.job, runner.asset, has_old) as place:
        while True:
            end = runner.run(judge.job, place, fault, number)
            if end.counts["faults"] == 0:
                return findings
            findings.add(where_of(judge, fault, has_old), number, judge.faults(place, end, fault), end.messages)
            place.reset()
            number += step


def fail_allocations(runner, judge, fault, has_old, step=1):
    """As fail_each, within one run that forks at each allocation."""
    if not judge.job.forks:
        return fail_each(runner, judge, fault, has_old, max(step, 97))
    findings, afresh, where = Findings(), [], where_of(judge, fault, has_old)
    with Place(judge.job, runner.asset, has_old) as place:
        for number, status in fork_each(runner, judge.job, fault, place, step):
            if status is None:
                afresh.append(number)
                continue
            end = End(os.waitstatus_to_exitcode(status), (place.base / "output").read_bytes(),
                      (place.base / "messages").read_text(errors="replace"), {})
            findings.add(where, number, judge.faults(place, end, fault), end.messages)
            place.reset()
        place.reset()
        for number in afresh:
            end = runner.run(judge.job, place, fault, number)
            findings.add(where, number, judge.faults(place, end, fault), end.messages)
            place.reset()
    return findings


def fork_each(runner, job, fault, place, step):
    """Yields the number of each allocation with the status of the child that saw it fail, or None if it cannot be forked."""
    to_tool, from_tool = os.pipe(), os.pipe()
    environment = runner.environment(place, fault, step // 2 + 1, FAULTS_FORK=str(step),
                                     FAULTS_CONTROL=f"{to_tool[0]},{from_tool[1]}")
    with open(place.base / "parent", "wb") as messages:
        process = subprocess.Popen([runner.tool, *job.words], cwd=place.folder, env=environment, stdin=subprocess.DEVNULL,
                                   stdout=messages, stderr=messages, pass_fds=(to_tool[0], from_tool[1]))
    os.close(to_tool[0])
    os.close(from_tool[1])
    while message := os.read(from_tool[0], 16):
        number, what = struct.unpack("2Q", message)
        if what == 0:
            os.write(to_tool[1], b"f")
        else:
            yield number, None if what == 1 else what - 2
            if what > 1:
                os.write(to_tool[1], b"g")
    os.close(to_tool[1])
    os.close(from_tool[0])
    if process.wait() != job.code:
        messages = (place.base / "parent").read_text(errors="replace")
        raise SystemExit(f"{job.name}: the parent of the forks ends with {process.returncode}\n{messages}")


def kill_each(runner, judge, fault, has_old):
    """Kills the tool before (within) each change of a file. Then files are old or new, and the next run succeeds and clears
    away what was left."""
    findings, number, where = Findings(), 1, where_of(judge, fault, has_old)
    with Place(judge.job, runner.asset, has_old) as place:
        while True:
            end = runner.run(judge.job, place, fault, number)
            if end.counts["faults"] == 0:
                return findings
            wrong = judge.faults_of_files(place, place.contents(), may_leave=True)
            end = runner.run(judge.job, place)
            contents = place.contents()
            if end.code != judge.job.code or not judge.all_new(contents):
                wrong.append(f"the next run ends with {end.code}")
            wrong += [f"after the next run: {text}" for text in judge.faults_of_files(place, contents)]
            findings.add(where, number, wrong, end.messages)
            place.reset()
            number += 1


def cut_power(runner, judge, has_old):
    findings = Findings()
    with Place(judge.job, runner.asset, has_old) as place:
        trace = place.base / "trace"
        runner.run(judge.job, place, FAULTS_TRACE=str(trace))
        lines = trace.read_text().splitlines() if trace.exists() else []
        findings.runs, wrong = power.replay(judge, place, lines)
        for text, numbers in wrong.items():
            for number in numbers:
                findings.add(f"{judge.job.name}, power cut{', old outputs' if has_old else ''}", number, [text],
                             lines[number - 1][:100])
    return findings


def where_of(judge, fault, has_old):
    return f"{judge.job.name}, {fault.name()}{', old outputs' if has_old else ''}"


def all_tasks(judge, options):
    """(what is done, function of a runner) for all that is done to one job."""
    def wanted(kind):
        return (not options.kind or kind in options.kind) and (not judge.job.kinds or kind in judge.job.kinds)

    # The slice breaks each call once with old outputs there; kills and power cuts come with and without.
    old_and_not = (False, True) if judge.job.outputs else (False,)
    for has_old in old_and_not:
        if wanted("write"):
            for kind, fault in (("change", KILL), ("write", HALF_AND_KILL)):
                yield "kill", lambda r, f=Fault(kind, fault), o=has_old: kill_each(r, judge, f, o)
            yield "power", lambda r, o=has_old: cut_power(r, judge, o)
    if wanted("alloc"):
        for is_later in (False, True):
            yield "alloc", lambda r, f=Fault("alloc", errno.ENOMEM, is_later): fail_allocations(r, judge, f, True,
                                                                                                options.every)
    for has_old in old_and_not[-1:] if options.slice else old_and_not:
        for kind, errors, later in FAULTS:
            if wanted(kind):
                for fault in [Fault(kind, error) for error in errors] + [Fault(kind, later, True)]:
                    yield kind, lambda r, f=fault, o=has_old: fail_each(r, judge, f, o)


def make_asset(tool, library):
    job = next(job for job in JOBS if job.name == "bake")
    return Judge(Runner(tool, library), job).new["a.pliant"]


def disturb(runner, job, options, pool):
    """All faults of one job; prints how many there were of each kind, and what went wrong."""
    total, row, begin = Findings(), {}, time.monotonic()
    tasks = [(kind, pool.submit(task, runner)) for kind, task in all_tasks(Judge(runner, job), options)]
    for kind, future in tasks:
        total.merge(future.result())
        row[kind] = row.get(kind, 0) + future.result().runs
    print(f"{job.name:12} {time.monotonic() - begin:5.0f} s  " + ", ".join(f"{kind} {runs}" for kind, runs in row.items()))
    total.print()
    sys.stdout.flush()
    return total


def main():
    parser = argparse.ArgumentParser(description="injects faults into the tool")
    parser.add_argument("tool", type=os.path.abspath)
    parser.add_argument("library", type=os.path.abspath, help="inject.c as a shared library")
    parser.add_argument("--job", action="append", help="only this job of jobs.py; may be repeated")
    parser.add_argument("--kind", action="append", help="only this kind of calls; write holds kills and power cuts, too")
    parser.add_argument("--every", type=int, default=1, help="of the allocations fail every N-th")
    parser.add_argument("--slice", action="store_true", help="what every build runs, on one core")
    parser.add_argument("--workers", type=int, default=os.cpu_count())
    options = parser.parse_args()
    if options.slice:
        options.job, options.every, options.workers = ["bake", "blend"], 211, 1
    begin = time.monotonic()
    runner, findings = Runner(options.tool, options.library, make_asset(options.tool, options.library)), Findings()
    with concurrent.futures.ThreadPoolExecutor(options.workers) as pool:
        for job in JOBS:
            if not options.job or job.name in options.job:
                findings.merge(disturb(runner, job, options, pool))
    print(f"{findings.runs} faults in {time.monotonic() - begin:.0f} s, {len(findings.wrong)} findings")
    return 1 if findings.wrong else 0


if __name__ == "__main__":
    sys.exit(main())
