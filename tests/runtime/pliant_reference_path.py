"""Import me first: puts formats/reference on the path."""
import sys
from pathlib import Path

FILE = Path(__file__).resolve().parents[2] / "formats" / "reference" / "pliant_reference.py"
sys.path.insert(0, str(FILE.parent))
