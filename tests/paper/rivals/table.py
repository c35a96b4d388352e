"""table.py -o TABLE [--pictures FOLDER] NAME=PREFIX...: what pliant_rivals wrote, as one Markdown table a set and one
picture a set. Of several weights the worst figure counts, of times the median.
"""
import argparse
import csv
import math
import statistics
import sys
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from shapes import align, lumped_masses, read_ply  # noqa: E402
from sheet import draw, view_matrix  # noqa: E402

HEAD = ["way", "strain", "volume", "limb length", "worst triangle", "from the elastic average", "seconds: set-up", "a shape"]
TRAITS = {"way": "way", "source": "source", "many_poses": "more than two poses", "order_free": "order-free",
          "fails_when": "fails when"}
SIZE = (240, 300)


def rows_of(prefix):
    """The ways in the order of the program, each with its rows."""
    ways = {}
    with open(f"{prefix}.csv", newline="") as file:
        for row in csv.DictReader(file):
            ways.setdefault(row["way"], []).append(row)
    return ways


def cells(way, rows):
    values = lambda name: [float(row[name]) for row in rows]
    percent = lambda value: "-" if math.isnan(value) else "0" if abs(value) < 1e-9 else f"{100 * value:.2g} %"
    volume = max(values("volume"), key=lambda v: abs(v) if not math.isnan(v) else 0)
    return [way, percent(max(values("strain"))), percent(volume), percent(max(values("limb_length"))),
            f"{min(values('worst_triangle')):.2g}", percent(max(values("from_elastic"))), f"{values('setup_s')[0]:.2g}",
            f"{statistics.median(values('shape_s')[1:] or values('shape_s')):.2g}"]  # the mean is part of a set-up


def markdown(head, rows):
    return "\n".join("| " + " | ".join(line) + " |" for line in [head, ["---"] * len(list(head)), *rows]) + "\n"


def table(name, prefix):
    return f"### {name}\n\n" + markdown(HEAD, [cells(way, rows) for way, rows in rows_of(prefix).items()])


def traits(prefixes):
    """What does not depend on the set, of all ways that any set has."""
    ways = {way: rows[0] for prefix in prefixes for way, rows in rows_of(prefix).items()}
    return markdown(TRAITS.values(), [[row[key] for key in TRAITS] for row in ways.values()])


def picture(prefix, up):
    """All ways at equal weights beside each other; red: where edges are a tenth or more too long or short."""
    view = view_matrix(np.radians(35), np.radians(12))
    if up == "z":
        view = view @ np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]])
    shapes = [(way, *read_ply(f"{prefix}_{way.replace(' ', '_')}.ply")) for way in rows_of(prefix)]
    reference, triangles = shapes[0][1:]
    masses = lumped_masses(reference, triangles)
    seen = reference @ view.T
    centre, extent = (seen.max(axis=0) + seen.min(axis=0)) / 2, (seen.max(axis=0) - seen.min(axis=0))[:2].max() * 1.15
    sheet = Image.new("RGB", (len(shapes) * SIZE[0], SIZE[1] + 20), (255, 255, 255))
    for i, (way, positions, _) in enumerate(shapes):
        colours = by_strain(positions, reference, triangles)
        drawn = draw(align(positions, reference, masses), triangles, colours, view, (centre[0], centre[1], extent), SIZE)
        sheet.paste(drawn, (i * SIZE[0], 20))
        ImageDraw.Draw(sheet).text((i * SIZE[0] + 6, 4), way, fill=(0, 0, 0))
    return sheet


def by_strain(positions, reference, triangles):
    """White to red by the mean strain of the edges round a vertex, against the elastic average."""
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    lengths = lambda x: np.maximum(np.linalg.norm(x[edges[:, 1]] - x[edges[:, 0]], axis=1), 1e-12)
    strain = np.abs(lengths(positions) / lengths(reference) - 1)
    count = np.maximum(np.bincount(edges.ravel(), minlength=len(positions)), 1)
    share = np.clip(np.bincount(edges.ravel(), np.repeat(strain, 2), len(positions)) / count / 0.1, 0, 1)[:, None]
    return (1 - share) * np.array([236, 232, 224]) + share * np.array([214, 40, 40])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("sets", nargs="+", metavar="NAME=PREFIX")
    parser.add_argument("-o", "--output", required=True, metavar="TABLE")
    parser.add_argument("--pictures", metavar="FOLDER", help="also NAME.png for every set")
    parser.add_argument("--z-up", action="append", default=[], metavar="NAME", help="sets whose z axis points up")
    options = parser.parse_args()
    pairs = [pair.split("=", 1) for pair in options.sets]
    tables = [traits([prefix for _, prefix in pairs]), *(table(name, prefix) for name, prefix in pairs)]
    Path(options.output).write_text("\n".join(["## Rivals\n", *tables]))
    for name, prefix in pairs if options.pictures else []:
        picture(prefix, "z" if name in options.z_up else "y").save(Path(options.pictures) / f"{name}.png", optimize=True)


if __name__ == "__main__":
    main()
