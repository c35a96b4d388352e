"""The ten lines that the READMEs show are those of the sample, and they work."""
import math
import os
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

SOURCE = Path(os.environ["PLIANT_SOURCE"])
SAMPLE = SOURCE / "samples/python/blend_in_ten_lines.py"


class Sample(unittest.TestCase):
    def test_it_works(self):
        with tempfile.TemporaryDirectory() as folder:
            done = subprocess.run([sys.executable, "-W", "error", str(SAMPLE)], cwd=folder, capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertTrue(Path(folder, "sheet.pliant").exists())
        # An arc of length 11 and radius 8, its chord along x as blends are aligned to the first pose.
        length = float(re.search(r"half rolled, the sheet is ([0-9.]+) long", done.stdout).group(1))
        self.assertAlmostEqual(length, 16 * math.sin(11 / 16), delta=0.05)

    def test_it_is_what_the_readmes_show(self):
        lines = SAMPLE.read_text().split('"""\n', 1)[1].strip()
        for readme in ("README.md", "baker/python/README.md"):
            self.assertIn(lines, (SOURCE / readme).read_text(), readme)
        self.assertLessEqual(len([line for line in lines.splitlines() if line and not line.startswith("import")]), 10)


if __name__ == "__main__":
    unittest.main(verbosity=2)
