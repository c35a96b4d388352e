"""A contact sheet: one row per weight, one column per way to blend, the error under each picture.

    sheet.py --tool PLIANT -o SHEET.png --asset LABEL=FILE... --weights W1,W2,... [--weights ...] POSE...

The first column is the linear blend of the aligned poses, the last one the unreduced average; those between are the assets'
blends through the C runtime. Errors are relative L2 and the farthest vertex in per cent of the diagonal. Colour in the error
columns' pictures: distance from the unreduced average, white none, red --scale (share of the diagonal) and more.
"""
import argparse
import csv
import subprocess
import tempfile
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from shapes import align, diagonal_of, largest_distance, lumped_masses, read_ply, relative_l2

OVERSAMPLING = 3  # pictures are drawn three times as large and reduced: smooth edges from hard ones


def view_matrix(turn, tilt):
    """Rows: right, up, towards the eye, of a world whose y is up."""
    c, s, ct, st = np.cos(turn), np.sin(turn), np.cos(tilt), np.sin(tilt)
    return np.array([[1, 0, 0], [0, ct, -st], [0, st, ct]]) @ np.array([[c, 0, -s], [0, 1, 0], [s, 0, c]])


def vertex_normals(positions, triangles):
    a, b, c = (positions[triangles[:, i]] for i in range(3))
    face_normals = np.cross(b - a, c - a)
    normals = np.zeros_like(positions)
    for corner in range(3):
        np.add.at(normals, triangles[:, corner], face_normals)
    return normals / np.maximum(np.linalg.norm(normals, axis=1), 1e-30)[:, None]


def draw(positions, triangles, colours, view, window, size):
    """Triangles from back to front, shaded by a light at the eye's upper left.
    `window`: (left, bottom, extent) in view units."""
    width, height = (OVERSAMPLING * s for s in size)
    seen = positions @ view.T
    scale = min(width, height) / window[2]
    x = (seen[:, 0] - window[0]) * scale + width / 2
    y = height / 2 - (seen[:, 1] - window[1]) * scale
    normals = vertex_normals(seen, triangles)
    light = np.array([-0.4, 0.6, 0.7]) / np.linalg.norm([-0.4, 0.6, 0.7])
    brightness = 0.35 + 0.65 * np.clip(normals @ light, 0, 1)
    shade = (colours * brightness[:, None])[triangles].mean(axis=1).clip(0, 255).astype(np.uint8)
    picture = Image.new("RGB", (width, height), (250, 250, 250))
    pen = ImageDraw.Draw(picture)
    corners = np.stack([x[triangles], y[triangles]], axis=2)
    area = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    front = np.flatnonzero(area < 0)  # the picture's y points down
    for f in front[np.argsort(seen[triangles[front], 2].max(axis=1))]:
        pen.polygon([tuple(p) for p in corners[f]], fill=tuple(int(v) for v in shade[f]))
    return picture.resize(size, Image.LANCZOS)


def blend_shapes(tool, poses, assets, weights, continuity):
    """(label, positions) of every column."""
    base = [read_ply(path) for path in poses]
    masses = np.mean([lumped_masses(*pose) for pose in base], axis=0)
    aligned = [align(pose, base[0][0], masses) for pose, _ in base]
    shares = np.array(weights) / sum(weights)
    columns = [("linear", sum(w * pose for w, pose in zip(shares, aligned)))]
    text = ",".join(repr(w) for w in weights)
    with tempfile.TemporaryDirectory(prefix="pliant_sheet_") as folder:
        target = str(Path(folder, "shape.ply"))
        for label, path in assets:
            subprocess.run([tool, "blend", path, "--weights", text, "-o", target], check=True, stdout=subprocess.DEVNULL)
            columns.append((label, read_ply(target)[0]))
        subprocess.run([tool, "average", *poses, "--weights", text, "-o", target, "--quiet", "--continuity", continuity],
                       check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        columns.append(("unreduced", read_ply(target)[0]))
    return columns, base[0][1], masses, aligned


def coloured(shape, truth, masses, diagonal, scale):
    off = np.linalg.norm(align(truth, shape, masses) - shape, axis=1) / diagonal
    share = np.clip(off / scale, 0, 1)[:, None]
    return (1 - share) * np.array([236, 232, 224]) + share * np.array([214, 40, 40])


def main():
    parser = argparse.ArgumentParser(description="contact sheet of blends",
                                     formatter_class=argparse.ArgumentDefaultsHelpFormatter)
    parser.add_argument("poses", nargs="+")
    parser.add_argument("--tool", required=True, help="the program pliant")
    parser.add_argument("-o", "--output", required=True)
    parser.add_argument("--asset", action="append", default=[], help="LABEL=FILE")
    parser.add_argument("--weights", action="append", required=True, help="one row of the sheet")
    parser.add_argument("--size", default="300x330")
    parser.add_argument("--turn", type=float, default=35, help="degrees round the vertical")
    parser.add_argument("--tilt", type=float, default=12, help="degrees from above")
    parser.add_argument("--up", choices="yz", default="y", help="axis of the files that points up")
    parser.add_argument("--scale", type=float, default=0.03, help="distance that is drawn red, of the diagonal")
    parser.add_argument("--continuity", choices=["auto", "off"], default="auto", help="of the average, as of the assets")
    parser.add_argument("--title", default="")
    options = parser.parse_args()
    size = tuple(int(n) for n in options.size.split("x"))
    view = view_matrix(np.radians(options.turn), np.radians(options.tilt))
    if options.up == "z":  # (x, y, z) of the file as (x, z, -y) of the view
        view = view @ np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]])
    assets = [pair.split("=", 1) for pair in options.asset]
    font_path = Path("/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf")
    font = ImageFont.truetype(str(font_path), 13) if font_path.exists() else ImageFont.load_default()

    rows, table = [], []
    for text in options.weights:
        weights = [float(w) for w in text.split(",")]
        columns, triangles, masses, aligned = blend_shapes(options.tool, options.poses, assets, weights, options.continuity)
        diagonal, truth = diagonal_of(aligned[0]), columns[-1][1]
        seen = truth @ view.T
        centre, extent = (seen.max(axis=0) + seen.min(axis=0)) / 2, (seen.max(axis=0) - seen.min(axis=0))[:2].max() * 1.12
        cells = []
        for label, shape in columns:
            shown = align(shape, truth, masses)
            error = relative_l2(shape, truth, masses), largest_distance(shape, truth, masses, diagonal)
            colours = coloured(shape, truth, masses, diagonal, options.scale)
            cells.append((label, draw(shown, triangles, colours, view, (centre[0], centre[1], extent), size), error))
            if label != "unreduced":
                table.append([text, label, f"{error[0]:.3e}", f"{100 * error[1]:.3f}"])
        rows.append((text, cells))

    head, foot, margin = 44, 40, 6
    count = len(rows[0][1])
    sheet = Image.new("RGB", (count * (size[0] + margin) + margin, head + len(rows) * (size[1] + foot)), (255, 255, 255))
    pen = ImageDraw.Draw(sheet)
    pen.text((margin, 4), options.title, font=font, fill=(0, 0, 0))
    for r, (text, cells) in enumerate(rows):
        top = head + r * (size[1] + foot)
        for c, (label, picture, error) in enumerate(cells):
            left = margin + c * (size[0] + margin)
            if r == 0:
                pen.text((left, 24), label, font=font, fill=(0, 0, 0))
            sheet.paste(picture, (left, top))
            caption = f"w = {text}" if label == "unreduced" else f"L2 {error[0]:.1e}, farthest {100 * error[1]:.2f} %"
            pen.text((left, top + size[1] + 4), caption, font=font, fill=(60, 60, 60))
    sheet.save(options.output)
    with open(Path(options.output).with_suffix(".csv"), "w", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows([["weights", "blend", "relative_l2", "farthest_percent"], *table])


if __name__ == "__main__":
    main()
