"""Tables (CSV and Markdown) and plots (PNG) of a study folder: tables.py DIR

Reads what pliant_study wrote (SET_subspace.csv, SET_assets.csv, SET_cubatures.csv) and pliant_bar (bar.csv). Plots need
matplotlib; without it tables are written all the same.
"""
import csv
import sys
import textwrap
from collections import defaultdict
from pathlib import Path

import numpy as np

try:
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot
except ImportError:
    pyplot = None

# Fixed places in every plot: names, colours, order of the legend.
BASES = {"adaptive": ("adaptive", "#1b6ca8"), "krylov": ("Algorithm 1 (krylov)", "#d1495b"),
         "krylov_differences": ("Krylov of differences", "#8e6bbf"), "barbic": ("Barbic et al. 2009", "#edae49"),
         "pod": ("POD of true averages", "#66a182")}
QUARTERS = (0.25, 0.5, 0.75)
# Table III of the paper: {(model, d): % at the quarters}, its reduced averages against unreduced ones.
PAPER_HAUSDORFF = {("Dinosaur, StVK", 3): (1.87, 7.96, 9.17), ("Dinosaur, StVK", 9): (0.49, 0.87, 1.63),
                   ("Dinosaur, StVK", 17): (0.38, 0.69, 0.49), ("Chinese dragon, DS", 3): (1.16, 1.73, 1.46),
                   ("Chinese dragon, DS", 9): (0.59, 0.82, 0.59), ("Chinese dragon, DS", 17): (0.18, 0.24, 0.17)}


def read(path):
    with open(path, newline="") as file:
        rows = list(csv.DictReader(file))
    return [{**row, "w": [float(v) for v in row["weights"].split(";")]} if "weights" in row else row for row in rows]


def write_table(path, title, note, header, rows):
    with open(path.with_suffix(".csv"), "w", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows([header, *rows])
    line = lambda cells: "| " + " | ".join(str(c) for c in cells) + " |\n"
    path.with_suffix(".md").write_text(f"## {title}\n\n{textwrap.fill(note, 99)}\n\n" + line(header)
                                       + line(["---"] * len(header)) + "".join(map(line, rows)))


def by_basis(rows):
    """{(basis, d): rows}, in the order of the file."""
    groups = defaultdict(list)
    for row in rows:
        groups[row["basis"], int(row["d"])].append(row)
    return groups


def column(rows, name):
    return np.array([float(row[name]) for row in rows])


def error_over_d(out, name, rows):
    groups = by_basis(rows)
    header = ["basis", "d", "L2 mean", "L2 largest", "farthest % mean", "farthest % largest", "best possible L2 mean",
              "weights"]
    table = [[basis, d, f"{column(g, 'solved_l2').mean():.2e}", f"{column(g, 'solved_l2').max():.2e}",
              f"{100 * column(g, 'solved_distance').mean():.3f}", f"{100 * column(g, 'solved_distance').max():.3f}",
              f"{column(g, 'projected_l2').mean():.2e}", len(g)] for (basis, d), g in groups.items()]
    write_table(out / f"{name}_error_over_d", f"{name}: error of the subspace over d",
                "Exact reduced averages (no surrogate energy) against unreduced ones at fresh weights; "
                "farthest vertex in % of the bounding-box "
                "diagonal; best possible: distance of the truth from the subspace.", header, table)
    if pyplot:
        figure, axes = pyplot.subplots(figsize=(6, 4.2))
        for basis, (label, colour) in BASES.items():
            points = sorted((d, g) for (b, d), g in groups.items() if b == basis)
            if points:
                dims = [d for d, _ in points]
                axes.semilogy(dims, [column(g, "solved_l2").mean() for _, g in points], "o-", color=colour, label=label)
                axes.semilogy(dims, [column(g, "solved_l2").max() for _, g in points], ":", color=colour)
        linear = column(next(g for (b, _), g in groups.items() if b == "linear"), "solved_l2")
        axes.axhline(linear.mean(), color="#888888", linestyle="--", linewidth=1, label="linear blend")
        axes.set(xlabel="dimension d", ylabel="relative L2 (line: mean, dots: largest)",
                 title=f"{name}: error of the subspace")
        finish(figure, axes, out / f"{name}_error_over_d.png")


def share_of_second(row):
    return row["w"][1] / sum(row["w"])


def error_over_w(out, name, rows):
    """The paper's Figure 6: two poses, one curve per basis and dimension."""
    groups = by_basis(rows)
    header = ["basis", "d", *(f"w = {share_of_second(row):.3g}" for row in next(iter(groups.values())))]
    table = [[basis, d, *(f"{v:.2e}" for v in column(g, "solved_l2"))] for (basis, d), g in groups.items()]
    write_table(out / f"{name}_error_over_w", f"{name}: error over w",
                "Relative L2 of exact reduced averages; w is the weight of the "
                "second pose. As the paper's Figure 6.", header, table)
    if pyplot:
        figure, axes = pyplot.subplots(figsize=(6, 4.2))
        for (basis, d), group in groups.items():
            dims = [other for b, other in groups if b == basis]
            if basis in BASES and d in (dims[0], dims[-1]):
                label, colour = BASES[basis]
                axes.semilogy([share_of_second(row) for row in group], column(group, "solved_l2"),
                              "-" if d == dims[-1] else "--", color=colour, label=f"{label}, d = {d}")
        axes.set(xlabel="weight of the second pose", ylabel="relative L2", title=f"{name}: error over w")
        finish(figure, axes, out / f"{name}_error_over_w.png")


def hausdorff(out, sets):
    """The paper's Table III. The largest distance of corresponding vertices bounds the Hausdorff distance from above."""
    header = ["set", "basis", "d", *(f"w = {w}" for w in QUARTERS)]
    paper = [[f"the paper's {model}", "Algorithm 1", d, *at] for (model, d), at in PAPER_HAUSDORFF.items()]
    table = []
    for name, rows in sets.items():
        for (basis, d), group in by_basis(rows).items():
            at = {round(share_of_second(row), 6): row for row in group}
            if all(w in at for w in QUARTERS):
                table.append([name, basis, d, *(f"{100 * float(at[w]['solved_distance']):.3f}" for w in QUARTERS)])
    if table:
        write_table(out / "hausdorff", "Distances in % of the bounding-box diagonal (the paper's Table III)",
                    "Ours: largest distance of corresponding vertices after rigid alignment, an upper bound of the "
                    "Hausdorff distance that the paper gives. Subspace alone.", header, paper + table)


def stand_in(out, name, rows):
    groups = defaultdict(list)
    for row in rows:
        groups[row["asset"]].append(row)
    header = ["asset", "d", "elements", "total L2 mean", "total largest", "subspace mean", "surrogate energy mean",
              "surrogate energy largest", "farthest % largest", "iterations"]
    table = [[asset, g[0]["d"], g[0]["elements"], f"{column(g, 'total_l2').mean():.2e}",
              f"{column(g, 'total_l2').max():.2e}",
              f"{column(g, 'subspace_l2').mean():.2e}", f"{column(g, 'stand_in_l2').mean():.2e}",
              f"{column(g, 'stand_in_l2').max():.2e}",
              f"{100 * column(g, 'total_distance').max():.3f}", f"{column(g, 'iterations').mean():.1f}"]
             for asset, g in groups.items()]
    write_table(out / f"{name}_stand_in", f"{name}: error of the surrogate energy over its elements",
                "The runtime's blends. total: against unreduced averages; "
                "subspace: exact reduced averages against unreduced; surrogate energy: "
                "blends against exact reduced averages.", header, table)
    if pyplot:
        figure, axes = pyplot.subplots(figsize=(6, 4.2))
        for kind, colour in (("cubature", "#1b6ca8"), ("ghost", "#d1495b")):
            points = sorted(((int(g[0]["elements"]), g) for asset, g in groups.items() if asset.startswith(kind)),
                            key=lambda point: point[0])
            if points:
                counts = [n for n, _ in points]
                axes.loglog(counts, [column(g, "stand_in_l2").mean() for _, g in points], "o-", color=colour,
                            label=f"{kind}, surrogate energy alone")
                axes.loglog(counts, [column(g, "total_l2").mean() for _, g in points], "x:", color=colour,
                            label=f"{kind}, total")
        first = next(iter(groups.values()))
        axes.axhline(column(first, "subspace_l2").mean(), color="#888888", linestyle="--", linewidth=1,
                     label="subspace alone")
        axes.set(xlabel="elements", ylabel="relative L2, mean",
                 title=f"{name}: error of the surrogate energy, d = {first[0]['d']}")
        finish(figure, axes, out / f"{name}_stand_in.png")


def cubatures(out, name, rows):
    """The paper's cubature (a set of elements for every pose, trained on poses around it) beside one set for all poses."""
    groups = defaultdict(list)
    for row in rows:
        groups[row["cubature"], row["elements"]].append(row)
    header = ["cubature", "elements", "training s", "surrogate energy mean", "largest", "total mean", "largest",
              "steps, H_0 at the mean", "steps, H_0 averaged"]
    error = lambda g, key: [f"{column(g, key).mean():.2e}", f"{column(g, key).max():.2e}"]
    steps = lambda g: [f"{column(g, f'iterations_h0_{kind}').mean():.1f}" for kind in ("at_mean", "averaged")]
    table = [[way, elements, f"{float(g[0]['training_s']):.1f}", *error(g, "surrogate_l2"), *error(g, "total_l2"), *steps(g)]
             for (way, elements), g in groups.items()]
    write_table(out / f"{name}_cubature", f"{name}: one cubature per pose, or one for all, d = {rows[0]['d']}",
                "Relative L2 in the subspace of Algorithm 1. Per pose: the paper's protocol, three points per dimension for "
                "every pose, trained on 1,000 poses drawn around it. Joint: trained on reduced averages. Surrogate energy: "
                "blends against exact reduced averages; total: against unreduced ones. Steps of BFGS from the mean, with "
                "the paper's H_0 and with the Hessian averaged over weights.", header, table)


def bars(out, rows):
    """The paper's Table II, and its Figure 6 as a plot."""
    groups = defaultdict(list)
    for row in rows:
        groups[row["basis"], int(row["d"]), float(row["degrees"])].append(row)
    angles = sorted({key[2] for key in groups})
    header = ["basis", "d"] + [f"{angle:g} degrees, {what}" for angle in angles for what in ("mean", "paper", "largest")]
    paper = lambda g: float(g[0]["paper_mean_1e4"]) or None
    line = lambda g: [f"{1e4 * column(g, 'relative_l2').mean():.3g}", f"{paper(g):g}" if paper(g) else "-",
                      f"{1e4 * column(g, 'relative_l2').max():.3g}"]
    table = [[basis, d, *(cell for angle in angles for cell in line(groups[basis, d, angle]))]
             for basis, d in dict.fromkeys(key[:2] for key in groups)]
    write_table(out / "table2", "Table II: a twisted bar, relative L2 in 1e-4",
                f"Bars of St. Venant-Kirchhoff material at {len(next(iter(groups.values())))} weights, exact reduced "
                "averages against unreduced ones, beside the paper's means.", header, table)
    if pyplot:
        figure, panels = pyplot.subplots(1, len(angles), figsize=(5 * len(angles), 4.2), sharey=True, squeeze=False)
        for axes, angle in zip(panels[0], angles):
            for (basis, label, colour) in (("Algorithm 1", *BASES["krylov"]), ("Barbic et al.", *BASES["barbic"]),
                                           ("adaptive", *BASES["adaptive"])):
                dims = [d for b, d, a in groups if b == basis and a == angle]
                for d, style in zip(dims, (":", "--", "-")):
                    g = groups[basis, d, angle][1:-1]  # the poses themselves have no error
                    axes.semilogy(column(g, "weight"), column(g, "relative_l2"), style, color=colour,
                                  label=f"{label}, d = {d}")
            axes.set(xlabel="weight of the twisted bar", ylabel="relative L2", title=f"bar, {angle:g} degrees")
            axes.grid(True, which="major", color="#dddddd", linewidth=0.6)
        finish(figure, panels[0][-1], out / "table2.png")  # below the curves of the last one there is room


def finish(figure, axes, path):
    axes.grid(True, which="major", color="#dddddd", linewidth=0.6)
    axes.legend(fontsize=8)
    figure.tight_layout()
    figure.savefig(path, dpi=140)
    pyplot.close(figure)


def main(folder):
    subspaces = {path.name[:-len("_subspace.csv")]: read(path) for path in sorted(folder.glob("*_subspace.csv"))}
    for name, rows in subspaces.items():
        error_over_d(folder, name, rows)
    pairs = {name: rows for name, rows in subspaces.items() if len(rows[0]["w"]) == 2}
    for name, rows in pairs.items():
        error_over_w(folder, name, rows)
    hausdorff(folder, pairs)
    for path in sorted(folder.glob("*_assets.csv")):
        stand_in(folder, path.name[:-len("_assets.csv")], read(path))
    for path in sorted(folder.glob("*_cubatures.csv")):
        cubatures(folder, path.name[:-len("_cubatures.csv")], read(path))
    if (folder / "bar.csv").exists():
        bars(folder, read(folder / "bar.csv"))
    parts = sorted(path for path in folder.glob("*.md") if path.stem != "study")
    (folder / "study").with_suffix(".md").write_text("# Study\n\n" + "\n".join(path.read_text() for path in parts))
    if not pyplot:
        print("tables.py: no plots, matplotlib is missing: apt-get install python3-matplotlib", file=sys.stderr)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
