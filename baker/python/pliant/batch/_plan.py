"""The plan of a manifest, from `pliant bake-all --dry-run`, and the parsing of its output."""
from __future__ import annotations

import json
import logging
import re
from dataclasses import dataclass
from typing import Dict, List, Optional, Sequence

from .._errors import Error, finding
from ._summary import Record
from ._worker import Ended

_MOST_JOBS = 256  # of bake-all
_USAGE, _BAD_INPUT = 2, 3
_TOOL_SAYS = "pliant bake-all: "

log = logging.getLogger("pliant.batch")


@dataclass(frozen=True)
class Request:
    """The arguments of a call: the manifest as an absolute path, the tool as given."""

    manifest: str
    tool: Optional[str]
    force: bool
    only: Sequence[str]

    def arguments(self, share: int, memory: float, names: Sequence[str]) -> List[str]:
        """Arguments of the tool. `share`: number of bakes that share the cores of a machine;
        `memory`: limit for the estimate, in bytes."""
        words = ["bake-all", self.manifest, "--json", "--quiet", "--jobs", str(min(share, _MOST_JOBS)), "--memory",
                 f"{int(memory)}b"]
        words += ["--force"] if self.force else []
        for name in names:
            words += ["--only", name]
        return words

    def dry_run(self, share: int, memory: float) -> List[str]:
        return [*self.arguments(share, memory, self.only), "--dry-run"]


@dataclass
class Result:
    """Records and messages by name, in the order of the manifest. It starts as the plan;
    finished bakes replace their records."""

    baker: str
    records: Dict[str, Record]
    messages: Dict[str, str]

    def pending(self) -> List[str]:
        return [name for name, record in self.records.items() if record["outcome"] == "to be baked"]

    def estimate(self, name: str) -> float:
        """Estimated memory of a bake in bytes."""
        return float(self.records[name]["estimate"]["memory"])

    def take(self, name: str, record: Record, errors: str) -> None:
        self.records[name] = record
        if errors:
            self.messages[name] = errors
            log.warning("%s: %s", name, errors)


def _error_of(ended: Ended) -> Error:
    """The error for a manifest that the tool rejects as a whole."""
    found = []
    for number, what, hint in re.findall(r"(?m)error P(\d{4}): (.*)(?:\n  hint: (.*))?$", ended.errors):
        found.append(finding(True, int(number), "", what, hint))
    if not found:
        raise RuntimeError(f"pliant bake-all ended with exit code {ended.exit_code} on {ended.host}: {ended.errors.strip()}")
    return Error(found, ended.exit_code)


def read_report(ended: Ended) -> Dict[str, object]:
    """The JSON of bake-all. Raises Error if it rejects the manifest, RuntimeError if its output is not understood."""
    if ended.exit_code in (_USAGE, _BAD_INPUT):
        raise _error_of(ended)
    try:
        report = json.loads(ended.output)
        if report["bake_all"] == 1:
            return dict(report)
    except (ValueError, KeyError, TypeError):
        pass
    raise _error_of(ended)


def messages_of(errors: str, names: Sequence[str]) -> Dict[str, str]:
    """The lines of bake-all on standard error, by the bake that they belong to."""
    messages: Dict[str, str] = {}
    last = ""
    by_length = sorted(names, key=len, reverse=True)  # "a: b" before "a"
    for line in errors.splitlines():
        text = line[len(_TOOL_SAYS):] if line.startswith(_TOOL_SAYS) else line
        owner = next((name for name in by_length if text.startswith(f"{name}: ")), None)
        own = text[len(owner) + 2:] if owner is not None else text
        told = re.match(r"(error|warning) (P\d{4}): ", text)
        if owner is None and told:  # of bake-all itself: "error P4603: NAME: what"
            rest = text[told.end():]
            owner = next((name for name in by_length if rest.startswith(f"{name}: ")), None)
            own = told.group(0) + rest[len(owner) + 2:] if owner is not None else text
        last = owner if owner is not None else last
        if last:
            messages[last] = f"{messages[last]}\n{own}" if last in messages else own
    return messages


def read_plan(ended: Ended) -> Result:
    report = read_report(ended)
    bakes = report["bakes"]
    assert isinstance(bakes, list)
    records: Dict[str, Record] = {bake["name"]: bake for bake in bakes}
    result = Result(str(report["baker"]), records, {})
    for name, text in messages_of(ended.errors, list(records)).items():
        result.take(name, records[name], text)
    return result
