"""limbs.py TOOL [--energy shells|default]: whether limbs keep their length and girth in the unreduced average of all poses,
as a Markdown table on standard output; continuity.md has it. A plane cuts a limb of the first pose in a ring; the same
points of the edges are followed into every pose. Girth: the length of a ring. Length: between the centroids of two rings.
Both in per cent of the mean of the poses. Data: PLIANT_DATA; sets that are not there are left out."""
import argparse
import os
import sys

import numpy as np

from continuity import DATA, ENERGIES, average_of_all, files, line

HEAD = ["set", "limb", "length, %", "girth near the body, %", "girth near the end, %"]
ARM, LEG = 0, 1  # along the coordinate axes of the first pose
# Name, poses, limbs: axis, the two planes, and the other two coordinates of a point near the limb, in the file's units.
SETS = [
    ("makehuman, 4 poses", files("makehuman_body", "tpose", "dance1_f00", "walk1_f03", "zombieWalk1_f20"), [
        ("upper arm", ARM, 2.4, 3.4, (5.4, 0)), ("forearm", ARM, 4.6, 5.8, (5.4, 0)),
        ("thigh", LEG, -1.5, -3, (0.9, 0)), ("shin", LEG, -4.8, -6.5, (0.9, 0))]),
    ("human_pair", files("human_pair", "man", "woman"), [
        ("thigh", LEG, 0.7, 0.58, (0.09, 0)), ("shin", LEG, 0.36, 0.18, (0.1, 0)),
        ("upper arm", ARM, 0.26, 0.36, (1.4, 0)), ("forearm", ARM, 0.5, 0.66, (1.4, 0))]),
    ("mhr, 5 poses", files("mhr_body", "rest", "pose0", "pose1", "pose2", "pose3"), [
        ("thigh", LEG, 0.7, 0.58, (0.11, 0)), ("shin", LEG, 0.36, 0.17, (0.16, 0))]),
]


def cut(points, triangles, axis, offset, near):
    """The ring in which a plane cuts a surface, the one nearest to a point: edges, and where on them."""
    height = points[:, axis] - offset
    next_edges = {}
    for corners in triangles[(np.diff(np.sign(height[triangles]), axis=1) != 0).any(axis=1)]:
        sides = [tuple(sorted((corners[i], corners[i - 1]))) for i in range(3)]
        first, second = (side for side in sides if (height[side[0]] < 0) != (height[side[1]] < 0))
        next_edges.setdefault(first, []).append(second)
        next_edges.setdefault(second, []).append(first)
    rings = []
    while next_edges:
        ring, following = [], [next(iter(next_edges))]
        while following:
            ring.append(following[0])
            following = [edge for edge in next_edges.pop(ring[-1]) if edge in next_edges]
        edges = np.array(ring)
        share = height[edges[:, 0]] / (height[edges[:, 0]] - height[edges[:, 1]])
        rings.append((edges, share[:, None]))
    return min(rings, key=lambda ring: np.linalg.norm(follow(ring, points).mean(axis=0) - near))


def follow(ring, points):
    edges, share = ring
    return points[edges[:, 0]] * (1 - share) + points[edges[:, 1]] * share


def girth(ring, points):
    placed = follow(ring, points)
    return np.linalg.norm(placed - np.roll(placed, -1, axis=0), axis=1).sum()


def length(rings, points):
    first, second = (follow(ring, points).mean(axis=0) for ring in rings)
    return np.linalg.norm(first - second)


def change(values):
    """Of the last value, the average's, against the mean of the poses."""
    return f"{100 * (values[-1] / np.mean(values[:-1]) - 1):+.2f}"


def rows_of(name, shapes, triangles, limbs):
    for limb, axis, near_body, near_end, place in limbs:
        for side, name_of_side in ((1, "left"), (-1, "right")):
            planes = [side * plane if axis == ARM else plane for plane in (near_body, near_end)]
            points = [(plane, *place) if axis == ARM else (side * place[0], plane, place[1]) for plane in planes]
            rings = [cut(shapes[0], triangles, axis, plane, np.array(point)) for plane, point in zip(planes, points)]
            yield [name, f"{name_of_side} {limb}", change([length(rings, shape) for shape in shapes]),
                   *(change([girth(ring, shape) for shape in shapes]) for ring in rings)]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("tool")
    parser.add_argument("--energy", choices=list(ENERGIES), default="default")
    arguments = parser.parse_args()
    print(line(HEAD), line(["---"] * len(HEAD)), sep="\n")
    for name, patterns, limbs in SETS:
        poses = [str(DATA / pattern) for pattern in patterns]
        if not all(map(os.path.exists, poses)):
            continue
        found = average_of_all(arguments.tool, poses, ENERGIES[arguments.energy], len(poses))
        for row in rows_of(name, *found, limbs) if found else [[name, "no average", "-", "-", "-"]]:
            print(line(row), flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
