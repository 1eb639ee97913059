"""Find the jaw of a mesh: its axis in front of the ears, and the angle by which it opens.

An ear stands off the side of a head. So the outline of a horizontal section through the head jumps
outward at the front of the ear. The condyles, around which the jaw turns, lie a finger's breadth in
front of the ear canal, well below the skin.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from ...geometry.arrays import Floats64, Integers32
from ...geometry.normals import points_on_triangles

USUAL_WIDTH = 136.0  # [mm] between landmarks 0 and 16; other lengths hold for this width


def jaw_axis_of(vertices: Floats64, faces: Integers32, landmarks: Floats64) -> Floats64:
    """Find the centres of the right and the left condyle [mm], (2, 3).

    If no ear is found, they are at their usual place behind the eyes.

    vertices: in the face space [mm], (V, 3). faces: (F, 3). landmarks: points [mm], (68, 3).
    """
    width = landmarks[16, 0] - landmarks[0, 0]
    scale = width / USUAL_WIDTH
    eyes = (landmarks[36] + landmarks[45]) / 2.0
    places = (vertices - eyes) / scale
    is_level_with_ear = np.abs(places[:, 1] + 20.0) < 60.0
    is_near = is_level_with_ear & (places[:, 2] > -150.0)
    points = points_on_triangles(places, faces[is_near[faces].all(axis=1)])
    mirrored = points * (-1.0, 1.0, 1.0)
    found = [_ear_place(mirrored), _ear_place(points)]
    ears = [ear for ear in found if ear is not None]
    up = -13.8  # [mm] from the eyes; mean of seven heads with ears, which differ by 4 mm
    forward = -56.7  # [mm]; they differ by 3 mm
    if ears:
        height, front = np.mean(ears, axis=0)
        above_middle = 5.0  # [mm] from an ear's centre up to the canal's upper edge
        before = 14.0  # [mm] from the root of the helix forward to the condyle
        # Size and height of ears vary more than the joint's position, which is bounded.
        up = float(np.clip(height + above_middle, -30.0, -8.0))
        forward = float(np.clip(front + before, -75.0, -40.0))
    out = 0.36 * USUAL_WIDTH
    right = (-out, up, forward)
    left = (out, up, forward)
    return np.asarray(eyes + scale * np.array([right, left]))


def with_human_opening(
    rig: Mapping[str, Any], axis: Floats64, landmarks: Floats64
) -> dict[str, Any]:
    """Scale angle and glide of a rig's jaw so that the mouth opens as far as people's mouths.

    The opening is three quarters of the widest opening, which is 50 mm between the incisors of men.
    It is proportional to the distance from the axis to the teeth. It is measured along the path of
    the teeth, because teeth far below the axis move back as much as down.

    axis: condyles, (2, 3) [mm]. landmarks: (68, 3) [mm]; the lower lip stands for the teeth.
    """
    jaw = dict(rig["jaw"])
    lip = landmarks[66] - axis.mean(axis=0)
    down = -lip[1]
    forward = lip[2]
    reach = float(np.hypot(down, forward))
    opening = 0.75 * 50.0 / 100.0  # relative to the distance from axis to teeth, 100 mm in men
    gains = np.linspace(0.8, 1.3, 51)
    angles = gains * np.radians(jaw["opening_deg"])
    sine = np.sin(angles)
    versine = 1.0 - np.cos(angles)
    _, rise, advance = jaw["opening_glide"]
    sunk = forward * sine - down * versine - gains * rise
    receded = forward * versine + down * sine - gains * advance
    openings = np.hypot(sunk, receded)
    gain = float(np.interp(opening * reach, openings, gains))
    jaw["opening_deg"] *= gain
    jaw["opening_glide"] = [gain * component for component in jaw["opening_glide"]]
    return {**rig, "jaw": jaw}


def _ear_place(points: Floats64) -> tuple[float, float] | None:
    """Find the height of the left ear's centre, and z of its front, relative to the eyes [mm].

    points: relative to the eyes [mm], (n, 3). None if fewer than five sections show an ear.
    """
    heights = np.arange(-64.0, 16.0, 4.0)
    depths = np.arange(-24.0, -130.0, -2.0)
    fronts = np.full(len(heights), np.nan)
    for row, height in enumerate(heights):
        section = points[np.abs(points[:, 1] - height) < 2.5]
        outline = _outline(section, depths)
        fronts[row] = _ear_front(outline, depths)
    has_ear = ~np.isnan(fronts)
    if has_ear.sum() < 5:
        return None
    # Ears may be long, but most sections meet the front at the root of the ear.
    front = float(np.median(fronts[has_ear]))
    return float(heights[has_ear].mean()), front


def _outline(section: Floats64, depths: Floats64) -> Floats64:
    """Return the greatest x of a section at each depth [mm], (n,); 0 behind the mesh."""
    reach = np.full(len(depths), -np.inf)
    row = np.round((depths[0] - section[:, 2]) / 2.0).astype(np.int64)
    inside = (row >= 0) & (row < len(depths))
    np.maximum.at(reach, row[inside], section[inside, 0])
    known = reach > 0.0
    if known.sum() < 10:
        return np.zeros(len(depths))
    # Behind the end of the mesh the outline must not jump outward.
    return np.asarray(np.interp(-depths, -depths[known], reach[known], right=0.0))


def _ear_front(reach: Floats64, depths: Floats64) -> float:
    """Find the depth of an ear's front [mm], where the outline jumps outward; NaN without ear."""
    for row in range(4, len(depths) - 12):
        leap = reach[row] - reach[row - 4]
        stands_out = reach[row : row + 12].max() - reach[row - 4]
        if leap > 4.0 and stands_out > 9.0:
            return float(depths[row])
    return np.nan
