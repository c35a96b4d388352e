"""Bakes on a Dask cluster: checks of the workers, distribution of the bakes, and recovery from lost workers."""
from __future__ import annotations

import contextlib
import json
import os
import signal
import tempfile
import threading
import uuid
from collections import Counter
from typing import Any, Callable, Dict, Iterator, List, Optional, Tuple

from . import _plan, _worker
from ._plan import Request, Result
from ._summary import Record

_PATIENCE = 300  # seconds for workers to come: a queue of a farm may take minutes
_KILLS = (9, 15)  # signals from outside: of the system that needs memory, of a queue that ends its job


@contextlib.contextmanager
def _tokens(result: Result) -> Iterator[List[str]]:
    """Creates a new file in the folder of every output, for the workers to find."""
    folders = sorted({os.path.dirname(os.path.abspath(result.records[name]["output"])) for name in result.pending()})
    with contextlib.ExitStack() as stack:
        paths = []
        for folder in folders:
            if os.path.isdir(folder):  # what lies in no folder fails by itself, with a message of its own
                paths.append(stack.enter_context(tempfile.NamedTemporaryFile(prefix=".pliant-batch-", dir=folder)).name)
        yield paths


@contextlib.contextmanager
def _uninterrupted() -> Iterator[None]:
    """Delays Ctrl-C to the end of the block. Dask's blocking calls log a traceback if it comes before they have started."""
    before = signal.getsignal(signal.SIGINT)
    if threading.current_thread() is not threading.main_thread() or not callable(before):
        yield
        return
    came: List[int] = []
    signal.signal(signal.SIGINT, lambda number, _: came.append(number))
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)
        if came:
            before(signal.SIGINT, None)


def _result_of(future: Any, timeout_error: Any) -> Any:
    """The result of a future, or its exception. Reacts to Ctrl-C within a second."""
    while True:
        with _uninterrupted():
            try:
                return future.result(timeout=1)
            except timeout_error:
                if future.status == "error":
                    raise


def _share(places: Dict[str, _worker.Place]) -> int:
    """Bakes that run on one machine together, at most."""
    threads: Counter[str] = Counter()
    for place in places.values():
        threads[place.host] += place.threads
    return max(threads.values())


class Farm:
    """The cluster of a client, and a request to it."""

    def __init__(self, distributed: Any, client: Any, request: Request, retries: int) -> None:
        self._distributed = distributed
        self._client = client
        self._request = request
        self._retries = retries
        self._group = uuid.uuid4().hex  # of the tools that this run starts: workers may serve others, too

    def run(self, worker_count: int, progress: Optional[Callable[[Record, int, int], object]]) -> Result:
        """Plans on one of the workers, then bakes on all. RuntimeError if they cannot."""
        try:
            self._client.wait_for_workers(worker_count, timeout=_PATIENCE)
        except self._distributed.TimeoutError as error:
            raise RuntimeError(f"the cluster has no {worker_count} workers after {_PATIENCE} seconds") from error
        places = self._places([])
        share, memory = _share(places), max(place.memory for place in places.values())
        planned = self._client.submit(_worker.call_tool, self._request.tool, self._request.dry_run(share, memory),
                                      self._group, pure=False, workers=list(places))
        try:
            ended = _result_of(planned, self._distributed.TimeoutError)
        except Exception as error:
            raise RuntimeError(f"the cluster cannot make the plan: {error}") from error
        except BaseException:  # Ctrl-C
            self._stop([planned])
            raise
        result = _plan.read_plan(ended)
        if not result.pending():
            return result
        with _tokens(result) as paths:
            self._places(paths)
        return self.bake(result, share, memory, progress)

    def _places(self, tokens: List[str]) -> Dict[str, _worker.Place]:
        """The workers that have a resource MEMORY, by address."""
        request = self._request
        digest = _worker.digest_of(request.manifest) if os.path.exists(request.manifest) else ""
        try:
            everyone = self._client.run(_worker.look_around, request.tool, request.manifest, digest, tokens)
        except Exception as error:  # of any kind: older versions of Dask bring home no more than its text
            raise RuntimeError(f"the workers cannot look around: {error}; "
                               "do they have the package pliant, of this version?") from error
        places = {address: place for address, place in everyone.items() if place.memory > 0}
        if not places:
            raise RuntimeError("no worker has a resource MEMORY, the bytes that bakes may take there together: "
                               "start them as "
                               "`dask worker ADDRESS --nthreads 4 --resources MEMORY=48e9`")
        for address, place in places.items():
            if place.wrong:
                raise RuntimeError(f"worker {address} on {place.host}: {place.wrong}")
        versions = sorted({place.version for place in places.values()})
        if len(versions) > 1:
            raise RuntimeError(f"the workers have different versions of the tool: {', '.join(versions)}")
        return places

    def bake(self, result: Result, share: int, memory: float,
             progress: Optional[Callable[[Record, int, int], object]]) -> Result:
        """Runs the pending bakes of a plan and returns it with their results.
        `share`, `memory` (bytes): those of the plan."""
        names = result.pending()
        tries = Counter(names)
        priorities = {name: -i for i, name in enumerate(names)}
        running: Dict[Any, str] = {}

        def submit(name: str) -> Any:
            future = self._client.submit(_worker.call_tool, self._request.tool,
                                         self._request.arguments(share, memory, [name]), self._group,
                                         key=f"pliant-bake-{uuid.uuid4().hex}", pure=False, priority=priorities[name],
                                         resources={"MEMORY": result.estimate(name)})
            running[future] = name
            return future

        try:
            ended = self._distributed.as_completed([submit(name) for name in names])
            for future in ended:
                name = running.pop(future)
                record, errors, is_killed = self._judge(future, result.records[name])
                if is_killed and tries[name] <= self._retries:
                    tries[name] += 1
                    _plan.log.warning("%s: %s; it is tried again", name, errors or "killed")
                    ended.add(submit(name))
                    continue
                result.take(name, record, errors)
                if progress is not None:
                    progress(record, len(names) - len(running), len(names))
        except BaseException:
            self._stop(list(running))
            raise
        return result

    def _judge(self, future: Any, planned: Record) -> Tuple[Record, str, bool]:
        """The record of a finished attempt, its messages, and whether it was killed by a cause that may not recur."""
        lost = {**planned, "outcome": "crashed", "exit_code": 1}
        try:
            ended = _result_of(future, self._distributed.TimeoutError)
        except Exception as error:  # too many workers were lost, or the tool could not be started
            if not future.cancelled():
                return lost, str(error), True
            return ({**planned, "outcome": "interrupted", "exit_code": 130},
                    "the cluster was lost, or has cancelled it", False)
        if ended.exit_code < 0:
            return ({**lost, "exit_code": 0, "signal": -ended.exit_code},
                    f"the tool was killed by signal {-ended.exit_code}", True)
        try:
            (record,) = json.loads(ended.output)["bakes"]
        except (ValueError, KeyError, TypeError):
            if ended.exit_code == 130:  # while it judged the stamp: it prints no summary then
                return {**lost, "exit_code": 130}, "the tool was interrupted", True
            return ({**lost, "outcome": "failed", "exit_code": ended.exit_code},
                    f"on {ended.host}: {ended.errors.strip()}", False)
        # it was not when it was planned: a worker was lost after the bake, before it could tell
        if record["outcome"] == "up to date":
            record["outcome"] = "baked"
        errors = _plan.messages_of(ended.errors, [record["name"]]).get(record["name"], "")
        is_stopped = record["outcome"] in ("interrupted", "not started")
        return record, errors, is_stopped or record.get("signal") in _KILLS

    def _stop(self, futures: List[Any]) -> None:
        """Stops all bakes, since nobody waits for them any more."""
        try:
            self._client.cancel(futures)
            self._client.run(_worker.stop_tools, self._group)
        except Exception as error:  # the cluster may be what is gone; the reason itself is raised
            _plan.log.warning("the bakes that run cannot be stopped: %s", error)
