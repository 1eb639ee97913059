"""Make surgical masks: a pleated sheet from the nose's bridge to below the chin, and ear loops.

The sheet is a taut membrane, which rests on the tip of the nose, the chin and the cheeks. It
follows skull and mandible like the skin below it. All sizes are chosen by eye, after usual masks.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import NamedTuple

import numpy as np
import scipy

from ...geometry.arrays import Floats64
from ...geometry.steps import smoothstep
from ..model import MASK_NAME, Part
from .ears import ear_vertices
from .person import Person
from .wires import Colour, Tube, beside_head, joined, sheet, tube

MASK_COLOURS: Mapping[str, Colour] = MappingProxyType(
    {
        "blue": (0.50, 0.68, 0.78),
        "white": (0.84, 0.85, 0.85),
        "black": (0.07, 0.07, 0.08),
    }
)
MASK_SHAPE = (57, 49)  # rows from the nose to the chin, columns from right to left


def mask(person: Person, colour: Colour) -> Part:
    """Make a mask that fits a person; colour: sRGB."""
    axis = person.vertices[person.anatomy["tragion_left"]] * [0.0, 0.0, 1.0]
    axis[2] += 30.0
    turn, height = _sheet_places(person)
    outward = np.stack([np.sin(turn), np.zeros(MASK_SHAPE), np.cos(turn)], axis=-1)
    level = np.stack([np.zeros(MASK_SHAPE), height, np.zeros(MASK_SHAPE)], axis=-1)
    reach = _membrane(_skin_below(person, axis, turn, height))
    down = np.linspace(0.0, 1.0, MASK_SHAPE[0])[:, None]
    aside = np.abs(np.linspace(-1.0, 1.0, MASK_SHAPE[1]))
    pleats, creases = _pleats(down, aside)
    outer = axis + level + (reach + pleats)[..., None] * outward
    thickness = 0.7  # [mm]
    inner = axis + level + (reach - thickness)[..., None] * outward
    is_seam = (down < 0.07) | (down > 0.94) | (aside > 0.94)
    outer_shades = (1.0 - 0.06 * is_seam) * (1.0 - 0.3 * creases)
    shades = np.stack([outer_shades, np.ones(MASK_SHAPE)]).reshape(-1, 1)
    shares = _mandible_weights(person, outer)
    cover = _Piece(sheet(outer, inner), shades * colour, np.tile(shares.ravel(), 2))
    return _joined_pieces([cover, *_ear_loops(person, outer, shares, colour)])


class _Piece(NamedTuple):
    """The sheet of a mask, or a loop."""

    surface: Tube
    colours: Floats64  # sRGB, (n, 3)
    shares: Floats64  # weights of the mandible's motion, 0 to 1, (n,)


def _joined_pieces(pieces: list[_Piece]) -> Part:
    """Join pieces to one part."""
    surface = joined([each.surface for each in pieces])
    return Part(
        name=MASK_NAME,
        vertices=surface.points.astype(np.float32),
        normals=surface.normals.astype(np.float32),
        faces=surface.faces,
        colours=np.vstack([each.colours for each in pieces]).astype(np.float32),
        bone="cranium",
        shine=0.0,
        mandible_shares=np.concatenate([each.shares for each in pieces]).astype(np.float32),
    )


def _ear_loops(person: Person, sheet: Floats64, shares: Floats64, colour: Colour) -> list[_Piece]:
    """Make the four elastics from the corners of the sheet (r, c, 3) to behind the ears.

    shares: weights of the mandible's motion at the sheet's vertices, (r, c).
    """
    pale = 0.5 * (np.array(colour) + max(colour))
    loops = []
    for name, column in (("right", 0), ("left", -1)):
        ear = person.vertices[person.anatomy[f"tragion_{name}"]]
        lobe = person.vertices[ear_vertices(name), 1].min() - 1.5  # height below it [mm]
        for row, rise in ((1, 21.0), (-2, lobe - ear[1])):  # [mm] above the tragion
            path = _loop(person, sheet[row, column], ear, rise)
            surface = tube(path, 1.8, closed=False)
            along = np.linspace(1.0, 0.0, len(path)) * shares[row, column]
            around = len(surface.points) // len(path)
            colours = np.tile(pale, (len(surface.points), 1))
            loops.append(_Piece(surface, colours, np.tile(along, around)))
    return loops


def _sheet_places(person: Person) -> tuple[Floats64, Floats64]:
    """Return angles [rad] and heights [mm] of the sheet's vertices around an axis, both MASK_SHAPE.

    The axis of the cylinder is vertical; angle 0 points forward.
    """
    landmarks = person.vertices[person.landmarks]
    widest = np.radians(66.0)
    across = np.linspace(-1.0, 1.0, MASK_SHAPE[1])
    ear = float(person.vertices[person.anatomy["tragion_left"], 1])
    bridge = float(landmarks[28, 1])
    chin = float(landmarks[8, 1])
    corner = float(landmarks[48, 1])
    top = bridge + (ear - 15.0 - bridge) * smoothstep(np.abs(across), 0.1, 0.95)
    rise = corner - 12.0 - chin + 6.0  # of the lower edge, from the chin to its ends
    bottom = chin - 6.0 + rise * np.abs(across) ** 2.6
    down = np.linspace(0.0, 1.0, MASK_SHAPE[0])[:, None]
    height = top + down * (bottom - top)
    return np.broadcast_to(widest * across, MASK_SHAPE), height


def _skin_below(person: Person, axis: Floats64, turn: Floats64, height: Floats64) -> Floats64:
    """Measure how far the skin under each vertex of the sheet lies from the axis [mm], MASK_SHAPE.

    axis: a point of the axis. turn, height: as `_sheet_places` returns them.
    """
    skin = person.vertices
    corners = skin[person.faces]
    corners = corners[corners[:, :, 2].min(axis=1) > axis[2] - 40.0]
    steps = 8
    first, second = np.meshgrid(np.arange(steps + 1), np.arange(steps + 1))
    is_within = first + second <= steps
    weights = np.stack([first[is_within], second[is_within]], axis=-1) / steps
    weights = np.column_stack([weights, 1.0 - weights.sum(axis=1)])
    points = np.einsum("wk,fkc->fwc", weights, corners).reshape(-1, 3) - axis
    radius = 65.0  # [mm]; converts angles into lengths
    around = radius * np.arctan2(points[:, 0], points[:, 2])
    there = np.column_stack([around, points[:, 1]])
    reach = np.hypot(points[:, 0], points[:, 2])
    places = np.column_stack([radius * turn.ravel(), height.ravel()])
    near = scipy.spatial.cKDTree(there).query_ball_point(places, 2.5)
    found = np.array([reach[each].max() if each else 0.0 for each in near])
    return found.reshape(turn.shape)


def _membrane(skin: Floats64) -> Floats64:
    """Compute a taut sheet's distances from the axis [mm], MASK_SHAPE.

    skin: distances of the skin from the axis [mm], of MASK_SHAPE. The upper edge and the sides of
    the sheet lie on the skin.
    """
    clearance = 2.6  # [mm]
    below = skin + clearance
    sheet = below.copy()
    for _ in range(600):
        by_rows = np.pad(sheet, ((1, 1), (0, 0)), mode="edge")
        by_columns = np.pad(sheet, ((0, 0), (1, 1)), mode="edge")
        # The sheet is stiffer across the pleats than along them, because pleats open.
        mean = 0.3 * (by_rows[:-2] + by_rows[2:])
        mean += 0.2 * (by_columns[:, :-2] + by_columns[:, 2:])
        sheet = np.maximum(below, mean)
        sheet[0] = below[0]
        sheet[:, 0] = below[:, 0]
        sheet[:, -1] = below[:, -1]
    return sheet


def _pleats(down: Floats64, aside: Floats64) -> tuple[Floats64, Floats64]:
    """Return heights of three pleats [mm], and strengths of the dark creases, 0 to 1.

    down: rows from 0 (top) to 1, (r, 1). aside: distances of columns from the middle, 0 to 1, (c,).
    Both results have the shape (r, c).
    """
    count = 3
    place = (down - 0.28) / 0.5 * count  # number of pleats above
    in_pleat = place % 1.0
    phase = np.where((place > 0.0) & (place < count), in_pleat, 0.0)
    flat = smoothstep(aside, 1.0, 0.7)
    height = 1.5 * phase * flat
    is_crease = (place > 0.0) & (place <= count + 0.15) & (in_pleat < 0.14)
    return height, is_crease * (0.35 + 0.65 * flat)


def _mandible_weights(person: Person, sheet: Floats64) -> Floats64:
    """Return weights of the mandible's motion at the sheet's vertices, (r, c).

    They are the weights of the skin, smoothed across the lips.
    """
    near = scipy.spatial.cKDTree(person.vertices).query(sheet, k=4)[1]
    shares = person.mandible_weight[near].mean(axis=-1)
    return np.asarray(scipy.ndimage.gaussian_filter(shares, 3.0, mode="nearest"))


def _loop(person: Person, start: Floats64, ear: Floats64, rise: float) -> Floats64:
    """Lay an elastic from a corner of the sheet to behind the ear: a path [mm], (n, 3).

    ear: the tragion. rise: height above it where the elastic passes the ear [mm].
    """
    side = np.sign(start[0])
    end = ear + np.array([side * 2.5, rise, -4.0])
    straight = beside_head(person.vertices, start, end, 0.9)
    turn = np.linspace(0.0, 1.0, 7)[1:, None]
    backward = turn * [-side * 3.0, 0.0, -14.0]
    toward_ear = turn**2 * [0.0, -0.5 * rise, 0.0]
    return np.vstack([straight, straight[-1] + backward + toward_ear])
