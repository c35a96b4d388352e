"""Every code cell of samples/python/elastic_blends.ipynb runs, in order, and shows what its text says."""
import json
import os
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np

try:
    import matplotlib
except ImportError:
    print("skipped: matplotlib is not installed")
    sys.exit(77)

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

NOTEBOOK = json.loads(Path(os.environ["PLIANT_SOURCE"], "samples/python/elastic_blends.ipynb").read_text(encoding="utf-8"))
CELLS = [cell for cell in NOTEBOOK["cells"] if cell["cell_type"] == "code"]


def run():
    """The names that the cells leave behind, and the number of figures that have something in them."""
    names, drawn = {}, 0
    for k, cell in enumerate(CELLS):
        exec(compile("".join(cell["source"]), f"cell {k}", "exec"), names)
        for figure in map(plt.figure, plt.get_fignums()):
            with tempfile.TemporaryFile() as file:
                figure.savefig(file, format="rgba")
                file.seek(0)
                drawn += len(np.unique(np.frombuffer(file.read(), "u4"))) > 50
        plt.close("all")
    return names, drawn


class Notebook(unittest.TestCase):
    def test_it_is_stored_without_output(self):
        self.assertEqual(NOTEBOOK["nbformat"], 4)
        for cell in CELLS:
            self.assertEqual((cell["outputs"], cell["execution_count"]), ([], None))

    def test_it_runs(self):
        names, drawn = run()
        self.assertEqual(drawn, 3)
        thickness, shapes = names["thickness"], names["curves"]
        self.assertLess(thickness(shapes["linear"][10]), 0.6)
        self.assertGreater(thickness(shapes["elastic"][10]), 0.69)
        values = {name: names["energy"].value(shape[10], [1, 1]) for name, shape in shapes.items()}
        self.assertLess(values["elastic"], 1.01 * values["unreduced average"])
        self.assertGreater(values["linear"], 2 * values["unreduced average"])
        self.assertGreaterEqual(names["values"].min(), -1e-5)


if __name__ == "__main__":
    unittest.main(verbosity=2)
