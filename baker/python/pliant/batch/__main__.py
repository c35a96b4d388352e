"""python -m pliant.batch MANIFEST.json: the manifest of `pliant bake-all`, on a Dask cluster."""
from __future__ import annotations

import argparse
import importlib
import json
import logging
import signal
import sys
from typing import Any, List, Optional

from .. import Error
from . import Record, distributed_module, run
from ._plan import log


def _arguments(words: Optional[List[str]]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m pliant.batch",
                                     description="Bake what is not up to date on a Dask cluster. Exit "
                                     "codes as of pliant bake-all: 0 all is done, 1 a bake failed, "
                                     "4 only tolerances are missed, "
                                     "130 interrupted; 2 and 3 for a wrong call and a wrong manifest.")
    parser.add_argument("manifest", metavar="MANIFEST.json")
    parser.add_argument("--scheduler", metavar="ADDRESS",
                        help="of a cluster, like tcp://farm:8786 (default: workers on this machine)")
    parser.add_argument("--workers", type=int, metavar="N",
                        help="processes on this machine; with --scheduler: wait for so many")
    parser.add_argument("--tool", metavar="PATH", help="the program pliant (default: beside Python, else on PATH)")
    parser.add_argument("--memory", metavar="SIZE",
                        help="for all bakes on this machine, 16GiB (default: 80 %% of the machine's)")
    parser.add_argument("--only", action="append", metavar="NAME", help="only this bake; may be given several times")
    parser.add_argument("--force", action="store_true", help="bake what is up to date, too")
    parser.add_argument("--retries", type=int, default=2, metavar="N",
                        help="further tries of a bake that was killed (default: 2)")
    parser.add_argument("--json", action="store_true", help="the summary as JSON")
    parser.add_argument("--quiet", "-q", action="store_true", help="no progress")
    return parser.parse_args(words)


def _tell(record: Record, done: int, total: int) -> None:
    print(f"[{done}/{total}] {record['name']}: {record['outcome']}", file=sys.stderr, flush=True)


def _hear_log() -> None:
    """Sends the log of this package to standard error; Dask's log is unchanged."""
    handler = logging.StreamHandler()
    handler.setFormatter(logging.Formatter("pliant.batch: %(message)s"))
    log.addHandler(handler)
    log.propagate = False


def _run(a: argparse.Namespace, client: Any, memory: Optional[float]) -> int:
    summary = run(a.manifest, client=client, workers=a.workers, tool=a.tool, force=a.force, only=a.only, retries=a.retries,
                  memory=memory, progress=None if a.quiet else _tell)
    print(json.dumps(summary.as_dict(), indent=1) if a.json else summary)
    return summary.exit_code


def main(words: Optional[List[str]] = None) -> int:
    a = _arguments(words)
    signal.signal(signal.SIGCHLD, signal.SIG_DFL)  # inherited as ignored it would hide how workers and bakes end
    _hear_log()
    try:
        if sys.stdout is None:
            raise OSError("standard output is closed")
        distributed = distributed_module()
        memory = None if a.memory is None else float(importlib.import_module("dask.utils").parse_bytes(a.memory))
        if a.scheduler is None:
            return _run(a, None, memory)
        with distributed.Client(a.scheduler) as client:
            return _run(a, client, memory)
    except KeyboardInterrupt:
        print("pliant.batch: interrupted; what was finished stays, run the same line again", file=sys.stderr)
        return 130
    except Error as error:
        print(f"pliant.batch: {error}", file=sys.stderr)
        return error.exit_code
    except (ValueError, OverflowError) as error:  # --memory 1e400
        print(f"pliant.batch: {error}", file=sys.stderr)
        return 2
    except (ImportError, OSError, RuntimeError) as error:
        print(f"pliant.batch: {error}", file=sys.stderr)
        return 1


if __name__ == "__main__":
    sys.exit(main())
