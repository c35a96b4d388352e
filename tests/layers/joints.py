"""Bends of limbs by formula. The limb beyond a plane is bent as a tube is: over a zone its centre line becomes an arc of a
circle and keeps its length, beyond the zone it moves rigidly. Nothing else moves."""
from dataclasses import dataclass, replace

import numpy as np

MIRROR = np.array([-1, 1, 1])


@dataclass(frozen=True)
class Joint:
    name: str
    end: tuple  # a point at the far end of the limb
    start: tuple  # a point of the centre line, in the plane where the zone starts
    along: tuple  # the direction of the limb, from the body to the far end
    towards: tuple  # where the far end goes
    length: float  # of the zone
    degrees: float


def mirrored(joint, name):
    """The same joint of the other side."""
    flip = lambda vector: tuple(MIRROR * vector)
    return replace(joint, name=name, end=flip(joint.end), start=flip(joint.start), along=flip(joint.along),
                   towards=flip(joint.towards))


def directions(joint):
    """Unit vectors: along the limb, and at right angles to it where the far end goes."""
    along = np.array(joint.along, float) / np.linalg.norm(joint.along)
    towards = joint.towards - along * (along @ joint.towards)
    return along, towards / np.linalg.norm(towards)


def limb_of(joint, points, triangles):
    """Which vertices are in the limb: those connected with its far end on that side of the plane."""
    along, _ = directions(joint)
    beyond = (points - joint.start) @ along > 0
    limb = np.zeros(len(points), bool)
    limb[np.linalg.norm(points - joint.end, axis=1).argmin()] = True
    count = 0
    while count < limb.sum():
        count = limb.sum()
        limb[triangles[limb[triangles].any(axis=1)]] = True
        limb &= beyond
    return limb


def shares(joint, points, triangles):
    """How far in the zone each vertex lies: 0 at its start and outside the limb, 1 beyond its end."""
    along, _ = directions(joint)
    return np.where(limb_of(joint, points, triangles), ((points - joint.start) @ along / joint.length).clip(0, 1), 0)


def bent(joint, points, share, weight):
    """Points after the motions that belong to their shares. Where the share is 1 it is one rigid motion, so points that
    have moved before, as a forearm at the elbow, can be given."""
    along, towards = directions(joint)
    angle = np.radians(joint.degrees) * weight * share[:, None]
    foot = joint.start + joint.length * share[:, None] * along
    # sin a / a and (1 - cos a) / a, also at 0
    arc = np.sinc(angle / np.pi) * along + np.sin(angle / 2) * np.sinc(angle / 2 / np.pi) * towards
    offset = points - foot
    u, v = (offset @ along)[:, None], (offset @ towards)[:, None]
    turned = (offset + (np.cos(angle) - 1) * (u * along + v * towards) + np.sin(angle) * (u * towards - v * along))
    return np.where(share[:, None] > 0, joint.start + joint.length * share[:, None] * arc + turned, points)
