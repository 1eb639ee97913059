"""The tongue: a spine in the middle plane that bends, and flesh around it.

The tongue is attached to the mandible, so all coordinates here are coordinates of the mandible at
rest. At rest the spine is the middle line of the part "tongue". Two controls bend it:

    tongue_out   the spine slides along a path over the lower incisors, over the lower lip and down
                 in front of it; the root comes forward, and the tongue gets longer and thinner
    tongue_up    the tip rises towards the palate, right behind the upper incisors

The path lies over the current lower lip, and the gap between teeth and lips limits the tongue's
thickness there. The tongue does not come out through a closed mouth. Each vertex keeps its position
along the spine and turns with it.

Source: own; a tongue keeps its volume (Kier, Smith 1985, "Tongues, tentacles and trunks").
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy

from ..geometry.arrays import Floats64, Integers64
from ..geometry.polylines import arc_lengths
from ..geometry.steps import smoothstep
from . import checked
from .coordinates import FaceSpace
from .skull import RigidMotion

SPINE_POINT_COUNT = 65  # number of points of the spine


@dataclass(frozen=True)
class Tongue:
    """A tongue at rest, in the space of the mandible at rest."""

    PATH_SETBACK = 10.0  # mm behind the lower incisors' edges: here the path over them begins

    rest: Floats64  # (T, 3)
    along: Floats64  # (T,) place along the spine: 0 the tip .. 1 the root
    spine: Floats64  # (SPINE_POINT_COUNT, 2) forward and up, from the tip
    off: Floats64  # (T,) up from the spine
    half: Floats64  # (SPINE_POINT_COUNT,) half of the height
    lower_edge: Floats64  # (3,) of the lower incisors
    upper_edge: Floats64  # (3,) of the upper incisors, seen from the cranium
    lips: Integers64  # vertex indices of the landmarks LIPS

    def bent(self, out: float, up: float, x: Floats64, mandible: RigidMotion) -> Floats64:
        """The vertices of the bent tongue, shape (T, 3); out, up: tongue_out and tongue_up, 0..1.

        x: the skin now, shape (V, 3); mandible: its current motion.
        """
        lips = (x[self.lips] - mandible.shift) @ mandible.rotation
        upper_edge = (self.upper_edge - mandible.shift) @ mandible.rotation
        free_share, thickness = self._passage(lips, upper_edge)
        out *= free_share
        # Range of tongue_out in which the tip rises from behind the incisors onto the path.
        rise_share = 0.25
        risen = float(smoothstep(np.array(out / rise_share)))
        path = self._on_path(out, lips, thickness)
        spine = self.spine + risen * (path - self.spine)
        # Place of a risen tip, in mm forward and up from the upper incisors' edges.
        palate = (-6.0, 5.0)
        tip_up = upper_edge[[2, 1]] + palate - self.spine[0]
        highest_rise = 24.0  # mm that the tip rises
        tip_up *= min(1.0, highest_rise / float(np.linalg.norm(tip_up)))
        place = np.linspace(0.0, 1.0, SPINE_POINT_COUNT)
        front_share = 0.75  # share of the spine that rises with the tip
        falloff = np.maximum(1.0 - place / front_share, 0.0)[:, None] ** 2
        spine += up * (1.0 - risen) * falloff * tip_up
        ahead = spine[:, 0] - self.lower_edge[2]  # mm in front of the lower teeth
        # The tongue is flat where it passes between the teeth.
        between = (ahead + 2.0 * self.PATH_SETBACK) / (1.5 * self.PATH_SETBACK)
        flat = risen * smoothstep(between)
        flat_height = np.minimum(0.5 * thickness / self.half, 1.0)
        height = 1.0 + flat * (flat_height - 1.0)
        least_width_share = 0.7  # of its width and height, at least
        shortening = np.sqrt(_spine_lengths(self.spine) / _spine_lengths(spine))
        slender = np.clip(shortening, least_width_share, 1.0)
        turn = _spine_angles(spine) - _spine_angles(self.spine)
        sunk_share = 0.25  # of the way from the rest to its place on the lip
        # The thin tip hangs lower than the middle of the thicker part.
        sunk = sunk_share * risen * np.maximum(0.5 * thickness - self.half, 0.0)
        # The lower lip is lowest in its middle, where the tongue lies.
        over_lip = smoothstep(ahead / self.PATH_SETBACK)
        sides = lips[3:]
        rise = max(float(sides[:, 1].mean()) - lips[1, 1], 0.0)
        half_lip = max(abs(sides[0, 0] - sides[1, 0]) / 2.0, 1.0)
        hollow = risen * over_lip * rise / half_lip**2

        def at_vertices(samples: Floats64) -> Floats64:
            return np.interp(self.along, place, samples)

        beside = self.rest[:, 0] * slender
        off = self.off * at_vertices(height) * slender
        off += at_vertices(hollow) * beside**2
        off -= at_vertices(sunk)
        # A flat tongue has a groove in its middle, which ends before the tip.
        groove_depth = 1.6  # mm at most
        groove_width = 2.6  # mm
        groove = groove_depth * risen * smoothstep((self.along - 0.03) / 0.2)
        off -= groove * np.exp(-((beside / groove_width) ** 2)) * (self.off > 0.0)
        angle = at_vertices(turn)
        up_now = at_vertices(spine[:, 1]) + off * np.cos(angle)
        forward_now = at_vertices(spine[:, 0]) - off * np.sin(angle)
        return np.column_stack([beside, up_now, forward_now])

    def _passage(self, lips: Floats64, upper_edge: Floats64) -> tuple[float, float]:
        """How far the tongue may come out, 0..1, and its thickness between the teeth [mm]."""
        ceiling = min(lips[0, 1], upper_edge[1])
        floor = max(lips[1, 1], self.lower_edge[1])
        room = ceiling - floor
        least_room = 1.0  # mm between teeth and lips; in a smaller gap the tongue stays inside
        # In mm between teeth and lips; in a larger gap the control is not limited.
        free_room = 3.5
        free_share = (room - least_room) / (free_room - least_room)
        filled_share = 0.8  # thickness of the tongue, relative to the gap between teeth and lips
        most_thickness = 8.5  # mm: its thickness there at most
        thickness = np.clip(filled_share * room, least_room, most_thickness)
        return float(np.clip(free_share, 0.0, 1.0)), float(thickness)

    def _on_path(self, out: float, lips: Floats64, thickness: float) -> Floats64:
        """The spine along the path out of the mouth, shape (SPINE_POINT_COUNT, 2)."""
        _, middle, low, *_ = lips
        clearance = 0.6  # mm above teeth and lip
        above = 0.5 * thickness + clearance
        lip_front = 4.2  # mm from the lip's landmarks to its most forward skin
        front = max(middle[2], low[2]) + lip_front
        over_lip = max(middle[1], self.lower_edge[1]) + above
        root_forward = 10.0  # mm that the root comes forward
        body_rise = 5.0, 4.0  # mm that its middle comes forward and up
        overhang = 4.0  # mm from the lip forward to the tip at the end
        tip_drop = 9.0  # mm from the edge of the lip down to the tip at the end
        root = self.spine[-1] + (root_forward, 0.0)
        body = self.spine[SPINE_POINT_COUNT // 2] + body_rise
        behind_teeth = self.lower_edge[[2, 1]] + (-self.PATH_SETBACK, above)
        on_lip = (middle[2] - 1.0, over_lip)
        end = (front + above + overhang, low[1] - tip_drop)
        path = np.array([root, body, behind_teeth, on_lip, end])
        lengths = arc_lengths(path)
        tip = lengths[2] + out * (lengths[-1] - lengths[2])
        # The root is stretched, and the tip keeps its shape.
        place = np.linspace(0.0, 1.0, SPINE_POINT_COUNT)
        rest = _spine_lengths(self.spine)
        way = tip - rest * place - (tip - rest) * place**2
        on_path: Floats64 = scipy.interpolate.PchipInterpolator(lengths, path)(way)
        return on_path


def place_tongue(parts: Any, space: FaceSpace, landmarks: Integers64 | None) -> Tongue | None:
    """The tongue among a head's parts; None without teeth, landmarks, or a tongue that could bend.

    parts: objects with `name` and `vertices`; landmarks: vertex indices, shape (68,).
    """
    found = {}
    names = ("tongue", "teeth_lower", "teeth_upper")  # the tongue, and the teeth around it
    for part in checked.several("head.parts", () if parts is None else parts, ("name", "vertices")):
        if part.name in names:
            what = f"head.parts: {part.name}"
            found[part.name] = checked.numbers(what, part.vertices, (None, 3), "(n, 3)")
    has_all = all(name in found and len(found[name]) for name in names)
    if landmarks is None or not has_all:
        return None
    rest, lower, upper = (space.to_standard(found[name]) for name in names)
    tip = rest[:, 2].max()
    root = rest[:, 2].min()
    slice_count = 24  # slices in which its thickness is measured
    least_length = 5.0  # mm: a shorter tongue cannot bend
    if len(rest) < slice_count or tip - root < least_length:
        return None
    along = (tip - rest[:, 2]) / (tip - root)
    place = np.linspace(0.0, 1.0, SPINE_POINT_COUNT)
    degree = 4  # of the polynomial that gives the spine at rest
    middle = np.polynomial.Polynomial.fit(along, rest[:, 1], degree)
    off = rest[:, 1] - middle(along)
    slices = np.array_split(np.argsort(along), slice_count)
    slice_positions = [along[indices].mean() for indices in slices]
    halves = [np.ptp(off[indices]) / 2 for indices in slices]
    half = np.interp(place, slice_positions, halves)
    spine = np.stack([tip - place * (tip - root), middle(place)], axis=1)
    # Landmarks of the upper lip, and of the lower lip's middle, lower edge and both sides.
    lips = (62, 66, 57, 65, 67)
    return Tongue(
        rest=rest, along=along, spine=spine, off=off, half=np.maximum(half, 0.1),
        lower_edge=_incisor_edge(lower, up=1.0), upper_edge=_incisor_edge(upper, up=-1.0),
        lips=landmarks[list(lips)],
    )  # fmt: skip


def _incisor_edge(teeth: Floats64, *, up: float) -> Floats64:
    """The edge of the incisors of one jaw, in the middle, shape (3,)."""
    incisor_width = 5.0  # mm to each side of the middle that hold the incisors' edges
    incisors = teeth[np.abs(teeth[:, 0]) < incisor_width]
    among = incisors if len(incisors) else teeth
    edge: Floats64 = among[(up * among[:, 1]).argmax()] * (0.0, 1.0, 1.0)
    return edge


def _spine_angles(spine: Floats64) -> Floats64:
    """Angle between the spine towards its tip and the forward axis [rad], at each point."""
    forward, up = -np.gradient(spine, axis=0).T
    return np.unwrap(np.arctan2(up, forward))


def _spine_lengths(spine: Floats64) -> float:
    return float(np.linalg.norm(np.diff(spine, axis=0), axis=1).sum())
