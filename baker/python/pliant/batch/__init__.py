"""Many characters on many machines: the manifest of `pliant bake-all` on a Dask cluster. Needs `pip install pliant[batch]`.

    if __name__ == "__main__":                                            # workers are processes that load this file, too
        print(pliant.batch.run("characters.json"))                        # on this machine
        print(pliant.batch.run("characters.json", client=Client("tcp://farm:8786")))

Every bake is a `pliant bake-all MANIFEST --only NAME` on a worker. The meaning of the manifest, the stamps and the bytes of
assets are therefore those of `pliant bake-all`, and each of the two continues where the other was stopped.
"""
from __future__ import annotations

import importlib
import os
import time
from typing import Any, Callable, Optional, Sequence, Union

from . import _local, _plan
from ._farm import Farm
from ._summary import Record, Summary

__all__ = ["Record", "Summary", "run"]

Progress = Callable[[Record, int, int], object]


def distributed_module() -> Any:
    """dask.distributed, or an ImportError that explains how to install it."""
    try:
        importlib.import_module("dask")
        return importlib.import_module("distributed")
    except ImportError as error:
        raise ImportError(f"pliant.batch needs Dask, which is an extra: "
                          "pip install \"dask[distributed]\", or \"./baker/python[batch]\" "
                          f"from the tree of Pliant ({error})") from error


def _check_numbers(workers: Optional[int], retries: int, memory: Optional[float]) -> None:
    if workers is not None and workers < 1:
        raise ValueError(f"workers: 1 or more expected, got {workers}")
    if retries < 0:
        raise ValueError(f"retries: 0 or more expected, got {retries}")
    if memory is not None and not 0 < memory < float("inf"):
        raise ValueError(f"memory: bytes expected, got {memory}")


def _names(only: Union[str, Sequence[str], None]) -> Sequence[str]:
    names = [only] if isinstance(only, str) else list(only or [])
    if only is not None and not names:
        raise ValueError("only: no name")
    return names


def run(manifest: Union[str, "os.PathLike[str]"], *, client: Any = None, workers: Optional[int] = None,
        tool: Union[str, "os.PathLike[str]", None] = None, force: bool = False, only: Union[str, Sequence[str], None] = None,
        retries: int = 2, memory: Optional[float] = None, progress: Optional[Progress] = None) -> Summary:
    """Bakes everything in a manifest (formats/schema/bake_manifest.schema.json) that is not up to date,
    and returns when all is done.

    client     a dask.distributed.Client. Its workers must have a resource MEMORY, the bytes that all bakes on the worker may
               use together (`dask worker ADDRESS --nthreads 4 --resources MEMORY=48e9`). They run as many bakes at a time as
               they have threads. They need this package, the tool, and the manifest, its poses and the output folders under
               the same paths as this machine. None: workers are started on this machine, with one bake each, and stopped at
               the end.
    workers    number of processes on this machine (default: one per core, fewer if there is less to do or the largest bake
               needs the memory); with a client: the number of workers to wait for (at most 5 minutes)
    tool       path of the program `pliant`, the same on all workers; default: next to their Python, otherwise on their PATH
    force      also bake assets that are up to date
    only       a name or names: bake only these
    retries    further attempts for a bake that was killed from outside, or whose worker was lost more often than the
               scheduler allows (Dask's distributed.scheduler.allowed-failures, 3). Losing a worker once only delays the bake
               that ran there.
    memory     bytes for all bakes on this machine (default: 80 % of the machine's or container's); not with a client
    progress   called as progress(record, done, total) in this thread after every bake;
               an exception ends all bakes and is raised

    Returns a Summary. Bakes that failed, crashed or are too large are listed there and do not affect others. Errors and
    warnings of bakes also go to the logger "pliant.batch". Raises Error, with the number of the command line, if the
    manifest is wrong or `only` has an unknown name; ValueError for invalid numbers; FileNotFoundError without the tool;
    RuntimeError for workers that cannot do the work; ImportError without Dask. Ctrl-C ends all bakes; finished assets stay.
    """
    distributed = distributed_module()
    _check_numbers(workers, retries, memory)
    start = time.monotonic()
    request = _plan.Request(os.path.abspath(os.fspath(manifest)), None if tool is None else os.fspath(tool), force,
                            _names(only))
    if client is None:
        result = _local.run(distributed, request, workers, memory, retries, progress)
    elif memory is not None:
        raise ValueError("memory: each worker of a cluster says itself what it has, by its resource MEMORY")
    elif client.asynchronous:
        raise ValueError("client: it is asynchronous; a blocking one is expected")
    else:
        result = Farm(distributed, client, request, retries).run(workers or 1, progress)
    return Summary(list(result.records.values()), result.baker, time.monotonic() - start, result.messages)
