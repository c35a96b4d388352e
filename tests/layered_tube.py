"""A small tube with two layers, for tests that bake it: a twist of its lowest third and a bend of its highest third. They
fit together, so that the exact shape at any strength of both is known. Without other packages."""
import math

RINGS, SIDES = 13, 8
FACES = [face for r in range(RINGS - 1) for s in range(SIDES)
         for a, b in [(r * SIDES + s, r * SIDES + (s + 1) % SIDES)]
         for face in [(a, b, b + SIDES), (a, b + SIDES, a + SIDES)]]


def tube(twist, bend):
    """Its vertices, with the z axis from 0 to 6; angles in radians."""
    points = []
    for r in range(RINGS):
        for s in range(SIDES):
            around, z = 2 * math.pi * s / SIDES, 6 * r / (RINGS - 1)
            x, y = 0.7 * math.cos(around), 0.5 * math.sin(around)
            if z > 4 and bend:
                radius, phi = 2 / bend, bend * (z - 4) / 2
                x, z = radius - (radius - x) * math.cos(phi), 4 + (radius - x) * math.sin(phi)
            turn = twist * min(6 * r / (RINGS - 1), 2) / 2
            points.append((math.cos(turn) * x - math.sin(turn) * y, math.sin(turn) * x + math.cos(turn) * y, z))
    return points


def write_obj(path, points):
    lines = ["v %r %r %r" % p for p in points] + ["f %d %d %d" % tuple(i + 1 for i in f) for f in FACES]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
