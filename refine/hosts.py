"""Refinement of meshes from other programs, with vertices doubled along seams and any data."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from ..geometry.arrays import Flags, Floats64, Integers32, Integers64, Unsigned8
from ..geometry.read_only import read_only
from .border.plugin import RefinedMesh, View
from .border.registry import create
from .kahler.refiner import Kahler
from .mesh.seams import weld as weld_vertices
from .mesh.validation import checked_mesh

SMOOTH_OPTIONS = {"scheme": "cubic", "criterion": "displacement+rest"}
"""Options that refine regions that bend or are coarse at rest: the defaults of the application."""


class WeldedRefiner:
    """The refiner `kahler` for meshes with doubled vertices, as in VTK, trimesh, glTF and OBJ.

        refiner = WeldedRefiner(points, triangles)
        mesh = refiner.refine(moved, values={"heat": heat})      # every frame
        draw(mesh.positions, mesh.triangles, mesh.attributes["heat"])

    Such a mesh stores a seam vertex twice, because the data on both sides of the seam differ.
    Doubled vertices are welded for refinement, so that no crack opens between them, and are
    separate again in the refined mesh. The default options are those of the application's window,
    `scheme="cubic", criterion="displacement+rest"`, which also smooth a mesh at rest.
    """

    def __init__(
        self,
        points: npt.ArrayLike,
        triangles: npt.ArrayLike,
        *,
        weld: bool = True,
        weld_tolerance: float | None = None,
        seams: bool = True,
        **options: Any,
    ) -> None:
        """Bind to `points` at rest, shape (V, 3), and `triangles`, shape (F, 3).

        `weld`: whether to join vertices at the same place; False for surfaces that touch at rest
        and separate later, such as lips. `weld_tolerance`: largest distance of joined vertices, in
        sizes of the mesh; None for 1e-9, or a few rounding steps of the points' type if these are
        more. `seams`: whether welded vertices are separate again in the output, which is needed
        only if they carry data. `options`: those of `create_kahler` except texture coordinates and
        attributes, which frames bring as values. With `splits`, of the welded `edges`, all frames
        have the same triangles. Raises ValueError as `create` does.
        """
        rest, given = checked_mesh(points, triangles, ("points", "triangles"))
        self.triangles = read_only(given)
        self.point_count = len(rest)
        self._faces = self.triangles
        self._kept = np.arange(len(rest))
        if weld:
            kept, faces = weld_vertices(points, self.triangles, tolerance=weld_tolerance)
            self._kept = kept.astype(np.int64)
            self._faces = faces.astype(np.int64)
        self._parts = seams and len(self._kept) < len(rest)
        self._used = np.unique(self.triangles)  # in the order of values of corners
        # The number of a doubled vertex is used as its texture coordinate.
        numbers = {"uv": np.zeros((len(rest), 2)), "face_uv": self.triangles}
        chosen = {**SMOOTH_OPTIONS, **options}
        if options.get("splits") is not None and "criterion" not in options:
            del chosen["criterion"]
        refiner = create(
            "kahler", self._faces, rest[self._kept], **(numbers if self._parts else {}), **chosen
        )
        assert isinstance(refiner, Kahler)
        self._refiner = refiner
        self._mesh: RefinedMesh | None = None
        self._origins: tuple[Integers64, Floats64] | None = None

    @property
    def edges(self) -> Integers32:
        """End points of each edge, shape (E, 2), among the welded vertices."""
        return self._refiner.edges

    @property
    def splits(self) -> Unsigned8:
        """How often each edge was split in the last frame, shape (E,), read only."""
        return self._refiner.splits

    def refine(
        self,
        points: npt.ArrayLike,
        view: View | None = None,
        values: Mapping[str, npt.ArrayLike] | None = None,
    ) -> RefinedMesh:
        """Turn the positions of all points, shape (V, 3), into triangles, as `Refiner.refine` does.

        `values`: values of the points in this frame, by name, shape (V, ...), of any type. `carry`
        turns them into attributes of the refined mesh. Raises ValueError for another number of
        points or values, or points that are not finite.
        """
        frame = np.asarray(points)
        if frame.shape != (self.point_count, 3):
            raise ValueError(
                f"a frame must have the {self.point_count} points of the mesh that was bound, "
                f"shape ({self.point_count}, 3), got shape {frame.shape}"
            )
        frame = frame if frame.dtype.kind == "f" else frame.astype(np.float64)
        self._mesh = self._refiner.refine(frame[self._kept], view=view)
        if self._refiner.topology is None:
            self._origins = None
        if values:
            carried = {name: self.carry(each) for name, each in values.items()}
            self._mesh = self._mesh._replace(attributes=carried)
        return self._mesh

    def carry(self, values: npt.ArrayLike) -> npt.NDArray[Any]:
        """Interpolate values of input points, (V, ...), at the points of the last frame, (N, ...).

        The interpolation is linear along edges, separately on each side of a seam. The type is
        kept: integers are rounded to the nearest, and values that are not numbers come from the
        nearest point.
        """
        table = np.asarray(values)
        if len(table) != self.point_count:
            raise ValueError(f"{len(table)} values for a mesh of {self.point_count} points")
        if self._origins is None:
            self._origins = self._find_origins()
        rows, weights = self._origins
        nearest = weights.argmax(axis=1)
        carried = np.array(table[rows[np.arange(len(rows)), nearest]])
        if table.dtype.kind in "fciub":
            between = np.flatnonzero(weights.max(axis=1) < 1.0)  # points of the input stay exact
            carried[between] = _weighted_rows(table, rows[between], weights[between])
        return carried

    def _find_origins(self) -> tuple[Integers64, Floats64]:
        """The three input points around each point of the frame, and their weights, (N, 3) each."""
        if self._mesh is None:
            raise ValueError("nothing is refined yet; call refine(points) before carry(values)")
        vertices, weights = self._refiner.origins()
        rows = self._kept[vertices]
        if self._parts:  # each side of a seam has its own doubled vertex
            own = self._refiner.origins_of_values().vertices
            rows = np.where(own >= 0, self._used[own], rows)
        wide = weights.astype(np.float64)
        return rows, wide / wide.sum(axis=1, keepdims=True)  # float32 sums are 1.00000003


def _weighted_rows(
    table: npt.NDArray[Any], rows: Integers64, weights: Floats64
) -> npt.NDArray[Any]:
    """Return weighted means of three rows each, (M, 3), of a table of numbers of any type."""
    if table.dtype.kind == "c":  # as two floats: infinity times a complex is NaN
        pairs = np.ascontiguousarray(table)[..., None].view(table.real.dtype)
        return np.ascontiguousarray(_weighted_rows(pairs, rows, weights)).view(table.dtype)[..., 0]
    corners = table[rows]
    fractions = weights.reshape(weights.shape + (1,) * (table.ndim - 1))
    has_part = np.broadcast_to(fractions > 0.0, corners.shape)
    if table.dtype.kind in "iu" and table.dtype.itemsize == 8:
        return _weighted_integers(corners, fractions, has_part)
    parts = np.zeros(corners.shape, dtype=np.result_type(table.dtype, np.float64))
    np.multiply(corners, fractions, where=has_part, out=parts)  # infinity times zero would be NaN
    mixed = parts.sum(axis=1)
    if table.dtype.kind == "f":  # values equal at all corners stay so to the last bit
        first = np.where(has_part, corners, np.inf).min(axis=1)
        last = np.where(has_part, corners, -np.inf).max(axis=1)
        mixed = np.minimum(np.maximum(mixed, first), last)
    rounded = mixed if table.dtype.kind == "f" else np.rint(mixed)
    return np.asarray(rounded, dtype=table.dtype)


def _weighted_integers(
    corners: npt.NDArray[np.integer], fractions: Floats64, has_part: Flags
) -> npt.NDArray[np.integer]:
    """Return weighted means of integers of 64 bits, shape (M, 3, ...).

    Doubles cannot represent these integers, but they can represent their differences from the least
    of the three. Halves are rounded to the even number, as `numpy.rint` does.
    """
    largest = np.iinfo(corners.dtype).max
    least = np.where(has_part, corners, largest).min(axis=1).astype(np.uint64)
    differences = corners.astype(np.uint64) - least[:, None]
    above = np.where(has_part, differences, np.uint64(0))
    most = above.max(axis=1)
    mean = (above.astype(np.float64) * fractions).sum(axis=1)
    is_below = mean < most.astype(np.float64)
    whole = np.where(is_below, np.floor(mean), 0.0)
    rest = np.where(is_below, mean - whole, 0.0)
    mixed = np.where(is_below, whole.astype(np.uint64), most)
    is_odd = (least + mixed) % 2 == 1
    mixed += (rest > 0.5) | ((rest == 0.5) & is_odd)
    return np.asarray((least + mixed).astype(corners.dtype))
