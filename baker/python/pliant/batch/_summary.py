"""The result of a manifest: for programs the report of `pliant bake-all`, for people a table."""
from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Dict, List

Record = Dict[str, Any]  # one of "bakes" in formats/schema/bake_all_report.schema.json

_FAILURES = ("failed", "crashed", "too large", "not started")


@dataclass(frozen=True)
class Summary:
    """The result of pliant.batch.run. print() shows a table.

    bakes      one record per bake, in the order of the manifest, with the keys of `pliant bake-all --json`: "name", "output"
               (absolute), "outcome" ("baked", "up to date", "misses tolerance", "failed", "crashed", "too large"),
               "exit_code", "estimate", ...
    baker      version of the tool, like "pliant 0.1.0"
    seconds    duration of the call
    messages   errors and warnings as the tool prints them, by the name of the bake
    """

    bakes: List[Record]
    baker: str
    seconds: float
    messages: Dict[str, str] = field(default_factory=dict)

    @property
    def exit_code(self) -> int:
        """Exit code of `pliant bake-all`: 0 all is done, 1 a bake failed, 4 only tolerances are missed, 130 interrupted."""
        outcomes = {bake["outcome"] for bake in self.bakes}
        if "interrupted" in outcomes:
            return 130
        if outcomes & set(_FAILURES):
            return 1
        return 4 if "misses tolerance" in outcomes else 0

    def as_dict(self) -> Dict[str, Any]:
        """The report of `pliant bake-all --json` (formats/schema/bake_all_report.schema.json)."""
        return {"bake_all": 1, "baker": self.baker, "exit_code": self.exit_code, "seconds": self.seconds,
                "bakes": self.bakes}

    def __str__(self) -> str:
        width = max([4] + [len(bake["name"]) for bake in self.bakes])
        lines = [_line(width, "name", "outcome", "d", "elements", "error", "size", "seconds")]
        for bake in self.bakes:
            lines.append(_line(width, bake["name"], bake["outcome"], _shown(bake, "dimension", "{}"),
                               _shown(bake, "elements", "{}"),
                               _shown(bake, "mean_error", "{:.2e}"),
                               size_text(bake["file_size"]) if "file_size" in bake else "-",
                               _shown(bake, "seconds", "{:.1f}")))
        return "\n".join(lines)


def _line(width: int, name: str, outcome: str, dimension: str, elements: str, error: str, size: str, seconds: str) -> str:
    return f"{name:<{width}}  {outcome:<16} {dimension:>4} {elements:>8} {error:>9} {size:>10} {seconds:>8}"


def _shown(bake: Record, key: str, pattern: str) -> str:
    return pattern.format(bake[key]) if key in bake else "-"


def size_text(size: float) -> str:
    """'1.4 MiB'."""
    if size >= 2**30:
        return f"{size / 2**30:.1f} GiB"
    return f"{size / 2**20:.1f} MiB" if size >= 2**20 else f"{size / 2**10:.1f} KiB"
