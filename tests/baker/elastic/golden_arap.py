"""golden_arap.py: writes the numbers of ARAP into golden_shells.h, for the meshes that stand there. Needs mpmath,
numpy and scipy.

Independent of the baker: cells are sums over triangles here (Chao, Pinkall, Sanan, Schroeder 2010), not fans with spokes and
rims; gradients and Hessian products are difference quotients with 60 digits; averages are minimised in double precision."""
import ast
import pathlib
import textwrap

import mpmath
import numpy
import scipy.optimize

HEADER = pathlib.Path(__file__).parent / "golden_shells.h"
STEP = mpmath.mpf("1e-15")  # of quotients; their error is its square
mpmath.mp.dps = 60


def cells_of(faces, count):
    """Per vertex, the triangles around it."""
    return [[face for face in faces if vertex in face] for vertex in range(count)]


def terms_of(triangles, pose):
    """c, edge start, edge end of all edges of the triangles: c is half the cotangent of the angle in the triangle."""
    out = []
    for triangle in triangles:
        for corner in range(3):
            at, start, end = (triangle[(corner + i) % 3] for i in range(3))
            u = [pose[start][c] - pose[at][c] for c in range(3)]
            v = [pose[end][c] - pose[at][c] for c in range(3)]
            dot = sum(a * b for a, b in zip(u, v))
            area2 = mpmath.sqrt(sum(a * a for a in u) * sum(b * b for b in v) - dot * dot)
            out.append((dot / area2 / 2, start, end))
    return out


def cell_energy(terms, pose, y):
    """min over rotations R of sum c |e(y) - R e(pose)|^2, by singular values: c |e|^2 + c |e'|^2 - 2 max tr(R^T M)."""
    squares, moment = mpmath.mpf(0), mpmath.zeros(3)
    for c, start, end in terms:
        e = [y[end][i] - y[start][i] for i in range(3)]
        rest = [pose[end][i] - pose[start][i] for i in range(3)]
        squares += c * (sum(a * a for a in e) + sum(a * a for a in rest))
        for i in range(3):
            for j in range(3):
                moment[i, j] += c * e[i] * rest[j]
    values = sorted(mpmath.svd_r(moment, compute_uv=False), reverse=True)
    sign = 1 if mpmath.det(moment) >= 0 else -1
    return squares - 2 * (values[0] + values[1] + sign * values[2])


class Problem:
    def __init__(self, faces, poses):
        self.faces = [faces[i:i + 3] for i in range(0, len(faces), 3)]
        self.poses = [self.points(pose) for pose in poses]
        self.cells = cells_of(self.faces, len(self.poses[0]))
        self.terms = [[terms_of(cell, pose) for cell in self.cells] for pose in self.poses]

    @staticmethod
    def points(values):
        return [[mpmath.mpf(v) for v in values[i:i + 3]] for i in range(0, len(values), 3)]

    def energy(self, k, y, cells=None):
        chosen = range(len(self.cells)) if cells is None else cells
        return sum(cell_energy(self.terms[k][i], self.poses[k], y) for i in chosen)

    def weighted(self, weights, y, cells=None):
        return sum(w * self.energy(k, y, cells) for k, w in enumerate(weights) if w)

    def gradient(self, weights, y):
        out = []
        for vertex in range(len(y)):
            touched = {corner for face in self.cells[vertex] for corner in face}
            for c in range(3):
                ends = []
                for sign in (1, -1):
                    moved = [list(point) for point in y]
                    moved[vertex][c] += sign * STEP
                    ends.append(self.weighted(weights, moved, touched))
                out.append((ends[0] - ends[1]) / (2 * STEP))
        return out

    def hessian_product(self, weights, y, direction):
        ends = []
        # Wider than the step inside, whose error this one divides.
        wide = mpmath.mpf("1e-10")
        for sign in (1, -1):
            moved = [[y[v][c] + sign * wide * direction[v][c] for c in range(3)] for v in range(len(y))]
            ends.append(self.gradient(weights, moved))
        return [(a - b) / (2 * wide) for a, b in zip(*ends)]

    def average(self, weights):
        """In double precision, from pose 0, with the rotations' derivative left out of the gradient as it vanishes."""
        terms = [[(numpy.array([float(c) for c, _, _ in cell]), numpy.array([[a, b] for _, a, b in cell])) for cell in cells]
                 for cells in self.terms]
        poses = numpy.array([[[float(c) for c in point] for point in pose] for pose in self.poses])

        def value_and_gradient(flat):
            y, value, gradient = flat.reshape(-1, 3), 0.0, numpy.zeros((len(flat) // 3, 3))
            for k, weight in enumerate(weights):
                for c, edges in terms[k]:
                    e, rest = y[edges[:, 1]] - y[edges[:, 0]], poses[k][edges[:, 1]] - poses[k][edges[:, 0]]
                    left, _, right = numpy.linalg.svd((e * c[:, None]).T @ rest)
                    left[:, 2] *= numpy.sign(numpy.linalg.det(left @ right))
                    off = e - rest @ (left @ right).T
                    value += weight * (c * (off ** 2).sum(axis=1)).sum()
                    force = 2 * weight * c[:, None] * off
                    numpy.add.at(gradient, edges[:, 1], force)
                    numpy.add.at(gradient, edges[:, 0], -force)
            return value, gradient.ravel()

        x = scipy.optimize.minimize(value_and_gradient, poses[0].ravel(), jac=True, method="BFGS",
                                    options={"gtol": 1e-9, "maxiter": 5000}).x
        for _ in range(6):  # Newton, with the six rigid motions left out by the pseudoinverse
            hessian = numpy.array([(value_and_gradient(x + 1e-6 * unit)[1] - value_and_gradient(x - 1e-6 * unit)[1]) / 2e-6
                                   for unit in numpy.eye(len(x))])
            x = x - numpy.linalg.pinv((hessian + hessian.T) / 2, rcond=1e-6) @ value_and_gradient(x)[1]
        return x, value_and_gradient(x)[0]


def braces(value):
    return "{" + ", ".join(braces(v) if isinstance(v, (list, tuple)) else repr(float(v)) for v in value) + "}"


def entry(case):
    _, faces, poses, config, weights, direction, models = case
    problem = Problem(faces, poses)
    y, along = problem.points(config), problem.points(direction)
    count = len(poses)
    exact = [mpmath.mpf(w) for w in weights]
    print(case[0], flush=True)
    had_average = next(model for model in models if model[0] == "arap")[5]
    average, average_energy = problem.average(weights) if len(had_average) else ([], 0)
    parts = [[problem.energy(k, y) for k in range(count)], problem.gradient(exact, y),
             problem.hessian_product(exact, y, along),
             [[problem.energy(k, problem.poses[j]) for j in range(count)] for k in range(count)], average]
    lines = [textwrap.fill(braces(part), 110, subsequent_indent=" " * 9, break_on_hyphens=False) for part in parts]
    return '{"arap", ' + ",\n         ".join(lines) + f", {float(average_energy)!r}}}"


def end_of(text, start):
    """Behind the brace that closes the one at `start`."""
    depth = 0
    for at in range(start, len(text)):
        depth += {"{": 1, "}": -1}.get(text[at], 0)
        if depth == 0:
            return at + 1
    raise ValueError("a brace is not closed")


def main():
    text = HEADER.read_text(encoding="utf-8")
    start = text.index("return {") + len("return ")
    cases = ast.literal_eval(text[start:end_of(text, start)].replace("{", "[").replace("}", "]"))
    at = start
    for case in cases:
        at = text.index('{"arap",', at)
        new = entry(case)
        text = text[:at] + new + text[end_of(text, at):]
        at += len(new)
    HEADER.write_text(text, encoding="utf-8")


main()
