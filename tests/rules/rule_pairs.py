"""A source with a header of its own includes it first, so that every header is compiled once with nothing before it; a source
without one is a program, a verb, a reader behind one common header, or stands in the list below with its header."""
import re
from pathlib import PurePosixPath

from rule_includes import INCLUDE, resolve
from tree import Plant

ROOMS = ("baker", "samples")
# Programs, and families of sources behind one header.
WITHOUT_HEADER = re.compile(r"(?:^|/)(?:main|module|verb_\w+|read_\w+)\.cpp$")
