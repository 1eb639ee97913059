"""Make shirts of several colours and four collars: a band, a roll, wings or a V.

The built-in shirt ends in a band. Other collars are laid on this shirt, so they fit any neck. Their
points have two coordinates on its surface: the column, and the depth below the upper edge of the
band. All sizes are chosen by eye, after usual shirts and jerseys.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import NamedTuple

import numpy as np
import scipy

from ...geometry.arrays import Floats64
from ...geometry.directions import unit_vectors
from ...geometry.normals import vertex_normals
from ...geometry.rays import crossings
from ...geometry.steps import smoothstep
from ..model import Part
from ..topology import grid_faces
from .wires import Colour, Tube, joined, sheet

SHIRT_COLOURS: Mapping[str, Colour] = MappingProxyType(
    {
        "blue": (0.22, 0.24, 0.28),  # the shirt of the built-in head
        "white": (0.80, 0.79, 0.77),
        "grey": (0.46, 0.46, 0.47),
        "black": (0.09, 0.09, 0.10),
        "red": (0.47, 0.13, 0.13),
        "green": (0.20, 0.33, 0.24),
        "sand": (0.66, 0.57, 0.44),
        "sky": (0.47, 0.59, 0.72),
    }
)
SHIRT_COLUMNS = 52  # columns of the built-in shirt; number 0 is in front, the next ones on the left
NECK_AXIS = np.array([0.0, 0.0, -8.0])  # [mm]; a point of the vertical axis
BAND_ROW = 4  # row of the built-in shirt at the upper outer edge of the band


class _Cloth(NamedTuple):
    """A piece of a shirt, and the colours of its points, sRGB, (n, 3)."""

    surface: Tube
    colours: Floats64


def in_shirt(shirt: Part, skin: Floats64, colour: str, collar: str) -> Part:
    """Give the built-in shirt a colour of SHIRT_COLOURS and a collar of COLLAR_BUILDERS.

    skin: triangles of the person's head [mm], (F, 3, 3). Raises KeyError for other colours and
    collars.
    """
    pieces = COLLAR_BUILDERS[collar](shirt, skin, np.array(SHIRT_COLOURS[colour]))
    surface = joined([each.surface for each in pieces])
    return replace(
        shirt,
        vertices=surface.points.astype(np.float32),
        normals=surface.normals.astype(np.float32),
        faces=surface.faces,
        colours=np.clip(np.vstack([each.colours for each in pieces]), 0.0, 1.0).astype(np.float32),
    )


def _in_colour(shirt: Part, colour: Floats64) -> _Cloth:
    """Change the colour (sRGB, (3,)) of the built-in shirt, and keep its shades."""
    shade = shirt.colours / np.array(SHIRT_COLOURS["blue"])
    vertices, normals = (each.astype(np.float64) for each in (shirt.vertices, shirt.normals))
    return _Cloth(Tube(vertices, normals, shirt.faces), shade * colour)


def _unshaded_colour(shirt: Part, colour: Floats64) -> Floats64:
    """Return the unshaded colour of a person's shirt, sRGB, (3,)."""
    return np.asarray(np.median(shirt.colours, axis=0) / np.array(SHIRT_COLOURS["blue"]) * colour)


def _shirt_with_band(shirt: Part, skin: Floats64, colour: Floats64) -> list[_Cloth]:
    """Make the built-in shirt in another colour."""
    return [_in_colour(shirt, colour)]


def _shirt_with_roll(shirt: Part, skin: Floats64, colour: Floats64) -> list[_Cloth]:
    """Make a shirt with a high collar that is folded over."""
    columns = np.linspace(0.0, SHIRT_COLUMNS, 3 * SHIRT_COLUMNS, endpoint=False)
    surface = _Surface(shirt)
    band, root = (
        scipy.ndimage.gaussian_filter1d(surface.down(columns, depth)[0], 4.0, axis=0, mode="wrap")
        for depth in (np.zeros((1, 1)), np.full((1, 1), 17.0))
    )
    to_back = 0.5 - 0.5 * np.cos(2.0 * np.pi * columns / SHIRT_COLUMNS)
    rise = (15.0 + 7.0 * to_back)[:, None]  # [mm] above the band
    upper = band + rise * [0.0, 1.0, 0.0] + (5.0 - 1.0 * to_back)[:, None] * [0.0, 0.0, 1.0]
    inner = _off_skin(upper, skin)
    out = unit_vectors((inner - NECK_AXIS) * [1.0, 0.0, 1.0])
    # Pairs: fraction of the distance from the upper edge down to the root, outward offset [mm].
    profile = [(0.9, -3.0), (0.35, 0.0), (0.06, 0.2), (0.0, 1.6), (0.03, 3.6), (0.14, 5.2)]
    profile += [(0.35, 6.2), (0.6, 6.6), (0.82, 6.4), (0.95, 5.4), (1.0, 3.4), (0.97, 0.5)]
    wave = 0.5 * np.sin(2.0 * np.pi * 3.0 * columns / SHIRT_COLUMNS)[:, None]
    rows = []
    for fraction, outside in profile:
        there = inner + fraction * (root - inner)
        rows.append(there + (outside + wave * (outside > 3.0)) * out)
    shades = np.array([0.3, 0.4, 0.6, 0.9, 1.0, 1.0, 0.99, 0.98, 0.97, 0.93, 0.75, 0.45])
    ribs = shades[:, None] * _ribs(len(columns))
    roll = _piece_of_rows(np.stack(rows), ribs, _unshaded_colour(shirt, colour), closed=True)
    return [_in_colour(shirt, colour), roll]


def _ribs(count: int) -> Floats64:
    """Return shades of knitted columns, (count,); each rib is two columns wide."""
    return np.where(np.arange(count) % 2, 0.9, 1.03)


def _shirt_with_wings(shirt: Part, skin: Floats64, colour: Floats64) -> list[_Cloth]:
    """Make a shirt with a turned-down collar and a buttoned front."""
    surface = _Surface(shirt)
    down = np.linspace(0.0, 1.0, 13)[:, None]
    along = 0.5 - 0.5 * np.cos(np.pi * np.linspace(0.0, 1.0, 61))  # from one tip to the other
    opening = 0.35 + 3.6 * down**0.6  # columns between the midline and each edge of the collar
    columns = opening + along * (SHIRT_COLUMNS - 2.0 * opening)
    from_front = np.minimum(columns, SHIRT_COLUMNS - columns)
    length = 37.0 + 24.0 * smoothstep(from_front, 9.0, 0.0)
    fold = surface.down(columns, np.zeros_like(columns))
    hem = surface.down(columns, length) + 2.6 * surface.outward(columns, length)
    lift = np.array([0.0, 2.2, 0.0])  # [mm]; height of the fold above the band
    out = surface.outward(columns, np.full_like(columns, 8.0))
    bulge = 4.0 * (down * (1.0 - down))[..., None] + 1.2
    outer = fold + lift + down[..., None] * (hem - fold - lift) + bulge * out
    upper_edge = columns[:1]
    shallow, deep = (surface.down(upper_edge, np.full_like(upper_edge, d)) for d in (1.0, 5.0))
    thickness = 1.3  # [mm]
    inner = outer - thickness * _surface_of(outer).normals.reshape(outer.shape)
    rows = np.vstack([deep, shallow + 0.6 * lift, outer[:1]])
    seam = np.minimum(1.0 - down, 1.2 * np.minimum(along, 1.0 - along))
    shades = 1.03 - 0.12 * (np.abs(seam - 0.1) < 0.03)
    plain = _unshaded_colour(shirt, colour)
    leaf = _Cloth(sheet(outer, inner), np.tile(shades.ravel(), 2)[:, None] * plain)
    tucked = _piece_of_rows(rows, np.array([[0.35], [0.6], [0.95]]), plain)
    return [_in_colour(shirt, colour), tucked, leaf, *_button_strip(surface, plain)]


def _button_strip(surface: _Surface, colour: Floats64) -> list[_Cloth]:
    """Make the strip down the front, and three buttons on it."""
    across = np.array([-15.0, -14.0, -11.0, 0.0, 11.0, 14.0, 15.0])  # [mm]
    away = np.array([-1.0, 1.2, 1.5, 1.5, 1.5, 1.2, -1.0])
    depths = np.linspace(1.0, 200.0, 60)[:, None]
    columns = surface.columns_at(np.broadcast_to(across, (len(depths), len(across))), depths)
    strip = surface.down(columns, depths) + away[:, None] * surface.outward(columns, depths)
    shades = np.array([0.6, 0.8, 1.0, 1.0, 1.0, 0.8, 0.6])
    pieces = [_piece_of_rows(strip, shades, colour)]
    light = 0.35 * colour + 0.6
    turn = np.linspace(0.0, 2.0 * np.pi, 24, endpoint=False)
    for depth in (8.0, 76.0, 152.0):
        midline = np.zeros((2, 1))
        centre, below = surface.down(midline, np.array([[depth], [depth + 6.0]]))[:, 0]
        slope = unit_vectors(centre - below)
        out = np.cross([1.0, 0.0, 0.0], slope)
        aside = np.sin(turn)[:, None] * [1.0, 0.0, 0.0]
        around = aside + np.cos(turn)[:, None] * slope
        profile = ((5.3, 1.2), (5.3, 3.2), (4.6, 3.6), (3.4, 3.2), (0.05, 3.1))
        rows = [centre + radius * around + height * out for radius, height in profile]
        # Triangles run counter-clockwise, seen from outside.
        rims = np.stack(rows)[::-1, :]
        shades = np.array([0.9, 0.9, 1.05, 0.95, 0.8])
        pieces.append(_piece_of_rows(rims, shades[:, None], light, closed=True))
    return pieces


def _shirt_with_v_neck(shirt: Part, skin: Floats64, colour: Floats64) -> list[_Cloth]:
    """Make a jersey with a V neck over a shirt of another colour."""
    surface = _Surface(shirt)
    # The left half of the V, from its lowest point to the side of the neck.
    half = np.linspace(0.0, 1.0, 200)[:, None]
    lowest = 84.0  # [mm] below the band
    beside = 17.5
    line = lowest + (beside - lowest) * half
    found = surface.columns_at(58.0 * half, line)[:, 0]
    columns = np.linspace(0.0, SHIRT_COLUMNS, 3 * SHIRT_COLUMNS, endpoint=False)
    from_front = np.minimum(columns, SHIRT_COLUMNS - columns)
    edge = np.interp(from_front, found, line[:, 0])
    ribbed = 15.0  # [mm]; width of the ribbed border
    steps = np.array([0.0, 0.0, 1.0, 4.0, 8.0, 12.0, ribbed, ribbed + 1.5, ribbed + 4.0])
    away = np.array([0.2, 2.2, 3.1, 3.4, 3.4, 3.2, 2.6, 2.0, 2.6])
    shades = np.array([0.5, 0.85, 1.0, 1.0, 1.0, 0.97, 0.8, 0.7, 0.95])
    rest = np.linspace(0.0, 1.0, 16)[1:, None]
    first = edge + steps[-1]
    depths = np.vstack([edge + steps[:, None], first + rest * (surface.lowest(columns) - first)])
    away = np.append(away, np.full(len(rest), 2.6))
    shades = np.append(shades, np.ones(len(rest)))
    outward = surface.outward(columns, depths)
    points = surface.down(columns, depths) + away[:, None, None] * outward
    is_light = colour.mean() > 0.5
    below = np.array(SHIRT_COLOURS["blue" if is_light else "white"])
    knitted = shades[:, None] * np.ones(len(columns))
    knitted[1:6] *= _ribs(len(columns))
    jersey = _piece_of_rows(points, knitted, _unshaded_colour(shirt, colour), closed=True)
    return [_in_colour(shirt, below), jersey]


COLLAR_BUILDERS: Mapping[str, Callable[[Part, Floats64, Floats64], list[_Cloth]]] = (
    MappingProxyType(
        {
            "band": _shirt_with_band,
            "roll": _shirt_with_roll,
            "wings": _shirt_with_wings,
            "v": _shirt_with_v_neck,
        }
    )
)


class _Surface:
    """The outer surface of the built-in shirt, from the upper edge of the band down.

    A point has two coordinates: a fractional column, 0 to SHIRT_COLUMNS, and a depth below the edge
    [mm].
    """

    def __init__(self, shirt: Part) -> None:
        rows = (len(shirt.vertices) - 1) // SHIRT_COLUMNS
        on_grid = shirt.vertices[: rows * SHIRT_COLUMNS].astype(np.float64)
        grid = on_grid.reshape(rows, SHIRT_COLUMNS, 3)
        self._grid = np.concatenate([grid, grid[:, :1]], axis=1)[BAND_ROW:-1]
        lengths = np.linalg.norm(np.diff(self._grid, axis=0), axis=-1)
        self._depths = np.vstack([np.zeros(SHIRT_COLUMNS + 1), np.cumsum(lengths, axis=0)])
        normals = vertex_normals(shirt.vertices.astype(np.float64), shirt.faces)
        outward = normals[: rows * SHIRT_COLUMNS].reshape(rows, SHIRT_COLUMNS, 3)
        self._normals = np.concatenate([outward, outward[:, :1]], axis=1)[BAND_ROW:-1]

    def lowest(self, columns: Floats64) -> Floats64:
        """Return depths of the shirt's lower edge [mm], of the shape of `columns`."""
        return np.asarray(np.interp(columns, np.arange(SHIRT_COLUMNS + 1), self._depths[-1]))

    def down(self, columns: Floats64, depths: Floats64) -> Floats64:
        """Return points [mm], (r, n, 3), at columns and depths [mm] that broadcast to (r, n)."""
        return self._read(self._grid, columns, depths)

    def outward(self, columns: Floats64, depths: Floats64) -> Floats64:
        """Return unit normals, (r, n, 3), at columns and depths [mm] that broadcast to (r, n)."""
        return unit_vectors(self._read(self._normals, columns, depths))

    def columns_at(self, across: Floats64, depths: Floats64) -> Floats64:
        """Find columns of the front, (r, n), where x is `across` [mm]; depths: [mm], (r, 1)."""
        places = np.linspace(-13.0, 13.0, 131)
        all_depths = np.broadcast_to(depths, (len(depths), len(places)))
        found = self.down(places % SHIRT_COLUMNS, all_depths)
        rows = [np.interp(x, line[:, 0], places) for x, line in zip(across, found, strict=True)]
        return np.stack(rows) % SHIRT_COLUMNS

    def _read(self, values: Floats64, columns: Floats64, depths: Floats64) -> Floats64:
        """Interpolate values of the grid's points, linearly between columns and between rows."""
        columns, depths = np.broadcast_arrays(columns, depths)
        before = np.minimum(columns.astype(int), SHIRT_COLUMNS - 1)
        after = before + 1
        fraction = columns - before
        # Depths of all rows in these columns, (rows, r, n).
        lengths = self._depths[:, before] + fraction * np.diff(self._depths, axis=1)[:, before]
        row = np.clip((lengths <= depths).sum(axis=0) - 1, 0, len(lengths) - 2)
        upper = np.take_along_axis(lengths, row[None], axis=0)[0]
        lower = np.take_along_axis(lengths, row[None] + 1, axis=0)[0]
        part = np.clip((depths - upper) / (lower - upper), 0.0, 1.0)[..., None]
        fraction = fraction[..., None]
        above = values[row, before] + fraction * (values[row, after] - values[row, before])
        row = row + 1
        below = values[row, before] * (1.0 - fraction) + fraction * values[row, after]
        return np.asarray(above + part * (below - above))


def with_wide_band(shirt: Part, skin: Floats64) -> Part:
    """Widen the band of the built-in shirt where a person's neck is wider than the band.

    skin: triangles of the person's head [mm], (F, 3, 3).
    """
    clearance = 2.5  # [mm]; space in which the neck moves as the head turns
    points = shirt.vertices.astype(np.float64)
    rows = points[: len(points) // SHIRT_COLUMNS * SHIRT_COLUMNS].reshape(-1, SHIRT_COLUMNS, 3)
    upper = rows[BAND_ROW - 2 : BAND_ROW + 2]
    apart = (upper - NECK_AXIS) * [1.0, 0.0, 1.0]
    skins = _reach_of_skin(upper, skin)
    missing = np.maximum(skins + clearance - np.linalg.norm(apart, axis=2), 0.0).max(axis=0)
    widest = scipy.ndimage.maximum_filter1d(missing, 5, mode="wrap")
    smooth = scipy.ndimage.gaussian_filter1d(widest, 1.0, mode="wrap")
    depth = rows[BAND_ROW, :, 1] - rows[..., 1]
    share = smoothstep(depth, 45.0, 15.0)
    outward = unit_vectors((rows - NECK_AXIS) * [1.0, 0.0, 1.0])
    moved = rows + (share * smooth)[..., None] * outward
    widened = np.vstack([moved.reshape(-1, 3), points[rows[..., 0].size :]])
    return replace(shirt, vertices=widened.astype(np.float32))


def _reach_of_skin(points: Floats64, triangles: Floats64) -> Floats64:
    """Return how far the skin is from the neck's axis [mm] at the heights and angles of points.

    points: (r, c, 3). triangles: of the skin, (F, 3, 3). Returns (r, c); 0 where no skin is.
    """
    near = triangles[triangles[..., 1].min(axis=1) < points[..., 1].max()]
    starts = points * [0.0, 1.0, 0.0] + NECK_AXIS
    outward = unit_vectors((points - NECK_AXIS) * [1.0, 0.0, 1.0])
    # Each line is intersected with each triangle.
    origins = starts.reshape(-1, 3).repeat(len(near), axis=0)
    directions = outward.reshape(-1, 3).repeat(len(near), axis=0)
    corners = np.tile(near, (points[..., 0].size, 1, 1))
    volume, u, v, reach = crossings(origins, directions, corners)
    is_met = (volume < 0.0) & (u >= 0.0) & (v >= 0.0) & (u + v <= 1.0) & (reach > 0.0)
    lengths = np.where(is_met, reach, 0.0).reshape(*points.shape[:2], -1)
    return np.asarray(lengths.max(axis=2))


def _off_skin(points: Floats64, triangles: Floats64) -> Floats64:
    """Move points around the neck, (n, 3), outward off the skin's triangles (F, 3, 3)."""
    clearance = 3.0 + 1.5 * (points[:, 2] < NECK_AXIS[2])  # [mm]; more at the back: heads bend
    apart = (points - NECK_AXIS) * [1.0, 0.0, 1.0]
    reach = np.linalg.norm(apart, axis=1)
    wanted = np.maximum(reach, _reach_of_skin(points[None], triangles)[0] + clearance)
    wanted = scipy.ndimage.gaussian_filter1d(wanted, 2.0, mode="wrap")
    return np.asarray(points + (wanted - reach)[:, None] * unit_vectors(apart))


def _surface_of(points: Floats64, *, closed: bool = False) -> Tube:
    """Make a surface of rows of points, (r, n, 3); closed: the last column joins the first."""
    numbers = np.arange(points[..., 0].size).reshape(points.shape[:2])
    faces = grid_faces(numbers, closed=closed)
    places = points.reshape(-1, 3)
    return Tube(places, vertex_normals(places, faces), faces)


def _piece_of_rows(
    points: Floats64, shades: Floats64, colour: Floats64, *, closed: bool = False
) -> _Cloth:
    """Make a piece of rows of points, (r, n, 3); shades: factors on colour, broadcast to (r, n)."""
    shaded = np.broadcast_to(shades, points.shape[:2]).reshape(-1, 1) * colour
    return _Cloth(_surface_of(points, closed=closed), shaded)
