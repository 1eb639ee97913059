"""Eyelids: they turn over the eyeball like a visor, meet when closed, and follow the gaze.

Each lid vertex turns about the axis through the centre of the eyeball that runs from corner to
corner of the eye. Angles are measured per column of the eye opening (between its corners). Each
vertex has the angle that brings it to the line where the lids meet (`closing`), and a weight in the
motion of the open lid (`fold`). It turns by

    close closing + (1 - close) fold (raise + gaze)

so that at close = 1 the lids meet on every eye, however wide, and wherever the lower lid is. All
skin between the front edges of the lids moves to one line. A margin is as thick as skin: shut lids
with slanted margins would leave a groove, and show the cornea. The open lid moves the fold under
the brow along, because levator palpebrae inserts in both. The fold is held only while it moves, so
that the brow can come down on it. A closed upper lid is held twice as firmly, because its muscle
presses it down; so a rising brow does not open it. A closing lid slides towards the nose, where its
ring of fibres is fixed. A raised lid slides a little away from the nose. Both lids follow the gaze
a little to the side, because the cornea draws them. The lids of each eye follow the gaze of that
eye only. The turn fades from the margin to the edge of the lid. The turn moves the far ends of the
tissue springs instead of the skin, so skin still slides and is still kept off the eyeball.
lid_fold.py has the motion of the skin above the upper lid.

Source: own; the papers close the eye by a sphincter, and skin then does not follow the eyeball.
Angles from the visible lid margins.
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from ..geometry.arrays import Flags, Floats64, Integers32, Integers64
from ..geometry.steps import smoothstep
from .landmarks import EYE_LANDMARKS
from .lid_edges import (
    LID_COLUMNS,
    LidAxes,
    OneLid,
    front_edges,
    margin_of,
    one_lid,
    side_with_edges,
)
from .lid_fold import blended_turn, turn_above
from .lid_lift import laid_on_ball, lift_off
from .lid_motion import LidVertices, shut_state
from .lid_seam import (
    CORNER_PART,
    from_corner,
    lowered_corners,
    margin_sink,
    pressed_turn,
    raised_at_corners,
)
from .lip_lid_sides import lid_side
from .rig import LID_ACTIONS, Eyes, LidMuscle, Rig
from .skull import Eyeball
from .surface import SkinSurface


class Lids(NamedTuple):
    """The lids of a face: their vertices, their stiffness, and the muscles that turn them."""

    vertices: LidVertices
    hold: Floats64  # (L,) extra stiffness of the tarsal plate
    muscles: tuple[tuple[int, int, int, float], ...]  # control, eye, action (LID_ACTIONS), travel

    def drive(self, activation: Floats64) -> Floats64:
        """Closing and raising of lids, (eyes, 3): upper closes, lower rises, upper rises."""
        drive = np.zeros((len(self.vertices.centres), 3))
        for control, eye, action, travel in self.muscles:
            drive[eye, action] += travel * max(activation[control], 0.0)
        return drive


def place_lids(
    rig: Rig,
    surface: SkinSurface,
    landmarks: Floats64,
    eyeballs: tuple[Eyeball, ...],
    names: list[str],
) -> Lids:
    """Find the lids of each eye, and the weight of each vertex in their motion.

    names: names of all controls in their order, to find the lid muscles' activations.
    """
    parts = _lifted_eyes(rig, surface, landmarks, eyeballs)
    vertices, hold = _lid_vertices(rig, surface, landmarks, parts, eyeballs)
    return Lids(vertices, hold, _lid_muscles(rig, eyeballs, names))


def _lifted_eyes(
    rig: Rig,
    surface: SkinSurface,
    landmarks: Floats64,
    eyeballs: tuple[Eyeball, ...],
) -> list[_OneEye]:
    """The lids of each eye, in front of the eyeballs when shut.

    A flat triangle that spans half an eyeball must be lifted far, and a lid of such triangles is a
    tent. There the lower lids come up farther, so that both lids span less.
    """
    good_lift = 2.0  # mm that nobody sees
    lift_per_meeting = 4.0  # mm of less lift for which the lids may meet at another height, in full
    own_meeting = rig.eyes.blink_meeting
    found: list[_OneEye] = []
    least = np.inf
    for meeting in np.arange(own_meeting, 0.5 + 1e-6, 0.1).tolist():
        eyes = replace(rig.eyes, blink_meeting=meeting)
        parts: list[_OneEye] = []
        highest = 0.0
        for ball in eyeballs:
            part, edges = _one_eye(eyes, surface, landmarks, ball)
            lids = _lid_vertices(rig, surface, landmarks, [part], (ball,))[0]
            axes = lid_axes(landmarks, ball)
            part = part._replace(
                sink=part.sink + margin_sink(lids, part.weight, surface, axes, edges)
            )
            lids = lids._replace(sink=part.sink)
            lift = _closed_lid_lift(lids, surface, ball, meeting > own_meeting)
            parts.append(part._replace(sink=part.sink - lift))
            highest = max(highest, lift.max(initial=0.0))
        cost = max(highest, good_lift) + lift_per_meeting * (meeting - own_meeting)
        if cost < least:
            found = parts
            least = cost
        if highest <= good_lift:
            break
    return found


def _lid_vertices(
    rig: Rig,
    surface: SkinSurface,
    landmarks: Floats64,
    parts: list[_OneEye],
    eyeballs: tuple[Eyeball, ...],
) -> tuple[LidVertices, Floats64]:
    """The lids of some eyes for the kernel, and the extra stiffness of their plates (L,)."""
    eyes = rig.eyes
    axes = [_up_and_forward(landmarks, ball) for ball in eyeballs]
    joined = _OneEye(*(np.concatenate(column) for column in zip(*parts, strict=True)))
    apertures = np.array([part.opening.max() for part in parts])
    areas = rig.tissue.stiffness_scale * surface.areas[joined.vertex]
    hold = eyes.lid_stiffness * areas * joined.weight
    eye_numbers = np.repeat(np.arange(len(parts)), [len(part.vertex) for part in parts])
    across = np.array([np.cross(up, forward) for up, forward in axes])
    to_nose = np.array([[-ball.side.sign] for ball in eyeballs])
    gaze_factors = np.array([ball.gaze_factor for ball in eyeballs])
    vertices = LidVertices(
        vertex=joined.vertex.astype(np.int32),
        eye=eye_numbers.astype(np.int32),
        upper=joined.upper,
        closing=joined.closing,
        overlap=joined.overlap,
        sink=joined.sink,
        fold=joined.fold,
        opening=joined.opening,
        aperture=apertures,
        along=joined.along,
        fold_hold=eyes.fold_stiffness * areas * np.maximum(joined.fold - joined.weight, 0.0),
        shut_hold=hold * joined.upper,
        centres=np.array([ball.centre for ball in eyeballs]),
        radii=np.array([ball.radius for ball in eyeballs]),
        up=np.array([up for up, _ in axes]),
        forward=np.array([forward for _, forward in axes]),
        inward=across * to_nose,
        slide=eyes.blink_slide,
        raise_slide=eyes.raise_slide,
        gaze_fraction=gaze_factors * gaze_fractions_of(apertures),
        upper_follows=eyes.upper_lid_follows,
        lower_follows=eyes.lower_lid_follows,
        sideways_follow=eyes.lids_follow_sideways,
    )
    return vertices, hold


def gaze_fractions_of(apertures: Floats64) -> Floats64:
    """Return how far the lids of each eye follow the gaze, 0 to 1, shape (eyes,).

    apertures: greatest opening of each eye at rest [rad], shape (eyes,). Lids that are shut at rest
    do not follow, because a look upward would open them.
    """
    shut = 0.08  # [rad], a millimetre on a human ball
    narrow = 0.16  # [rad]
    fraction: Floats64 = smoothstep((apertures - shut) / (narrow - shut))
    return fraction


def _closed_lid_lift(
    lids: LidVertices, surface: SkinSurface, ball: Eyeball, both: bool
) -> Floats64:
    """Return how far each lid vertex of a closed eye must be lifted [mm], shape (L,).

    both: whether the lower lid is lifted, too.
    """
    state = shut_state(lids, surface)
    moves = np.zeros(surface.vertex_count)
    moves[lids.vertex[(lids.upper | both) & (lids.closing != 0.0)]] = 1.0
    lift = lift_off(state.carried, surface.positions, surface.faces, moves, ball)
    return lift[lids.vertex]


class _OneEye(NamedTuple):
    """The lid vertices of one eye; see LidVertices. `weight`: share of the margin's turn."""

    vertex: Integers64
    upper: Flags
    weight: Floats64
    closing: Floats64
    overlap: Floats64
    sink: Floats64
    fold: Floats64
    opening: Floats64
    along: Floats64


def _up_and_forward(landmarks: Floats64, ball: Eyeball) -> tuple[Floats64, Floats64]:
    """Directions up and forward, both normal to the line from one eye corner to the other."""
    outer, _, _, inner, _, _ = EYE_LANDMARKS[ball.side]
    along = (landmarks[outer] - landmarks[inner]) * ball.side.sign
    along = along / np.linalg.norm(along)
    forward = np.cross(along, [0.0, 1.0, 0.0])
    forward /= np.linalg.norm(forward)
    up: Floats64 = np.cross(forward, along)
    return up, forward


def lid_axes(landmarks: Floats64, ball: Eyeball) -> LidAxes:
    """Return the axes of the lids of an eye; landmarks: (68, 3)."""
    outer, _, _, inner, _, _ = landmarks[list(EYE_LANDMARKS[ball.side])]
    return LidAxes(ball.centre, *_up_and_forward(landmarks, ball), outer, inner - outer)


def _one_eye(
    eyes: Eyes,
    surface: SkinSurface,
    landmarks: Floats64,
    ball: Eyeball,
) -> tuple[_OneEye, tuple[Integers32, Integers32]]:
    """Find the lids of one eye, the turn of each lid vertex, and the vertices of front edges."""
    x = surface.positions
    outline = landmarks[list(EYE_LANDMARKS[ball.side])]
    axes = lid_axes(landmarks, ball)
    column = axes.column(x)
    angle = axes.angle(x)
    edges = front_edges(surface, axes, outline)
    side = side_with_edges(lid_side(surface, landmarks, ball.side), *edges)
    upper, lower = _both_lids(eyes, surface, axes, edges, side)
    where = np.linspace(0.0, 1.0, LID_COLUMNS)
    height = np.maximum(upper.front - lower.front, 0.0)
    wide = _smoothed_opening(height)
    least_opening = 0.05  # rad: closed lids do not overlap where an eye opens less
    widest = height.max()
    full = wide / max(widest, least_opening)
    slide = _slide_shares(upper.slide + lower.slide, column, full)
    exact = np.interp(column, where, height)
    broad = np.interp(column, where, np.minimum(wide, widest))
    weight = upper.weight + lower.weight
    opening = weight * exact + (1.0 - weight) * broad
    is_upper = side > 0.0
    inward = slide * np.where(is_upper, *eyes.blink_slide)
    arrives = column + inward / np.linalg.norm(axes.axis)
    plain_seam = lower.front + eyes.blink_meeting * height
    pressed = ball.gaze_factor * pressed_turn(height / ball.gaze_factor, least_opening)
    # The line where closed lids meet.
    seam = lowered_corners(raised_at_corners(plain_seam, upper.front), pressed)
    meeting = np.interp(arrives, where, seam)
    margins = margin_of(upper, 1.0, column, angle) | margin_of(lower, -1.0, column, angle)
    margins[np.concatenate(edges)] = True
    closing = np.where(margins, meeting - angle, 0.0)
    turned = blended_turn(x, edges, closing, side, weight)
    above = turn_above(surface, axes, edges[0], side, (upper.front, seam), turned)
    is_above = is_upper & ~margins & ~np.isnan(above)
    closing[is_above] = above[is_above]
    is_below = ~is_upper & ~margins
    closing[is_below] = turned.fading[is_below]
    before = x[:, 2] > ball.centre[2]  # skin behind the eyeball's equator is not lid
    corner_fraction = 0.5  # share of the open lid's motion at the corners, whose ligaments stretch
    rounded = np.sin(np.pi * np.clip(column, 0.0, 1.0))
    at_middle = corner_fraction + (1.0 - corner_fraction) * rounded
    fold = before * (upper.fold + lower.fold) * at_middle
    weight = before * weight
    closing = before * closing
    margin_turn = np.maximum(np.interp(column, where, upper.front - seam), 0.1)
    sink = is_upper * laid_on_ball(x, ball, column, -closing / margin_turn)
    least_turn = 1e-3  # vertices that move less do not belong to the lids
    most_moved = np.maximum.reduce([weight, fold, slide, np.abs(closing)])
    vertex = np.flatnonzero(most_moved > least_turn)
    overlap = weight * ball.gaze_factor * pressed_turn(opening / ball.gaze_factor, least_opening)
    overlap *= smoothstep(from_corner(column) / CORNER_PART)
    values = (weight, closing, overlap, sink, fold, opening, slide)
    return _OneEye(vertex, is_upper[vertex], *(each[vertex] for each in values)), edges


def _slide_shares(near: Floats64, column: Floats64, full: Floats64) -> Floats64:
    """Return the share of each vertex in the slide, shape (V,), from the eye's opening there.

    near: share from the distance to the lids (V,). full: opening by column, 1 where it is widest.
    Skin beyond a corner also slides, or it would fold there.
    """
    slide_beyond = 0.2  # widths of the opening
    beyond = np.maximum(np.abs(column - 0.5) - 0.5, 0.0)
    slide_ends = (0.1, 1.7)  # factors of the slide at the outer and the inner corner
    ends: Floats64 = np.interp(column, (0.0, 1.0), slide_ends)
    opened = np.interp(column, np.linspace(0.0, 1.0, LID_COLUMNS), full)
    return near * opened * ends * smoothstep(1.0 - beyond / slide_beyond)


def _both_lids(
    eyes: Eyes,
    surface: SkinSurface,
    axes: LidAxes,
    edges: tuple[Integers32, Integers32],
    side: Floats64,
) -> tuple[OneLid, OneLid]:
    """The upper and the lower lid; edges: vertices of their front edges."""
    upper_edge, lower_edge = edges
    upper_ends = (eyes.fold_plateau, eyes.fold_reach)
    lower_ends = (eyes.lid_plateau, eyes.lid_reach)
    upper = one_lid(eyes, surface, axes, upper_edge, side > 0.0, upper_ends)
    lower = one_lid(eyes, surface, axes, lower_edge, side < 0.0, lower_ends)
    return upper, lower


def _smoothed_opening(height: Floats64) -> Floats64:
    """Opening by column, smoothed at the ends so that skin off the margin does not crease."""
    smooth_columns = 13  # a third of the opening's width
    wide = np.convolve(np.pad(height, smooth_columns), np.ones(smooth_columns) / smooth_columns)
    return np.asarray(wide[smooth_columns + smooth_columns // 2 :][:LID_COLUMNS])


def _lid_muscles(
    rig: Rig, eyeballs: tuple[Eyeball, ...], names: list[str]
) -> tuple[tuple[int, int, int, float], ...]:
    """Control, eye, action and travel of each lid muscle; an unpaired muscle moves both eyes."""
    found = []
    for muscle in rig.muscles:
        if isinstance(muscle, LidMuscle):
            for eye, ball in enumerate(eyeballs):
                name = f"{muscle.name}_{ball.side.value}" if muscle.pair else muscle.name
                found.append((names.index(name), eye, LID_ACTIONS.index(muscle.lid), muscle.travel))
    return tuple(found)
