"""Eyelids: they turn over the eyeball like a visor, meet when closed, and ride with the gaze.

Each lid vertex keeps its distance to the centre of the eyeball and turns about the axis through
it that runs from corner to corner of the eye. Angles are measured per column of the eye opening
(between its corners): with the opening's height alpha at a column, the upper lid turns by

    (1 - close) (raise + gaze) + close (lower lid's angle - alpha) - close^3 overlap

so that at close = 1 the lids meet on every eye, however wide, and wherever the lower lid is. They
overlap as far as their margins are thick: lids that meet with their inner rims alone leave a groove
between the front ones, out of which the cornea looks.
A closing lid also slides towards the nose, as the ring of fibres in it is fixed there.
The lids of each eye follow the gaze of that eye alone.
The turn fades from the margin to the edge of the lid. It moves the tissue springs' far ends, not
the skin: skin still slides and is still kept off the eyeball.

Source: own; the papers close the eye by a sphincter, which does not follow the eyeball. Angles
from the visible lid margins.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from ..jit import njit
from .landmarks import EYE_LANDMARKS, Array, polyline_distance, smoothstep
from .lip_lid_sides import lid_side
from .rig import LIDS, Eyes, LidMuscle, Rig
from .skull import Eyeball
from .surface import Surface

COLUMNS = 41  # places along the opening where its height is known
SMOOTH_COLUMNS = 13  # a third of the opening's width
COLUMN_REACH = 0.045  # of the opening's width: a column of lid vertices
MARGIN_REACH = 3.5  # mm around the lid landmarks in which the lid's edge is looked for
LEAST_OVERLAP = 0.09  # rad (1.1 mm): the upper margin comes to lie in front of the lower one
GREATEST_OVERLAP = 0.21  # rad (2.6 mm): as thick as a margin is
LEAST_OPENING = 0.05  # rad: at the corners lids do not overlap
WIDE_OPENING = 0.3  # rad: from here on they do in full
SLIDE_REACH = 1.9  # x the reach of the turn: skin around the lid slides along with it
LEAST_TURN = 1e-3  # lid vertices that move less are not lid


class LidVertices(NamedTuple):
    """All lid vertices of a face, for the kernel."""

    vertex: npt.NDArray[np.int32]  # (L,)
    eye: npt.NDArray[np.int32]  # (L,) row of the arrays per eye below
    upper: npt.NDArray[np.bool_]  # (L,) upper or lower lid
    weight: Array  # (L,) share of the margin's turn
    opening: Array  # (L,) rad, height of the opening at the vertex's column
    overlap: Array  # (L,) rad by which closed lids overlap there
    centres: Array  # (eyes, 3)
    up: Array  # (eyes, 3) unit, across the lid axis
    forward: Array  # (eyes, 3) unit
    inward: Array  # (eyes, 3) unit, from the outer to the inner corner
    along: Array  # (L,) share of the slide: 1 at the middle of the margin .. 0 around the eye
    slide: tuple[float, float]  # mm inward when closed: upper, lower lid
    upper_follows: float  # share of the vertical gaze
    lower_follows: float
    meeting: float  # share of the opening that the lower lid rises in a blink


class Lids(NamedTuple):
    """The eyelids of a face."""

    vertices: LidVertices
    hold: Array  # (L,) extra stiffness of the tarsal plate
    muscles: tuple[tuple[int, int, int, float], ...]  # control, eye, action (LIDS), travel

    def drive(self, activation: Array) -> Array:
        """How far each eye's upper lid is closed, lower raised, upper raised, shape (eyes, 3)."""
        drive = np.zeros((len(self.vertices.centres), 3))
        for control, eye, action, travel in self.muscles:
            drive[eye, action] += travel * max(activation[control], 0.0)
        return drive


def place_lids(
    rig: Rig, surface: Surface, landmarks: Array, eyeballs: tuple[Eyeball, ...], names: list[str]
) -> Lids:
    """Find the lids of each eye and how far each of their vertices takes part.

    names: of all controls in their order, to find the lid muscles' activations.
    """
    eyes = rig.eyes
    axes = [_lid_axes(landmarks, ball) for ball in eyeballs]
    parts = [
        _one_eye(eyes, surface, landmarks, ball, *axis)
        for ball, axis in zip(eyeballs, axes, strict=True)
    ]
    vertex = np.concatenate([p[0] for p in parts])
    weight = np.concatenate([p[2] for p in parts])
    vertices = LidVertices(
        vertex=vertex.astype(np.int32),
        eye=np.repeat(np.arange(len(parts)), [len(p[0]) for p in parts]).astype(np.int32),
        upper=np.concatenate([p[1] for p in parts]),
        weight=weight,
        opening=np.concatenate([p[3] for p in parts]),
        overlap=np.concatenate([p[5] for p in parts]),
        centres=np.array([ball.centre for ball in eyeballs]),
        up=np.array([up for up, _ in axes]),
        forward=np.array([forward for _, forward in axes]),
        inward=np.array([np.cross(up, forward) for up, forward in axes])
        * np.array([[-ball.side.sign] for ball in eyeballs]),
        along=np.concatenate([p[4] for p in parts]),
        slide=eyes.blink_slide,
        upper_follows=eyes.upper_lid_follows,
        lower_follows=eyes.lower_lid_follows,
        meeting=eyes.blink_meeting,
    )
    hold = eyes.lid_stiffness * rig.tissue.stiffness_scale * surface.areas[vertex] * weight
    return Lids(vertices, hold, _lid_muscles(rig, eyeballs, names))


def _lid_axes(landmarks: Array, ball: Eyeball) -> tuple[Array, Array]:
    """Directions up and forward, both across the line from one eye corner to the other."""
    outer, _, _, inner, _, _ = EYE_LANDMARKS[ball.side]
    along = (landmarks[outer] - landmarks[inner]) * ball.side.sign
    along = along / np.linalg.norm(along)
    forward = np.cross(along, [0.0, 1.0, 0.0])
    forward /= np.linalg.norm(forward)
    up: Array = np.cross(forward, along)
    return up, forward


def _one_eye(
    eyes: Eyes, surface: Surface, landmarks: Array, ball: Eyeball, up: Array, forward: Array
) -> tuple[npt.NDArray[np.int64], npt.NDArray[np.bool_], Array, Array, Array, Array]:
    """Vertices, upper/lower, weight, opening, share of the slide, overlap of one eye's lids."""
    outer, upper_outer, upper_inner, inner, lower_outer, lower_inner = EYE_LANDMARKS[ball.side]
    side = lid_side(surface, landmarks, ball.side)
    x = surface.positions
    corner, axis = landmarks[outer], landmarks[inner] - landmarks[outer]

    def angle_of(points: Array) -> Array:
        """Angle [rad] about the axis of the lids, 0 straight forward."""
        return np.arctan2((points - ball.centre) @ up, (points - ball.centre) @ forward)

    def column_of(points: Array) -> Array:
        """Place from the outer corner of the eye, 0, to the inner one, 1."""
        column: Array = ((points - corner) @ axis) / (axis @ axis)
        return column

    column, angle = column_of(x), angle_of(x)
    rows = {
        True: landmarks[[outer, upper_outer, upper_inner, inner]],
        False: landmarks[[outer, lower_outer, lower_inner, inner]],
    }
    where = np.linspace(0.0, 1.0, COLUMNS)
    edges, fronts = {}, {}
    weight, slide = np.zeros(surface.vertex_count), np.zeros(surface.vertex_count)
    for upper, line in rows.items():
        on_lid = side > 0.0 if upper else side < 0.0
        distance = polyline_distance(x, _margin(column_of(line), line))
        reach = 1.0 - (distance - eyes.lid_plateau) / max(eyes.lid_reach - eyes.lid_plateau, 0.1)
        weight = np.where(on_lid, smoothstep(reach), weight)
        slide = np.where(on_lid, smoothstep(1.0 - distance / (SLIDE_REACH * eyes.lid_reach)), slide)
        near = on_lid & (distance < MARGIN_REACH) & (column > -0.02) & (column < 1.02)
        arch = np.polynomial.Polynomial.fit(column_of(line), angle_of(line), 3)
        edges[upper] = _edge(arch, column[near], angle[near], lowest=upper)
        fronts[upper] = arch(where)
    thick = fronts[True] - fronts[False] - (edges[True] - edges[False])
    height = np.maximum(edges[True] - edges[False], 0.0)
    height = np.convolve(np.pad(height, 1, mode="edge"), np.ones(3) / 3.0, "valid")
    height[[0, -1]] = 0.0  # lids are joined at the corners
    # At the corners the opening ends abruptly; skin away from the margin must not crease there.
    wide = np.convolve(np.pad(height, SMOOTH_COLUMNS), np.ones(SMOOTH_COLUMNS) / SMOOTH_COLUMNS)
    start = SMOOTH_COLUMNS + SMOOTH_COLUMNS // 2
    exact = np.interp(column, where, height)
    broad = np.interp(column, where, wide[start : start + COLUMNS])
    opening = weight * exact + (1.0 - weight) * np.minimum(broad, height.max())
    weight *= x[:, 2] > ball.centre[2]  # skin behind the eyeball's equator is no lid
    slide *= np.interp(column, where, wide[start : start + COLUMNS], 0.0, 0.0) / max(
        height.max(), LEAST_OPENING
    )
    lid = np.flatnonzero((weight > LEAST_TURN) | (slide > LEAST_TURN))
    overlap = np.clip(thick.max(), LEAST_OVERLAP, GREATEST_OVERLAP) * smoothstep(
        (opening - LEAST_OPENING) / (WIDE_OPENING - LEAST_OPENING)
    )
    return lid, side[lid] > 0.0, weight[lid], opening[lid], slide[lid], overlap[lid]


def _margin(column: Array, line: Array) -> Array:
    """The lid's margin as a smooth curve through its four landmarks, shape (COLUMNS, 3) [mm]."""
    where = np.linspace(0.0, 1.0, COLUMNS)
    curves = [np.polynomial.Polynomial.fit(column, line[:, k], 3)(where) for k in range(3)]
    return np.stack(curves, axis=1)


def _edge(arch: np.polynomial.Polynomial, column: Array, angle: Array, *, lowest: bool) -> Array:
    """Angle [rad] of a lid's free edge at COLUMNS places between the corners, shape (COLUMNS,).

    The cubic `arch` through its four landmarks gives the shape; how far the lid's outermost
    vertices lie off that arch, place by place, corrects it.
    """
    where = np.linspace(0.0, 1.0, COLUMNS)
    off = np.clip(angle - arch(column), -0.3, 0.3)
    edge: Array = arch(where)
    for n, c in enumerate(where):
        beside = np.abs(column - c) < COLUMN_REACH
        if beside.any():
            edge[n] += off[beside].min() if lowest else off[beside].max()
    return edge


def _lid_muscles(
    rig: Rig, eyeballs: tuple[Eyeball, ...], names: list[str]
) -> tuple[tuple[int, int, int, float], ...]:
    """Control, eye, action and travel of each lid muscle; an unpaired one moves both eyes."""
    found = []
    for muscle in rig.muscles:
        if isinstance(muscle, LidMuscle):
            for eye, ball in enumerate(eyeballs):
                name = f"{muscle.name}_{ball.side.value}" if muscle.pair else muscle.name
                found.append((names.index(name), eye, LIDS.index(muscle.lid), muscle.travel))
    return tuple(found)


@njit
def turn_lids(state, rest, lids, drive, gaze):  # type: ignore[no-untyped-def]
    """Turn the far ends of the tissue springs of all lid vertices, and their normals.

    drive: of each eye, shape (eyes, 3), see Lids.drive; gaze: vertical angle of each [rad],
    shape (eyes,).
    """
    carried, normals = state.carried, state.normals
    centres, up, forward = lids.centres, lids.up, lids.forward
    for row in range(len(lids.vertex)):
        i, e, alpha = lids.vertex[row], lids.eye[row], lids.opening[row]
        close = min(drive[e, 0], 1.0)
        lower = (1.0 - close) * (alpha * drive[e, 1] + lids.lower_follows * gaze[e])
        lower = min(lower + close * lids.meeting * alpha, alpha)
        angle = lower
        if lids.upper[row]:
            raised = max(alpha * drive[e, 2] + lids.upper_follows * gaze[e], lower - alpha)
            angle = (1.0 - close) * raised + close * (lower - alpha)
            angle -= close**3 * lids.overlap[row]  # late: half a blink is half closed
        inward = close * lids.along[row] * lids.slide[0 if lids.upper[row] else 1]
        angle *= lids.weight[row]
        c, s = np.cos(angle) - 1.0, np.sin(angle)
        high, far, normal_high, normal_far = 0.0, 0.0, 0.0, 0.0
        for k in range(3):
            high += (rest[i, k] - centres[e, k]) * up[e, k]
            far += (rest[i, k] - centres[e, k]) * forward[e, k]
            normal_high += normals[i, k] * up[e, k]
            normal_far += normals[i, k] * forward[e, k]
        for k in range(3):
            u, f = up[e, k], forward[e, k]
            carried[i, k] += (high * c + far * s) * u + (far * c - high * s) * f
            normals[i, k] += (normal_high * c + normal_far * s) * u
            normals[i, k] += (normal_far * c - normal_high * s) * f
        if inward != 0.0:
            side, far = 0.0, 0.0
            for k in range(3):
                side += (carried[i, k] - centres[e, k]) * lids.inward[e, k]
                far += (carried[i, k] - centres[e, k]) * forward[e, k]
            angle = inward / np.sqrt(side * side + far * far)
            c, s = np.cos(angle) - 1.0, np.sin(angle)
            for k in range(3):
                carried[i, k] += (side * c + far * s) * lids.inward[e, k]
                carried[i, k] += (far * c - side * s) * forward[e, k]
