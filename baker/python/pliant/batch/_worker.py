"""The code that runs where the files are, on a worker or on this machine: the tool as a child process,
and checks of the place.

It uses the standard library only: it must load quickly, and must work where the rest of a worker's installation is broken.
"""
from __future__ import annotations

import ctypes
import hashlib
import logging
import os
import shutil
import signal
import socket
import subprocess
import sys
import threading
from pathlib import Path
from typing import Any, Callable, NamedTuple, Optional, Sequence

_children: dict[subprocess.Popen[str], str] = {}  # and their groups
_children_lock = threading.Lock()


class Ended(NamedTuple):
    """A run of the tool."""

    exit_code: int  # negative: the signal that killed it
    output: str
    errors: str
    host: str


class Place(NamedTuple):
    """Properties of a worker."""

    host: str
    threads: int
    memory: float  # bytes of its resource MEMORY; 0: it has no such resource
    version: str  # of the tool there; empty if something is wrong
    wrong: str  # what is wrong with it; empty if nothing is


if sys.platform == "linux":
    _SET_DEATH_SIGNAL = 1  # PR_SET_PDEATHSIG of <linux/prctl.h>
    _libc = ctypes.CDLL(None)  # loaded here, as between fork and exec nothing may be

    def _ends_with(parent: int) -> Optional[Callable[[], None]]:
        """Runs between fork and exec: makes the child end with its parent, even if that is killed by SIGKILL. (For the
        kernel the parent is the thread that forks, and that thread waits for the child.) The tool does the same for its own
        children."""

        def follow() -> None:
            _libc.prctl(_SET_DEATH_SIGNAL, int(signal.SIGKILL), 0, 0, 0)
            if os.getppid() != parent:
                os._exit(127)  # it died before the line above

        return follow

else:

    def _ends_with(parent: int) -> Optional[Callable[[], None]]:
        """On other systems an abandoned child runs to its end: the asset appears whole or not at all,
        with the same bytes."""
        return None


def find_tool(tool: Optional[str]) -> str:
    """The path of `pliant`: as given, else next to the running Python, else on PATH. Raises FileNotFoundError,
    with a remedy."""
    if tool is not None:
        found = shutil.which(tool)
        if found is None:
            raise FileNotFoundError(f"tool: there is no program {tool}")
        return os.path.abspath(found)
    beside = Path(sys.executable).with_name("pliant")
    found = str(beside) if os.access(beside, os.X_OK) else shutil.which("pliant")
    if found is None:
        raise FileNotFoundError(f"the tool pliant is neither beside {sys.executable} nor on PATH; say where with tool=")
    return os.path.abspath(found)


def call_tool(tool: Optional[str], arguments: Sequence[str], group: str = "") -> Ended:
    """Runs the tool to its end. It is ended with this process, and by stop_tools(group)."""
    command = [find_tool(tool), *arguments]
    with _children_lock:
        child = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                 encoding="utf-8", errors="replace", preexec_fn=_ends_with(os.getpid()))
        _children[child] = group
    try:
        output, errors = child.communicate()
    except BaseException:  # Ctrl-C, where the caller is a person's own process
        child.terminate()
        child.communicate()
        raise
    finally:
        with _children_lock:
            del _children[child]
    return Ended(child.returncode, output, errors, socket.gethostname())


def stop_tools(group: str) -> None:
    """Terminates the tools of a group that run here; call_tool then returns."""
    with _children_lock:
        for child, its_group in _children.items():
            if its_group == group:
                child.terminate()


def dask_setup(worker: Any) -> None:
    """Dask calls this in workers that preload the module, as those on this machine do. Ctrl-C at a terminal reaches all
    processes, but must end the caller only, which then ends the bakes and the workers."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGCHLD, signal.SIG_DFL)  # inherited as ignored it would hide how bakes end
    logging.getLogger("distributed.worker").addFilter(lambda record: not _is_of_a_closing_connection(worker, record))


def _is_of_a_closing_connection(worker: Any, record: logging.LogRecord) -> bool:
    """Whether a worker that is being closed reports a connection that closed with it. Dask logs such a heartbeat as an error
    with a traceback (dask/distributed, Worker.heartbeat), although nothing is wrong."""
    is_closing = worker.status.name in ("closing", "closing_gracefully", "closed")
    return is_closing and record.exc_info is not None and isinstance(record.exc_info[1], OSError)


def digest_of(path: str) -> str:
    """SHA-256, hexadecimal."""
    return hashlib.sha256(Path(path).read_bytes()).hexdigest()


def _wrong_with_files(manifest: str, digest: str, tokens: Sequence[str]) -> str:
    remedy = "the manifest, its poses and outputs must lie on a file system that all workers share, under the same paths"
    try:
        if digest_of(manifest) != digest:
            return f"it sees another file as {manifest}; {remedy}"
    except OSError as error:
        return f"it cannot read the manifest: {error}; {remedy}"
    for token in tokens:
        folder = os.path.dirname(token)
        if not os.path.exists(token):
            return f"it sees another folder, or none, as {folder}; {remedy}"
        if not os.access(folder, os.W_OK):
            return f"it may not write into {folder}"
    return ""


def look_around(tool: Optional[str], manifest: str, digest: str, tokens: Sequence[str], dask_worker: Any = None) -> Place:
    """Runs on every worker and checks that it has everything that a bake needs. `tokens` are files that the client has just
    created in the output folders. Their names are new, so no cache of a network file system can be wrong about them."""
    state = dask_worker.state
    place = Place(socket.gethostname(), int(state.nthreads), float(state.total_resources.get("MEMORY", 0)), "", "")
    wrong = _wrong_with_files(manifest, digest, tokens)
    if wrong:
        return place._replace(wrong=wrong)
    if signal.getsignal(signal.SIGCHLD) == signal.SIG_IGN:
        return place._replace(wrong="it ignores SIGCHLD and cannot see how bakes end: start it with the default handling")
    try:
        ended = call_tool(tool, ["--version"])
    except OSError as error:
        return place._replace(wrong=str(error))
    if ended.exit_code != 0:
        return place._replace(wrong=f"its tool pliant does not run (exit code {ended.exit_code}): {ended.errors.strip()}")
    return place._replace(version=ended.output.strip())
