"""What all built-in refiners share: checking what is bound, lent and handed in, once per kind.

A refiner derives from `BoundRefiner`, sizes its output, and writes one method, `_fill`. Arguments
are copied at binding, so that later changes to the caller's arrays cannot reach a frame; positions
are copied into a buffer at the start of a frame, so that any float type and any strides will do and
the kernels are compiled for one type only.

Source: the plug-in of Kähler, Haber, Seidel 2003, Fig. 1.
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from .connectivity import Connectivity, connect
from .output import GEOMETRY_COLUMNS
from .plugin import Origins, RefinedMesh, Stream


@dataclass(frozen=True)
class OwnStream:
    """The stream a refiner uses when none is lent."""

    vertices: npt.NDArray[np.float32]
    triangles: npt.NDArray[np.uint32]
    source: npt.NDArray[np.int32]


class BoundRefiner(ABC):
    """A mesh that was checked and connected, with buffers for one frame."""

    def __init__(
        self,
        faces: npt.ArrayLike,
        rest_positions: npt.ArrayLike,
        *,
        uv: npt.ArrayLike | None = None,
        face_uv: npt.ArrayLike | None = None,
    ) -> None:
        positions = _checked_positions(rest_positions)
        triangles = _checked_indices("faces", faces, len(positions), "rest_positions")
        coordinates, corner_uv = _checked_texture(uv, face_uv, triangles, len(positions))
        self.connectivity: Connectivity = connect(triangles, len(positions), corner_uv)
        self._rest_positions = positions
        self._positions = positions.copy()
        self._normals = np.zeros((len(positions), 3), dtype=np.float32)
        self._uv = coordinates
        self._own_stream: OwnStream | None = None
        self._accepted: tuple[object, object, object] = (None, None, None)

    @property
    @abstractmethod
    def splits(self) -> npt.NDArray[np.uint8]:
        """How often each edge was split in the last frame, shape (E,)."""

    @property
    @abstractmethod
    def vertex_capacity(self) -> int:
        """Most output vertices a frame can have."""

    @property
    @abstractmethod
    def triangle_capacity(self) -> int:
        """Most output triangles a frame can have."""

    @abstractmethod
    def origins(self) -> Origins:
        """Say for every vertex of the last frame where it lies on the input mesh."""

    @abstractmethod
    def _fill(
        self,
        vertices: npt.NDArray[np.float32],
        triangles: npt.NDArray[np.uint32],
        source: npt.NDArray[np.int32],
    ) -> tuple[int, int]:
        """Write the frame for `self._positions`; return the numbers of vertices and triangles."""

    @property
    def edges(self) -> npt.NDArray[np.int32]:
        """End points of each edge, shape (E, 2)."""
        return self.connectivity.edges

    @property
    def triangle_edges(self) -> npt.NDArray[np.int32]:
        """Edges of each triangle, shape (F, 3); -1 for a triangle that names a vertex twice."""
        return self.connectivity.triangle_edges

    @property
    def vertex_columns(self) -> int:
        """Columns of a stream's vertices: 6, or 8 with texture coordinates."""
        return GEOMETRY_COLUMNS if self._uv is None else GEOMETRY_COLUMNS + 2

    def refine(self, positions: npt.NDArray[np.floating], out: Stream | None = None) -> RefinedMesh:
        """Turn deformed `positions`, shape (V, 3), into triangles; see `plugin.Refiner.refine`.

        Raises ValueError if `positions` or the arrays of `out` have a wrong shape or type.
        """
        positions = np.asarray(positions)
        if positions.shape != self._positions.shape or positions.dtype.kind != "f":
            raise ValueError(
                f"positions must be floats of shape {self._positions.shape} like the mesh that "
                f"was bound, got {positions.dtype} of shape {positions.shape}"
            )
        np.copyto(self._positions, positions)
        stream = self._lend_own_stream() if out is None else out
        vertices, triangles, source = stream.vertices, stream.triangles, stream.source
        accepted = self._accepted
        if vertices is not accepted[0] or triangles is not accepted[1] or source is not accepted[2]:
            self._check_stream(vertices, triangles, source)
            self._accepted = (vertices, triangles, source)
        vertex_count, triangle_count = self._fill(vertices, triangles, source)
        return RefinedMesh(
            vertices[:vertex_count, 0:3],
            vertices[:vertex_count, 3:6],
            triangles[:triangle_count],
            source[:triangle_count],
            None if self._uv is None else vertices[:vertex_count, 6:8],
        )

    def _lend_own_stream(self) -> OwnStream:
        if self._own_stream is None:
            self._own_stream = OwnStream(
                vertices=np.zeros((self.vertex_capacity, self.vertex_columns), dtype=np.float32),
                triangles=np.zeros((self.triangle_capacity, 3), dtype=np.uint32),
                source=np.zeros(self.triangle_capacity, dtype=np.int32),
            )
        return self._own_stream

    def _check_stream(self, vertices: object, triangles: object, source: object) -> None:
        rows = self.triangle_capacity
        _check_lent("vertices", vertices, np.float32, (self.vertex_capacity, self.vertex_columns))
        _check_lent("triangles", triangles, np.uint32, (rows, 3))
        _check_lent("source", source, np.int32, (rows,))

    def _texture_of(self, indices: npt.NDArray[np.int32]) -> npt.NDArray[np.float32]:
        """Texture coordinates by index, shape (..., 2); 0 for index -1; (0, ...) without any."""
        if self._uv is None:
            return np.zeros((0, *indices.shape[1:], 2), dtype=np.float32)
        looked_up = self._uv[indices]
        looked_up[indices < 0] = 0.0
        return looked_up


def _check_lent(name: str, array: object, dtype: type[np.generic], needed: tuple[int, ...]) -> None:
    """Raise ValueError unless `array` can be filled with at least `needed` rows."""
    if (
        isinstance(array, np.ndarray)
        and array.dtype == dtype
        and array.ndim == len(needed)
        and len(array) >= needed[0]
        and array.shape[1:] == needed[1:]
        and array.flags.c_contiguous
        and array.flags.aligned
        and array.flags.writeable
    ):
        return
    if isinstance(array, np.ndarray):
        got = f"{array.dtype} of shape {array.shape}"
        got += "" if array.flags.c_contiguous else ", not contiguous"
        got += "" if array.flags.writeable else ", read-only"
        got += "" if array.flags.aligned else ", not aligned"
    else:
        got = type(array).__name__
    columns = "".join(f", {size}" for size in needed[1:])
    raise ValueError(
        f"stream.{name} must be a writable C-contiguous {np.dtype(dtype)} array of shape "
        f"(>= {needed[0]}{columns}), got {got}; see vertex_capacity, triangle_capacity and "
        "vertex_columns of the refiner"
    )


def _checked_positions(rest_positions: npt.ArrayLike) -> npt.NDArray[np.float64]:
    positions = np.asarray(rest_positions)
    if positions.ndim != 2 or positions.shape[1] != 3 or positions.dtype.kind not in "fiu":
        raise ValueError(
            "rest_positions must be numbers of shape (V, 3), "
            f"got {positions.dtype} of shape {positions.shape}"
        )
    bad = np.flatnonzero(~np.isfinite(positions).all(axis=1))
    if len(bad):
        raise ValueError(
            f"rest_positions must be finite, but vertex {bad[0]} is {positions[bad[0]]} "
            f"({len(bad)} such vertices in all); repair the mesh before binding it"
        )
    return np.array(positions, dtype=np.float64, order="C")


def _checked_indices(
    name: str, indices: npt.ArrayLike, limit: int, target: str
) -> npt.NDArray[np.int64]:
    array = np.asarray(indices)
    if array.size == 0 and array.ndim == 2:
        array = array.astype(np.int64)
    if array.ndim != 2 or array.shape[1] != 3 or array.dtype.kind not in "iu":
        raise ValueError(
            f"{name} must be integers of shape (F, 3), got {array.dtype} of shape {array.shape}; "
            "cut polygons into triangles first"
        )
    bad = np.flatnonzero(((array < 0) | (array >= limit)).any(axis=1))
    if len(bad):
        raise ValueError(
            f"{name} must hold indices from 0 to {limit - 1} into {target}, "
            f"but triangle {bad[0]} is {array[bad[0]].tolist()}"
        )
    return array.astype(np.int64)


def _checked_texture(
    uv: npt.ArrayLike | None,
    face_uv: npt.ArrayLike | None,
    faces: npt.NDArray[np.int64],
    vertex_count: int,
) -> tuple[npt.NDArray[np.float32] | None, npt.NDArray[np.int64] | None]:
    if uv is None:
        if face_uv is not None:
            raise ValueError("face_uv points into uv, but uv is None; pass both or neither")
        return None, None
    coordinates = np.asarray(uv)
    if coordinates.ndim != 2 or coordinates.shape[1] != 2 or coordinates.dtype.kind not in "fiu":
        raise ValueError(
            "uv must be numbers of shape (U, 2), "
            f"got {coordinates.dtype} of shape {coordinates.shape}"
        )
    if not np.isfinite(coordinates).all():
        raise ValueError("uv must be finite, but holds NaN or infinity")
    values = np.array(coordinates, dtype=np.float32)
    if face_uv is None:
        if len(values) != vertex_count:
            raise ValueError(
                f"uv without face_uv needs one row per vertex ({vertex_count}), got {len(values)}; "
                "pass face_uv, shape (F, 3), if corners have coordinates of their own"
            )
        return values, None
    corner_uv = _checked_indices("face_uv", face_uv, len(values), "uv")
    if len(corner_uv) != len(faces):
        raise ValueError(
            f"face_uv must have one row per triangle ({len(faces)}), got {len(corner_uv)}"
        )
    return values, corner_uv
