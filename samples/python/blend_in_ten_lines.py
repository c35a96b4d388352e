"""Two poses in arrays, an asset, a blend: python blend_in_ten_lines.py, after pip install ./baker/python."""
import numpy as np
import pliant

grid = np.stack(np.meshgrid(np.arange(12.0), np.arange(6.0), indexing="ij"), -1).reshape(-1, 2)
flat = np.column_stack([grid, np.zeros(len(grid))])
rolled = np.column_stack([4 * np.sin(grid[:, 0] / 4), grid[:, 1], 4 - 4 * np.cos(grid[:, 0] / 4)])
a = np.array([6 * i + j for i in range(11) for j in range(5)])
faces = np.column_stack([a, a + 6, a + 7, a + 1])
asset = pliant.bake([flat, rolled], faces, names=["flat", "rolled"])
asset.save("sheet.pliant")
half = asset.blend([0.5, 0.5])
print(asset, "half rolled, the sheet is", round(float(np.ptp(half[:, 0])), 2), "long")
