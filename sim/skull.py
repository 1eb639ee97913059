"""Bones and eyeballs: their places at rest, and their motion by jaw and gaze values.

Skin is simulated in coordinates of the cranium. The pose of the head turns the result as a whole
about the joint with the spine. The mandible turns about the axis through both condyles and glides
with them; a weight divides each skin vertex between cranium and mandible. Eyeballs turn in place.
These rigid degrees of freedom are controls beside the muscles: no spring moves a bone. bones.py has
the current poses.

Source: Kähler et al. 2001, section 3 (skull and rotating jaw under the skin). Differs from it: the
condyles also glide (a real jaw opens by turning and sliding), and the jaw also moves forward and
sideways; to move to one side, it turns about the condyle of that side.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple, TypeVar

import numpy as np

from ..geometry.arrays import Floats64
from ..geometry.read_only import read_only
from ..geometry.vectors import Vector, plus, rotated, vector_of
from ..jit import njit
from .coordinates import FaceSpace
from .landmarks import EYE_LANDMARKS, MIRRORED_LANDMARKS, UPPER_LIP_MIDDLE, Side
from .rig import Eyes, HeadJoint, Jaw, Triple
from .surface import SkinSurface

HEAD_CONTROLS = ("head_pitch", "head_yaw", "head_roll")
HEAD_RATE = 30.0  # rad/s: chosen so that nods of 2 Hz keep 85 % of their size, 63 ms late
LATERAL_AXIS = (1.0, 0.0, 0.0)
UP_AXIS = (0.0, 1.0, 0.0)

Numbers = TypeVar("Numbers", float, Floats64)


class RigidMotion(NamedTuple):
    """A rigid motion x -> rotation x + shift in the standard space [mm]."""

    rotation: Floats64  # (3, 3)
    shift: Floats64  # (3,)

    @classmethod
    def frozen(cls, rotation: Floats64, shift: Floats64) -> RigidMotion:
        """Return a motion with read-only arrays, because several faces may share it."""
        return cls(read_only(rotation), read_only(shift))

    @classmethod
    def about(cls, pivot: Floats64, rotation: Floats64) -> RigidMotion:
        """Make a rotation about `pivot`, (3,) [mm], by a matrix (3, 3)."""
        return cls.frozen(rotation, pivot - rotation @ pivot)

    def displacements(self, points: Floats64) -> Floats64:
        """Return the displacements of points (..., 3)."""
        return points @ self.rotation.T + self.shift - points

    def after(self, first: RigidMotion) -> RigidMotion:
        """The motion `first`, followed by this one."""
        rotation = self.rotation @ first.rotation
        shift = self.rotation @ first.shift + self.shift
        return RigidMotion.frozen(rotation, shift)

    def matrix(self, space: FaceSpace) -> Floats64:
        """The motion in head coordinates as a (4, 4) matrix for column vectors."""
        result: Floats64 = in_head(self, space.axes, space.origin, space.scale)
        return result


REST_MOTION = RigidMotion.frozen(np.eye(3), np.zeros(3))


@dataclass(frozen=True)
class Eyeball:
    """One eyeball in the standard space [mm]."""

    side: Side
    centre: Floats64  # (3,)
    radius: float
    iris_radius: float | None = None  # of a human ball of this size if None

    @property
    def iris(self) -> float:
        """Radius of the iris [mm], to which the cornea before it is proportional."""
        iris_share = 0.454  # of the ball's radius, on the built-in head
        return iris_share * self.radius if self.iris_radius is None else self.iris_radius

    @property
    def gaze_factor(self) -> float:
        """Factor on the angles of ball and lids: 1, or less for a ball larger than a human one.

        Iris and lids of a larger ball move as far as on a human ball, because artists put larger
        balls behind openings of human width.
        """
        most_radius = 12.8  # mm
        return min(1.0, most_radius / self.radius)


@dataclass(frozen=True)
class Skull:
    """All rigid parts under one face."""

    condyles: Floats64  # (2, 3) mm: right, left
    mandible_weight: Floats64  # (V,) 0 = cranium .. 1 = mandible
    eyeballs: tuple[Eyeball, ...]
    jaw: Jaw
    eyes: Eyes
    head: HeadJoint

    def head_motion(self, pitch: float, yaw: float, roll: float) -> RigidMotion:
        """Motion of the head by head_pitch (up), head_yaw (left), head_roll (to the left)."""
        if pitch == yaw == roll == 0.0:
            return REST_MOTION
        head = self.head
        angles = (
            math.radians(head.yaw_deg) * yaw,
            -math.radians(head.pitch_deg) * pitch,
            -math.radians(head.roll_deg) * roll,
        )
        return RigidMotion.frozen(*turn_head(self.condyles, head.joint, angles))

    def mandible_motion(self, opening: float, forward: float, sideways: float) -> RigidMotion:
        """Motion of the mandible for jaw_open (0..1), jaw_forward and jaw_sideways (-1..1)."""
        glides = self.jaw.opening_glide, self.jaw.forward_glide, self.jaw.sideways_glide
        angles = math.radians(self.jaw.opening_deg), math.radians(self.jaw.sideways_deg)
        # Share of the way forward: a human jaw moves back by two millimetres at most.
        backward_share = 0.15
        values = opening, max(forward, backward_share * forward), sideways
        return RigidMotion.frozen(*move_mandible(self.condyles, glides, angles, values))

    def eye_motion(self, eyeball: Eyeball, horizontal: float, vertical: float) -> RigidMotion:
        """Motion of an eyeball that looks to the subject's left (+1) and up (+1)."""
        most = math.radians(self.eyes.gaze_deg) * eyeball.gaze_factor
        yaw = rotation(UP_AXIS, most * horizontal)
        pitch = rotation(LATERAL_AXIS, -most * vertical)
        return RigidMotion.about(eyeball.centre, yaw @ pitch)


# Kernels, because every tick places mandible and head, and numpy takes ten times as long for so few
# numbers.


@njit
def rotation(axis: Triple | Floats64, angle: float) -> Floats64:
    """Rotation matrix (3, 3) by `angle` [rad] about `axis` (Rodrigues)."""
    x, y, z = axis
    length = math.sqrt(x * x + y * y + z * z)
    x /= length
    y /= length
    z /= length
    c = math.cos(angle)
    s = math.sin(angle)
    d = 1.0 - c
    turn = np.empty((3, 3))
    turn[0, 0] = c + d * x * x
    turn[0, 1] = d * x * y - s * z
    turn[0, 2] = d * x * z + s * y
    turn[1, 0] = d * x * y + s * z
    turn[1, 1] = c + d * y * y
    turn[1, 2] = d * y * z - s * x
    turn[2, 0] = d * x * z - s * y
    turn[2, 1] = d * y * z + s * x
    turn[2, 2] = c + d * z * z
    return turn


@njit
def times(a: Floats64, b: Floats64) -> Floats64:
    """Product of two matrices (3, 3)."""
    product = np.zeros((3, 3))
    for i in range(3):
        for k in range(3):
            for n in range(3):
                product[i, n] += a[i, k] * b[k, n]
    return product


@njit
def turned(turn: Floats64, point: Floats64) -> Floats64:
    """A point (3,), turned by a rotation (3, 3)."""
    to = np.zeros(3)
    for i in range(3):
        for k in range(3):
            to[i] += turn[i, k] * point[k]
    return to


@njit
def turn_head(condyles: Floats64, joint: Triple, angles: Triple) -> tuple[Floats64, Floats64]:
    """Rotation (3, 3) and shift (3,) [mm] of the head about the joint with the spine.

    condyles: (2, 3) [mm]; joint: offset of the joint from their midpoint [mm]; angles: to the left,
    down, and to the right shoulder [rad].
    """
    turn = times(rotation(UP_AXIS, angles[0]), rotation(LATERAL_AXIS, angles[1]))
    forward = (0.0, 0.0, 1.0)
    turn = times(turn, rotation(forward, angles[2]))
    pivot = (condyles[0] + condyles[1]) / 2.0
    for k in range(3):
        pivot[k] += joint[k]
    return turn, pivot - turned(turn, pivot)


@njit
def move_mandible(
    condyles: Floats64,
    glides: tuple[Triple, Triple, Triple],
    angles: tuple[float, float],
    values: Triple,
) -> tuple[Floats64, Floats64]:
    """Rotation (3, 3) and shift (3,) [mm] of the mandible, see `Skull.mandible_motion`.

    condyles: (2, 3) [mm]; glides: glide at value 1 of each control [mm]; angles: at full opening
    and at full sideways motion [rad]; values: open, forward, sideways.
    """
    right = condyles[0]
    left = condyles[1]
    opened = rotation(left - right, angles[0] * values[0])
    pivot = (right + left) / 2.0
    shift = pivot - turned(opened, pivot)
    # For a move to the left, the left condyle stays and turns, and the right one comes forward.
    aside = rotation(UP_AXIS, angles[1] * values[2])
    pivot = left if values[2] > 0.0 else right
    turn = times(aside, opened)
    shift = pivot + turned(aside, shift - pivot)
    opening, forward, sideways = glides
    for k in range(3):
        glide = values[0] * opening[k] + values[1] * forward[k] + values[2] * sideways[k]
        shift[k] += glide
    return turn, shift


@njit
def moved_rigidly(motion: RigidMotion, point: Vector) -> Vector:
    """A point in the standard space after a motion [mm]."""
    return plus(rotated(motion.rotation, point), vector_of(motion.shift))


@njit
def in_head(pose: RigidMotion, axes: Floats64, origin: Floats64, scale: float) -> Floats64:
    """A motion in the standard space as a (4, 4) matrix in head coordinates."""
    there = times(times(axes.T, pose.rotation), axes)
    shift = turned(axes.T, pose.shift)
    pivot = turned(there, origin)
    matrix = np.zeros((4, 4))
    matrix[3, 3] = 1.0
    for i in range(3):
        matrix[i, 3] = origin[i] + scale * shift[i] - pivot[i]
        for k in range(3):
            matrix[i, k] = there[i, k]
    return matrix


@njit
def ball_surface(ahead: Numbers, radius: float, iris: float) -> Numbers:
    """Distance of an eyeball's surface from its centre [mm]: a sphere with a cornea.

    ahead: cosine of the angle between the direction there and the gaze, a number or an array.
    radius, iris: radii of the ball and of its iris [mm].
    """
    cornea_width = 1.08 * iris / radius  # sine of the angle from the gaze to the cornea's edge
    cornea_rise = 0.187 * iris  # mm above the sphere, measured on the drawn ball like the width
    inside = np.maximum(1.0 - (1.0 - ahead**2) / cornea_width**2, 0.0)
    surface: Numbers = radius + cornea_rise * inside**1.5 * (ahead > 0.0)
    return surface


def eyeballs_from_landmarks(landmarks: Floats64) -> tuple[Eyeball, ...]:
    """Guess the eyeballs of a head without eyeballs; landmarks: points [mm], (68, 3)."""
    eyeballs = []
    eye_radius = 12.5  # mm in the standard space, for a head without eyes (adult eyeball: 12)
    eye_setback = 5.5  # mm from the line of the eye corners back to the centre (fitted on scans)
    for side in (Side.RIGHT, Side.LEFT):
        outer, _, _, inner, _, _ = EYE_LANDMARKS[side]
        middle = (landmarks[outer] + landmarks[inner]) / 2.0
        centre = middle - np.array([0.0, 0.0, eye_setback])
        eyeballs.append(Eyeball(side, centre, eye_radius))
    return tuple(eyeballs)


def condyles_from_landmarks(landmarks: Floats64, jaw: Jaw) -> Floats64:
    """Condyles guessed from the ear landmarks, offset by the rig's `condyle`, shape (2, 3) [mm]."""
    lateral, up, forward = jaw.condyle
    right = landmarks[0] + (-lateral, up, forward)
    left = landmarks[16] + (lateral, up, forward)
    return np.array([right, left])


def mandible_weight_from_landmarks(
    surface: SkinSurface, landmarks: Floats64, jaw: Jaw, lip_side: Floats64
) -> Floats64:
    """Mandible weight of each vertex, shape (V,): the smoothest field through the rig's seeds."""
    vertices: list[int] = []
    values: list[float] = []
    nearest = surface.nearest(landmarks)
    for number, seed in jaw.seeds:
        for landmark in {number, int(MIRRORED_LANDMARKS[number])}:
            vertices.append(int(nearest[landmark]))
            values.append(seed)
    x, y, z = surface.positions.T
    neck_below_chin = 45.0  # mm below the chin landmark where the mandible's skin ends
    fixed = (y < landmarks[8, 1] - neck_below_chin) | (y > landmarks[29, 1])
    behind_ears = 20.0  # the same, mm behind the ear landmarks
    fixed |= z < min(landmarks[0, 2], landmarks[16, 2]) - behind_ears
    half_mouth = 0.9 * abs(landmarks[54, 0] - landmarks[48, 0]) / 2.0
    middle = landmarks[list(UPPER_LIP_MIDDLE)].mean(axis=0)
    lips = np.abs(lip_side) > 0.9
    lips &= np.abs(x - middle[0]) < half_mouth
    lips &= np.linalg.norm(surface.positions - middle, axis=1) < half_mouth
    of_lips = np.where(lip_side[lips] < 0.0, 1.0, 0.0)
    of_fixed = np.zeros(fixed.sum())
    seeds = np.concatenate([vertices, np.flatnonzero(fixed), np.flatnonzero(lips)])
    wanted = np.concatenate([values, of_fixed, of_lips])
    seed_hold = 3.0  # soft: exactly interpolated seeds would give a rough border
    weight = surface.harmonic(seeds.astype(np.int64), wanted, hold=seed_hold)
    return np.clip(weight, 0.0, 1.0)
