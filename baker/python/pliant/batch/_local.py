"""Workers on this machine."""
from __future__ import annotations

import os
from typing import Any, Callable, Optional

from . import _plan, _worker
from ._farm import Farm
from ._summary import Record

_MEMORY_SHARE = 0.8  # as of bake-all: a fifth is for the system and for what estimates miss


def _planned(request: _plan.Request, count: int, memory: float) -> _plan.Result:
    return _plan.read_plan(_worker.call_tool(request.tool, request.dry_run(count, memory)))


def _fitting_count(result: _plan.Result, count: int, memory: float) -> int:
    """The number of workers, at most `count`, so that each of them can run the largest bake."""
    names = result.pending()
    largest = max((result.estimate(name) for name in names), default=0.0)
    fitting = int(memory // largest) if largest > 0 else count
    return max(1, min(count, len(names), fitting))


def run(distributed: Any, request: _plan.Request, workers: Optional[int], memory: Optional[float], retries: int,
        progress: Optional[Callable[[Record, int, int], object]]) -> _plan.Result:
    """Makes the plan first, which determines the number of workers by work and memory.
    Starts none if there is nothing to do."""
    if memory is None:
        memory = _MEMORY_SHARE * float(distributed.system.MEMORY_LIMIT)
    if workers is not None:
        count = workers
        result = _planned(request, count, memory / count)
    else:
        count = os.cpu_count() or 1
        result = _planned(request, count, memory)
        # Fewer workers have more threads each, which take memory, too.
        while (fewer := _fitting_count(result, count, memory)) < count:
            count = fewer
            result = _planned(request, count, memory)
    if not result.pending():
        return result
    farm_request = _plan.Request(request.manifest, _worker.find_tool(request.tool), request.force, request.only)
    cluster = distributed.LocalCluster(n_workers=count, threads_per_worker=1, processes=True,
                                       dashboard_address="127.0.0.1:0",
                                       resources={"MEMORY": memory / count}, preload=[_worker.__name__])
    with cluster, distributed.Client(cluster) as client:
        return Farm(distributed, client, farm_request, retries).bake(result, count, memory / count, progress)
