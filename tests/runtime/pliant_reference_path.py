"""Import me first: puts formats/reference on the path."""
import sys
from pathlib import Path

FOLDER = Path(__file__).resolve().parents[2] / "formats" / "reference"
FILES = sorted(FOLDER.glob("*.py"))
sys.path.insert(0, str(FOLDER))
