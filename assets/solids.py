"""Coloured surfaces for the rigid parts: grids of points that become triangles with normals."""

from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from .smooth import Points, Values
from .topology import Faces, unique_points

Colour = tuple[float, float, float]


@dataclass
class Solid:
    """A surface with a colour per vertex.

    vertices: [mm], shape (n, 3).
    faces: counter-clockwise from the visible side, shape (m, 3).
    colours: sRGB 0..1, shape (n, 3).
    roots: for each vertex the one with which it moves on the skin, shape (n,); -1 for none.
    """

    vertices: Points
    faces: Faces
    colours: npt.NDArray[np.float64]
    roots: npt.NDArray[np.int32] = field(default_factory=lambda: np.zeros(0, np.int32))

    def __post_init__(self) -> None:
        if not len(self.roots):
            self.roots = np.full(len(self.vertices), -1, np.int32)

    def mirrored(self) -> "Solid":
        """Its mirror image on the other side of x = 0."""
        return Solid(
            self.vertices * [-1.0, 1.0, 1.0], self.faces[:, ::-1], self.colours, self.roots
        )


def ball(polar: Values, segments: int) -> tuple[Points, Faces, Values]:
    """Directions, faces and angles around the z axis of a unit ball; the angles from it: `polar`.

    One row of `segments` vertices for each angle [rad]; all three hold one row after the other.
    """
    around = np.tile(2.0 * np.pi * np.arange(segments) / segments, len(polar))
    away = np.repeat(polar, segments)
    directions = np.column_stack(
        [np.sin(away) * np.cos(around), np.sin(away) * np.sin(around), np.cos(away)]
    )
    return directions, grid_faces(len(polar), segments, wrapped=True)[:, ::-1], around


def grid_faces(rows: int, columns: int, *, wrapped: bool = False) -> Faces:
    """Triangles of a grid of vertices in row-major order; `wrapped` joins last and first column."""
    row, column = np.meshgrid(
        np.arange(rows - 1), np.arange(columns if wrapped else columns - 1), indexing="ij"
    )
    following = (column + 1) % columns
    a, b = row * columns + column, row * columns + following
    c, d = (row + 1) * columns + following, (row + 1) * columns + column
    pairs = np.stack([np.stack([a, b, c], -1), np.stack([a, c, d], -1)], axis=2)
    return pairs.reshape(-1, 3).astype(np.int32)


def joined(solids: list[Solid]) -> Solid:
    """One solid from several."""
    starts = np.cumsum([0] + [len(solid.vertices) for solid in solids[:-1]])
    return Solid(
        np.vstack([solid.vertices for solid in solids]),
        np.vstack([solid.faces + start for solid, start in zip(solids, starts, strict=True)]),
        np.vstack([solid.colours for solid in solids]),
        np.concatenate(
            [s.roots + (s.roots >= 0) * start for s, start in zip(solids, starts, strict=True)]
        ).astype(np.int32),
    )


def welded(solid: Solid) -> Solid:
    """Join vertices that coincide and drop the faces that vanish, as at the poles of a grid."""
    first, number = unique_points(np.round(solid.vertices, 6))
    faces = number[solid.faces]
    is_face = (faces != np.roll(faces, 1, axis=1)).all(axis=1)
    return Solid(solid.vertices[first], faces[is_face].astype(np.int32), solid.colours[first])


def mix(first: Colour | npt.NDArray[np.float64], second: Colour, share: Values) -> Points:
    """Blend colours: `share` 0 gives the first, 1 the second; shape (n, 3)."""
    share = np.clip(share, 0.0, 1.0)[:, None]
    return np.asarray(first) * (1.0 - share) + np.asarray(second) * share
