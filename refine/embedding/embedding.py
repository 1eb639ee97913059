"""A fine mesh that follows the smooth surface of a coarse one: a wrap deformer.

Each fine vertex is bound once to a point of the surface at rest (places.py), with its offset from
this point. In a frame the offset turns with the surface: by the mean of the rotations at the
patch's corners (patches.py), weighted by the barycentric coordinates of the point. Point and offset
are continuous across the edges of the coarse mesh, and no triangle is split.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from ...geometry.arrays import Floats32, Floats64, Integers32, Integers64
from ...geometry.directions import unit_vectors
from ...geometry.read_only import read_only
from ...geometry.vectors import Vector, cross, plus, row_of, times, write_row
from ...jit import njit
from ..mesh.connectivity import connect_writable
from ..mesh.creases import with_creases
from ..mesh.normals import SLIVER_SINE
from ..mesh.threads import parallel_for
from ..mesh.validation import (
    LARGEST_COORDINATE,
    as_array,
    checked_mesh,
    take_positions_like_rest,
    used_vertices,
)
from .frames import FRAME_NUMBERS
from .patches import FRAME_COLUMN, SmoothSurface, place_on
from .places import across_edges, has_area, nearest_places, settle


class EmbeddedPoints(NamedTuple):
    """The fine mesh in a frame."""

    positions: Floats64
    """Shape (N, 3)."""
    normals: Floats32 | None
    """Unit normals of `points`, turned with the surface, shape (N, 3); None without bound
    normals.
    """


@dataclass(frozen=True, eq=False, kw_only=True)
class Binding:
    """How each of N fine vertices finds its triangle among the F triangles of the coarse mesh.

    - normals: directions in which the fine surface faces, of any length, shape (N, 3); a zero
      vector allows any direction. A triangle that faces the other way counts as ten mean edges
      farther away, so no vertex of one lip is bound to the other lip where they touch.
    - labels: integers of fine vertices, shape (N,), and of triangles, (F,). A fine vertex is bound
      only to triangles with its label.
    - groups: integers, shape (N,). Fine vertices with the same number are bound to the point of the
      first of them, so a hair keeps its shape.
    - places: triangles, shape (P,), and barycentric coordinates there, (P, 3), which replace the
      search: one for each group, numbered from 0 on, or one for each fine vertex.
    """

    normals: npt.ArrayLike | None = None
    labels: tuple[npt.ArrayLike, npt.ArrayLike] | None = None
    groups: npt.ArrayLike | None = None
    places: tuple[npt.ArrayLike, npt.ArrayLike] | None = None


NEAREST_BINDING = Binding()
"""Each fine vertex is bound to the nearest triangle, whichever way it faces."""


class Embedding:
    """Moves a fine mesh along with a coarse mesh that deforms.

        embedding = refine.Embedding(faces, rest_positions, points)    # once
        fine = embedding.evaluate(positions).positions                 # every frame

    The coarse mesh is not refined and may have any triangles: borders, edges of three triangles,
    several pieces. With the coarse mesh at rest, fine vertices are at their rest positions, to
    rounding. A rigid motion of the coarse mesh moves them rigidly.

    triangles: coarse triangle that each fine vertex is bound to, shape (N,), read only.
    weights: barycentric coordinates of its point on that triangle, shape (N, 3), read only.
    offsets: vectors from the smooth surface to the fine vertices at rest, shape (N, 3), read only.
    """

    def __init__(
        self,
        faces: npt.ArrayLike,
        rest_positions: npt.ArrayLike,
        points: npt.ArrayLike,
        *,
        binding: Binding = NEAREST_BINDING,
        crease_angle: float | None = None,
        stretch_offsets: bool = False,
    ) -> None:
        """Bind `points` at rest, shape (N, 3), to `faces`, (F, 3), of `rest_positions`, (V, 3).

        `binding`: how each fine vertex finds its triangle; by default the nearest one.
        `crease_angle`: edges that are sharper at rest [degrees] stay sharp. `stretch_offsets`:
        whether offsets are also scaled by the stretch of the surface around them; else they only
        turn. Raises ValueError for arrays that do not fit together, points that are not finite, and
        labels or places without a triangle that has an area.
        """
        rest, triangles = checked_mesh(rest_positions, faces)
        fine = checked_vectors("points", points, None)
        directions = None
        if binding.normals is not None:
            directions = checked_vectors("normals", binding.normals, len(fine))
        self._is_used = used_vertices(triangles, len(rest))
        self._positions = rest.copy()
        self._points = rest.astype(np.float32)  # not used; checks all values
        self._faces = triangles
        self._stretch = 1.0 if stretch_offsets else 0.0
        mesh = with_creases(connect_writable(triangles, len(rest)), rest, crease_angle)
        is_proper = has_area(rest, triangles, SLIVER_SINE)
        groups = None
        if binding.groups is not None:
            groups = _checked_labels("groups", binding.groups, len(fine))
        if binding.places is not None:
            found = _checked_places(binding.places, binding.labels, groups, is_proper, len(fine))
        else:
            bound, label_of = _points_by_label(binding.labels, len(fine), is_proper)
            found = nearest_places(fine, directions, rest, triangles, bound)
            surface = SmoothSurface(mesh, rest, np.arange(len(triangles)))
            settle(fine, surface, across_edges(mesh, label_of), *found)
            found = _shared_by_groups(groups, *found)
        self.triangles = read_only(found[0])
        self.weights = read_only(found[1])
        used, numbers = np.unique(self.triangles, return_inverse=True)
        self._numbers = numbers.reshape(-1).astype(np.int32)
        self._surface = SmoothSurface(mesh, rest, used)
        self._normals: Floats32 | None = None
        on_surface = np.empty_like(fine)
        self._place(np.zeros_like(fine), on_surface)
        self.offsets = fine - on_surface
        if directions is not None:
            self._normals = unit_vectors(directions, 1e-300).astype(np.float32)
        self.offsets = read_only(self.offsets)

    def evaluate(
        self, positions: npt.NDArray[np.floating], *, with_normals: bool = True
    ) -> EmbeddedPoints:
        """Return the fine mesh for the coarse mesh at `positions`, shape (V, 3).

        `with_normals`: whether bound normals are also turned, which doubles the time. Raises
        ValueError for another shape and for positions that are not finite.
        """
        take_positions_like_rest(positions, self._is_used, self._positions, self._points)
        self._surface.move(self._positions)
        moved = np.empty_like(self.offsets)
        self._place(self.offsets, moved)
        if self._normals is None or not with_normals:
            return EmbeddedPoints(moved, None)
        turned = np.empty_like(self._normals)
        given_places = self._surface.rows, self._numbers, self.weights
        parallel_for(turn_vectors, len(turned), *given_places, self._normals, turned)
        return EmbeddedPoints(moved, turned)

    def carry(self, values: npt.ArrayLike) -> Floats64:
        """Interpolate values of coarse vertices, (V,) or (V, k), at fine vertices: (N,) or (N, k).

        They are linear in each triangle. Raises ValueError for another number of values.
        """
        table = np.asarray(values, dtype=np.float64)
        if table.ndim == 0 or len(table) != len(self._positions):
            raise ValueError(
                f"values must be one for each of {len(self._positions)} coarse vertices, got "
                f"shape {table.shape}"
            )
        carried: Floats64 = np.einsum(
            "nc,nc...->n...", self.weights, table[self._faces[self.triangles]]
        )
        return carried

    def _place(self, offsets: Floats64, moved: Floats64) -> None:
        places = self._surface.rows, self._numbers, self.weights
        parallel_for(place_points, len(moved), *places, read_only(offsets), self._stretch, moved)


def checked_vectors(name: str, given: npt.ArrayLike, count: int | None) -> Floats64:
    """Return a copy of finite vectors, shape (count, 3); of any number if `count` is None."""
    rows = "N" if count is None else str(count)
    array = as_array(name, given, f"numbers of shape ({rows}, 3)")
    is_shaped = array.ndim == 2 and array.shape[1] == 3 and count in (None, len(array))
    if not is_shaped or array.dtype.kind not in "fiu":
        raise ValueError(
            f"{name} must be numbers of shape ({rows}, 3), got {array.dtype} of shape {array.shape}"
        )
    vectors = np.array(array, dtype=np.float64, order="C")
    bad = np.flatnonzero(~(np.abs(vectors) < LARGEST_COORDINATE).all(axis=1))
    if len(bad) > 0:
        raise ValueError(
            f"{name} must be finite and below {LARGEST_COORDINATE:g}, but row {bad[0]} is "
            f"{vectors[bad[0]]} ({len(bad)} such rows in all); leave them out before binding"
        )
    return vectors


def _shared_by_groups(
    groups: Integers64 | None, triangles: Integers64, weights: Floats64
) -> tuple[Integers64, Floats64]:
    """Return the bound points of fine vertices; a group has the point of its first vertex."""
    if groups is None:
        return triangles, weights
    _, first, number = np.unique(groups, return_index=True, return_inverse=True)
    root = first[number.reshape(-1)]
    return triangles[root], weights[root]


def _checked_places(
    places: tuple[npt.ArrayLike, npt.ArrayLike],
    labels: tuple[npt.ArrayLike, npt.ArrayLike] | None,
    groups: Integers64 | None,
    is_proper: npt.NDArray[np.bool_],
    count: int,
) -> tuple[Integers64, Floats64]:
    """Return the given places after checks, one for each of `count` fine vertices."""
    if labels is not None:
        raise ValueError("places and labels exclude each other; leave one of them out")
    number = np.arange(count) if groups is None else groups
    given = as_array("places[0]", places[0], "integers of shape (P,)")
    wanted = int(number.max(initial=-1)) + 1
    if number.min(initial=0) < 0 or given.shape != (wanted,) or given.dtype.kind not in "iu":
        raise ValueError(
            f"places must be one for each {'fine vertex' if groups is None else 'group'}, numbered "
            f"from 0: integers of shape ({wanted},), got {given.dtype} of shape {given.shape}"
        )
    weights = checked_vectors("places[1]", places[1], wanted)
    bad = ~((weights >= 0.0).all(axis=1) & (np.abs(weights.sum(axis=1) - 1.0) < 1e-6))
    bad |= (given < 0) | (given >= len(is_proper))
    bad[~bad] = ~is_proper[given[~bad]]
    if bad.any():
        raise ValueError(
            f"places must be on triangles with an area, numbered below {len(is_proper)}, with "
            f"weights from 0 to 1 whose sum is 1; place {int(bad.argmax())} is not"
        )
    return given[number].astype(np.int64), weights[number]


def _points_by_label(
    labels: tuple[npt.ArrayLike, npt.ArrayLike] | None,
    count: int,
    is_proper: npt.NDArray[np.bool_],
) -> tuple[list[tuple[Integers64, Integers64]], Integers64]:
    """Return for each label its fine points and triangles; and triangle labels, -1 for none."""
    label_of = np.where(is_proper, 0, -1).astype(np.int64)
    wanted = np.zeros(count, dtype=np.int64)
    names = np.zeros(1, dtype=np.int64)
    if labels is not None:
        fine = _checked_labels("labels[0]", labels[0], count)
        coarse = _checked_labels("labels[1]", labels[1], len(is_proper))
        names, numbers = np.unique(np.concatenate([fine, coarse]), return_inverse=True)
        numbers = numbers.reshape(-1)
        wanted = numbers[:count]
        label_of = np.where(is_proper, numbers[count:], -1).astype(np.int64)
    found = []
    for number in np.unique(wanted):
        allowed = np.flatnonzero(label_of == number)
        if len(allowed) == 0:
            which = f" with label {names[number]}" if labels is not None else ""
            raise ValueError(f"faces must have a triangle{which} with an area to bind points to")
        found.append((np.flatnonzero(wanted == number), allowed))
    return found, label_of


def _checked_labels(name: str, given: npt.ArrayLike, count: int) -> Integers64:
    array = as_array(name, given, f"integers of shape ({count},)")
    if array.shape != (count,) or array.dtype.kind not in "iub":
        raise ValueError(
            f"{name} must be integers of shape ({count},), got {array.dtype} of shape {array.shape}"
        )
    return array.astype(np.int64)


@njit
def turned_at(
    rows: Floats64, t: int, u: float, v: float, w: float, vector: Vector
) -> tuple[Vector, float]:
    """Turn a vector with the place on patch t; also return the stretch there.

    The mean of the corners' quaternions may have any length; a zero mean counts as no turn.
    """
    row = rows[t]
    at = (u, v, w)
    q0 = x = y = z = stretch = 0.0
    for i in range(3):
        column = FRAME_COLUMN + FRAME_NUMBERS * i
        q0 += at[i] * row[column]
        x += at[i] * row[column + 1]
        y += at[i] * row[column + 2]
        z += at[i] * row[column + 3]
        stretch += at[i] * row[column + 4]
    squared = q0 * q0 + x * x + y * y + z * z
    scale = 2.0 / squared if squared > 0.0 else 0.0
    axis = x, y, z
    aside = cross(axis, vector)
    change = times(scale, plus(times(q0, aside), cross(axis, aside)))
    return plus(vector, change), stretch


@njit
def place_points(
    first: int,
    last: int,
    rows: Floats64,
    numbers: Integers32,
    weights: Floats64,
    offsets: Floats64,
    stretched: float,
    moved: Floats64,
) -> None:
    """Write fine points, shape (N, 3): their points on the patches `numbers` plus turned offsets.

    `stretched`: how far offsets follow the stretch of the surface, 0 to 1.
    """
    for k in range(first, last):
        t = numbers[k]
        u, v, w = row_of(weights, k)
        place = place_on(rows, t, u, v, w)
        turned, stretch = turned_at(rows, t, u, v, w, row_of(offsets, k))
        size = 1.0 + stretched * (stretch - 1.0)
        write_row(moved, k, plus(place, times(size, turned)))


@njit
def turn_vectors(
    first: int,
    last: int,
    rows: Floats64,
    numbers: Integers32,
    weights: Floats64,
    vectors: Floats32,
    turned: Floats32,
) -> None:
    """Write vectors at fine points, turned with the surface, shape (N, 3)."""
    for k in range(first, last):
        u, v, w = row_of(weights, k)
        result, _ = turned_at(rows, numbers[k], u, v, w, row_of(vectors, k))
        write_row(turned, k, result)
