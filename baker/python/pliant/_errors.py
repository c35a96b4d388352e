"""Exceptions and warnings: the numbered diagnostics of the baker."""
from __future__ import annotations

import re
from typing import TYPE_CHECKING, NamedTuple, Sequence

if TYPE_CHECKING:
    from ._asset import Asset

_MISSES_TOLERANCE = 4


class Finding(NamedTuple):
    """One error or warning."""

    is_error: bool
    number: str  # "P2103"; baker/base/common/messages.md lists them all
    where: str  # "poses[1]", "run.obj:812" or empty
    what: str
    hint: str  # may be empty

    def __str__(self) -> str:
        where = f"{self.where}: " if self.where else ""
        hint = f"\n  hint: {self.hint}" if self.hint else ""
        return f"{'error' if self.is_error else 'warning'} {self.number}: {where}{self.what}{hint}"


class Error(Exception):
    """An error of the baker or the runtime: an input is wrong, a file cannot be read, or a computation fails.

    number     number of the first error, like 'P2103'
    hint       remedy for the first error; may be empty
    exit_code  exit code of the command line: 1 failed while working, 2 wrong usage, 3 bad input, 4 misses the tolerance
    findings   all diagnostics, including warnings
    """

    def __init__(self, findings: Sequence[Finding], exit_code: int) -> None:
        self.findings: tuple[Finding, ...] = tuple(findings)
        self.exit_code: int = exit_code
        first = next((f for f in self.findings if f.is_error), self.findings[0])
        self.number: str = first.number
        self.hint: str = first.hint
        super().__init__("\n".join(str(f) for f in self.findings))

    def __reduce__(self) -> tuple[object, ...]:
        return type(self), (self.findings, self.exit_code)


class ToleranceError(Error):
    """The asset misses a tolerance that was given.

    asset  the asset with its report if best_effort was given; otherwise None
    """

    def __init__(self, findings: Sequence[Finding], exit_code: int = _MISSES_TOLERANCE, asset: Asset | None = None) -> None:
        super().__init__(findings, exit_code)
        self.asset: Asset | None = asset

    def __reduce__(self) -> tuple[object, ...]:
        return type(self), (self.findings, self.exit_code, self.asset)


class PliantWarning(UserWarning):
    """A warning of the baker; `finding` holds its number and hint."""

    def __init__(self, finding: Finding) -> None:
        super().__init__(str(finding))
        self.finding: Finding = finding


def python_names(text: str) -> str:
    """Replaces options of the command line by the names of arguments: --tolerance-max becomes tolerance_max."""
    return re.sub(r"(?<!\w)--([a-z]+(?:-[a-z]+)*)", lambda match: match.group(1).replace("-", "_"), text)


def finding(is_error: bool, number: int, where: str, what: str, hint: str) -> Finding:
    return Finding(is_error, f"P{number:04d}", where, python_names(what), python_names(hint))


def from_findings(exit_code: int, found: Sequence[tuple[bool, int, str, str, str]]) -> Error:
    """Makes the exception for a failure; called by the C++ module."""
    kind = ToleranceError if exit_code == _MISSES_TOLERANCE else Error
    return kind([finding(*one) for one in found], exit_code)
