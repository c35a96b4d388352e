"""The control polygon of make_comparison_clip.py: weights, the path through the poses, and its panel.

Corners and weights are those of the player (samples/player/blend/control_polygon.cpp): corner 0 on top, then
counter-clockwise, and Wachspress coordinates.
"""
import colorsys
import math

POSES = 5
ORDER = [0, 2, 3, 1, 4]  # legs across the middle and along edges, so that blends of five poses and of two are seen
# How far the leg from each of these corners bends outward; at -1/3 its middle is the centre exactly.
PULL = [-1 / 3, 0.6, 0.2, 0.8, 0.6]
CORNERS = [(math.cos(a), math.sin(a)) for a in (math.pi / 2 + 2 * math.pi * k / POSES for k in range(POSES))]
TINTS = [tuple(round(255 * c) for c in colorsys.hsv_to_rgb((0.03 + k / POSES) % 1, 0.52, 0.93)) for k in range(POSES)]
BACKGROUND, INK = (247, 248, 251), (38, 42, 54)
OUTWARD = [(0, 1.4), (-1.3, 0), (-1.25, -0.4), (1.25, -0.4), (1.3, 0)]  # from corner to picture, in halves of the picture
OVERSAMPLING = 3  # Pillow draws hard edges: the panel is drawn larger and reduced
TINT_CELLS = 72  # along a side; the colours between are interpolated


def weights(point):
    """Wachspress coordinates of a point of the polygon; the areas at the corners of a regular polygon cancel out."""
    sides = []
    for (ax, ay), (bx, by) in zip(CORNERS, CORNERS[1:] + CORNERS[:1]):
        sides.append(max((bx - ax) * (point[1] - ay) - (by - ay) * (point[0] - ax), 1e-9))
    products = [math.prod(s for edge, s in enumerate(sides) if edge not in (k, (k - 1) % POSES)) for k in range(POSES)]
    return [product / sum(products) for product in products]


def point_at(phase):
    """The closed path, phase 0 to 1: a cubic Bezier curve from each corner to the next, slow at both."""
    leg, along = divmod(phase % 1 * POSES, 1)
    i = int(leg)
    t = 0.5 - 0.5 * math.cos(math.pi * along)
    u = 1 - t
    start = u * u * u + 3 * u * u * t * PULL[i]
    end = t * t * t + 3 * u * t * t * PULL[i]
    return tuple(start * a + end * b for a, b in zip(CORNERS[ORDER[i]], CORNERS[ORDER[(i + 1) % POSES]]))


def closed_path(steps):
    """Points of all frames, `steps` from one pose to the next; the frame after the last one is the first."""
    return [point_at(i / (POSES * steps)) for i in range(POSES * steps)]


def frames_at_poses(steps):
    """For each pose the frame that shows it alone."""
    return [ORDER.index(pose) * steps for pose in range(POSES)]


class Panel:
    def __init__(self, pillow, size, path, poses):
        """`poses`: one picture of each pose, for the corners."""
        self.image_module, self.draw_module, _ = pillow
        self.size, self.path = size, path
        self.large = tuple(OVERSAMPLING * side for side in size)
        self.radius = min(0.23 * self.large[0], 0.3 * self.large[1])
        self.centre = self.large[0] / 2, 0.57 * self.large[1]
        self.base = self.image_module.new("RGB", self.large, BACKGROUND)
        self.draw_tint()
        self.draw_outline()
        for corner, outward, tint, picture in zip(CORNERS, OUTWARD, TINTS, poses):
            self.draw_pose(corner, outward, tint, picture)

    def place(self, point):
        return self.centre[0] + self.radius * point[0], self.centre[1] - self.radius * point[1]

    def draw_tint(self):
        """Fills the polygon with the colours of the poses, mixed by the weights and paled."""
        cells = self.image_module.new("RGB", (TINT_CELLS, TINT_CELLS))
        for j in range(TINT_CELLS):
            for i in range(TINT_CELLS):
                shares = weights((2 * (i + 0.5) / TINT_CELLS - 1, 1 - 2 * (j + 0.5) / TINT_CELLS))
                mixed = (sum(w * tint[c] for w, tint in zip(shares, TINTS)) for c in range(3))
                cells.putpixel((i, j), tuple(round(0.55 * m + 0.45 * b) for m, b in zip(mixed, BACKGROUND)))
        left, top = (round(v) for v in self.place((-1, 1)))
        side = round(2 * self.radius)
        mask = self.image_module.new("L", self.large)
        self.draw_module.Draw(mask).polygon([self.place(corner) for corner in CORNERS], fill=255)
        self.base.paste(cells.resize((side, side)), (left, top), mask.crop((left, top, left + side, top + side)))

    def draw_outline(self):
        pen = self.draw_module.Draw(self.base, "RGBA")
        outline = [self.place(corner) for corner in CORNERS]
        pen.line(outline + outline[:1], fill=(*INK, 150), width=4, joint="curve")
        loop = [self.place(point_at(i / 400)) for i in range(401)]
        pen.line(loop, fill=(*INK, 60), width=3, joint="curve")

    def draw_pose(self, corner, outward, tint, picture):
        """The pose beside its corner, in a frame of its colour."""
        half = [0.105 * side for side in self.large]
        x, y = self.place(corner)
        x, y = x + outward[0] * half[0], y - outward[1] * half[1]
        box = [round(v) for v in (x - half[0], y - half[1], x + half[0], y + half[1])]
        size = box[2] - box[0], box[3] - box[1]
        mask = self.image_module.new("L", size)
        self.draw_module.Draw(mask).rounded_rectangle((0, 0, size[0] - 1, size[1] - 1), 15, fill=255)
        self.base.paste(picture.resize(size, self.image_module.LANCZOS), box[:2], mask)
        self.draw_module.Draw(self.base).rounded_rectangle(box, 15, outline=tint, width=6)

    def draw(self, frame):
        """The panel at one frame: the trail of the last leg and a half, and how much each pose counts."""
        picture = self.base.copy()
        pen = self.draw_module.Draw(picture, "RGBA")
        point = self.path[frame]
        for corner, tint, weight in zip(CORNERS, TINTS, weights(point)):
            pen.line([self.place(point), self.place(corner)], fill=(*INK, round(170 * weight)), width=4)
            self.dot(pen, corner, 11 + 14 * weight, tint)
        count = 3 * len(self.path) // (2 * POSES)
        trail = [self.place(self.path[frame - j]) for j in range(count, -1, -1)]
        for j, (a, b) in enumerate(zip(trail, trail[1:])):
            pen.line([a, b], fill=(204, 90, 56, round(230 * (j + 1) / count)), width=9)
        self.dot(pen, point, 19, (204, 90, 56))
        return picture.resize(self.size, self.image_module.LANCZOS)

    def dot(self, pen, point, radius, colour):
        x, y = self.place(point)
        pen.ellipse((x - radius, y - radius, x + radius, y + radius), fill=colour, outline="white", width=5)
