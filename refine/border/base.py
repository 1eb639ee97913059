"""Base class of all built-in refiners: it checks the mesh, the caller's arrays and positions.

A refiner derives from `BaseRefiner`, states the largest size of its output, and implements one
method, `fill`. A refiner of another package may also derive from it, or only follow the protocol
(plugin.py).

Source: the plug-in of Kähler, Haber, Seidel 2003, Fig. 1.
"""

from abc import abstractmethod
from collections.abc import Mapping
from functools import cached_property
from types import MappingProxyType
from weakref import WeakValueDictionary

import numpy as np
import numpy.typing as npt

from ...geometry.arrays import Floats32, Floats64, Integers32, Unsigned8, Unsigned32
from ...geometry.read_only import read_only
from ..mesh.connectivity import Connectivity, connect_writable
from ..mesh.creases import with_creases
from ..mesh.normals import vertex_normals
from ..mesh.validation import as_array, checked_mesh, take_positions, used_vertices
from .corner_values import AttributeLike, checked_corner_values
from .frame_values import FrameValues, FrameValuesLike, refuse
from .plugin import Origins, RefinedMesh, Refiner, Stream, View
from .rows import GEOMETRY_COLUMNS, spread_over_wedges, wedge_values, write_wedges
from .stream import OwnStream, StreamArrays, check_lent


class BaseRefiner(Refiner):
    """Base class of refiners: it binds a mesh, checks its input, and fills the caller's arrays.

    A subclass defines `vertex_capacity`, `triangle_capacity` and `fill`, and extends `origins` by
    its own points. `fill` is called once in every frame, after the positions have been checked. It
    must call `reserve` for its rows, `find_normals` if it needs normals, and `write_wedges`.

    The first W rows are the wedges of the mesh: row v is vertex v, copies of vertices on texture
    seams follow, and `connectivity.corners` lists the rows of each triangle. So a point that is a
    weighted mean of a triangle's corners is the same mean of these rows, including texture
    coordinates and attributes.
    """

    connectivity: Connectivity
    """Edges, neighbours and wedges of the mesh, found once; read only."""
    rest_positions: Floats64
    """Undeformed vertex positions, shape (V, 3); read only."""
    positions: Floats64
    """Positions of this frame, copied because a simulation may continue meanwhile."""
    points: Floats32
    """`positions` in single precision."""
    normals: Floats32
    """Vertex normals of this frame after `find_normals`, shape (V, 3)."""
    edge_splits: Unsigned8
    """The splits of every edge: `fill` writes them, `splits` returns them; 0 at first."""

    def __init__(
        self,
        faces: npt.ArrayLike,
        rest_positions: npt.ArrayLike,
        *,
        uv: npt.ArrayLike | None = None,
        face_uv: npt.ArrayLike | None = None,
        attributes: Mapping[str, AttributeLike] | None = None,
        crease_angle: float | None = None,
    ) -> None:
        """Check and connect the mesh (see `registry.create`); a subclass passes `values` on."""
        positions, triangles = checked_mesh(rest_positions, faces)
        self._values = checked_corner_values(
            triangles, len(positions), uv=uv, face_uv=face_uv, attributes=attributes
        )
        corners = None if self._values is None else self._values.corners
        mesh = connect_writable(triangles, len(positions), corners)
        self._mesh = with_creases(mesh, positions, crease_angle)
        self.connectivity = self._mesh.read_only()
        self._frame_values: FrameValues | None = None
        if self._values is not None:
            self._frame_values = FrameValues(self._values)
            self._wedge_values = wedge_values(self.connectivity, self._values.values)
        self.rest_positions = read_only(positions)
        self.positions = positions.copy()
        self.points = positions.astype(np.float32)
        self.normals = np.zeros_like(self.points)
        self.edge_splits = np.zeros(len(self.connectivity.edges), dtype=np.uint8)
        self._shape = positions.shape
        self._is_used = used_vertices(triangles, len(positions))
        self._accepted: StreamArrays = _NO_ROWS
        self._geometry: tuple[Floats32, Floats32]

    @abstractmethod
    def fill(self, stream: Stream, view: View | None) -> tuple[int, int]:
        """Write the frame for `positions` into the rows of the stream that `reserve` returns.

        Returns the numbers of vertices and triangles that were written.
        """

    def reserve(self, stream: Stream, vertex_count: int, triangle_count: int) -> StreamArrays:
        """Return the checked arrays of `stream`; enlarge the refiner's own stream if needed."""
        own = self._own_stream
        if stream is own:
            own.reserve(vertex_count, triangle_count)
            seen = self._accepted
            if seen.vertices is not own.vertices or seen.triangles is not own.triangles:
                self._take_arrays(own.vertices, own.triangles, own.source)
        return self._accepted

    def find_normals(self) -> None:
        """Write the vertex normals of `positions` into `normals`."""
        vertex_normals(self.positions, self._mesh.faces, self.normals)

    def write_wedges(self, rows: Floats32) -> None:
        """Write copies of vertices along texture seams, and all texture coordinates and attributes.

        The first V rows have positions and normals already.
        """
        if self._values is not None:
            write_wedges(self.connectivity, self._wedge_values, rows)

    def follow_values(self) -> None:
        """Use the new values of a frame; a subclass with copies of values extends this method.

        It is called before `fill` if the values differ from those of the frame before.
        """
        assert self._values is not None
        spread_over_wedges(self._values.values, self._mesh.wedge_uv, self._wedge_values)

    def origins(self) -> Origins:
        """Return the origins of the wedges on the input mesh; a subclass appends its points."""
        return Origins.at(self.connectivity.wedge_vertices)

    def __reduce__(self) -> str:
        """Raise TypeError: arrays of a refiner share memory, and arrays of a copy would not."""
        raise TypeError(
            "a refiner cannot be copied, pickled or sent to another process; make one there with "
            "refine.create from the same faces and rest positions"
        )

    @property
    def splits(self) -> Unsigned8:
        """How often each edge was split in the last frame, shape (E,), read only."""
        return read_only(self.edge_splits)

    @property
    def edges(self) -> Integers32:
        """End points of each edge, shape (E, 2)."""
        return self.connectivity.edges

    @property
    def triangle_edges(self) -> Integers32:
        """Edges of each triangle, shape (F, 3); -1 for a triangle that names a vertex twice."""
        return self.connectivity.triangle_edges

    @property
    def vertex_columns(self) -> int:
        """Columns of a stream's vertices: 6, plus 2 with texture coordinates, plus attributes."""
        return GEOMETRY_COLUMNS + (0 if self._values is None else self._values.values.shape[1])

    def refine(
        self,
        positions: npt.NDArray[np.floating],
        out: Stream | None = None,
        view: View | None = None,
        values: FrameValuesLike | None = None,
    ) -> RefinedMesh:
        """Turn deformed `positions`, shape (V, 3), into triangles; see `Refiner.refine`.

        Raises ValueError if `positions`, `values` or the arrays of `out` have a wrong shape or
        type, if positions or values are not finite, or if values have a name that was not bound.
        """
        stream = self._own_stream if out is None else out
        if out is not None:
            self._accept(out, self.vertex_capacity, self.triangle_capacity)
        self.take_frame(positions, view, values)
        vertex_count, triangle_count = self.fill(stream, view)
        vertices, triangles, source = self._accepted
        shown, normals = self._geometry
        uv = None
        attributes = _NO_ATTRIBUTES
        if self._values is not None:
            uv, attributes = self.values_in(vertices[:vertex_count])
        return RefinedMesh(
            shown[:vertex_count],
            normals[:vertex_count],
            triangles[:triangle_count],
            source[:triangle_count],
            uv,
            attributes,
        )

    def take_frame(
        self,
        positions: npt.NDArray[np.floating],
        view: View | None,
        values: FrameValuesLike | None = None,
    ) -> None:
        """Check and copy the positions and values of a frame.

        Positions go into `positions` and `points`. Raises ValueError as `refine` does.
        """
        if type(positions) is not np.ndarray:
            positions = as_array("positions", positions, f"floats of shape {self._shape}")
        if view is not None and not isinstance(view, View):
            raise ValueError(f"view must be a refine.View(eye), got {type(view).__name__}")
        if positions.shape != self._shape or positions.dtype.kind != "f":
            raise ValueError(
                f"positions must be floats of shape {self._shape} like the mesh that was bound, "
                f"got {positions.dtype} of shape {positions.shape}"
            )
        take_positions(positions, self._is_used, self.positions, self.points)
        if self._frame_values is None:
            refuse(values)
        elif self._frame_values.update(values):
            self.follow_values()

    def _claim(self, *things: object) -> None:
        """Raise ValueError if one of these objects already serves another refiner."""
        for thing in things:
            if _owners.get(id(thing), self) is not self:
                raise ValueError(
                    f"this {type(thing).__name__} serves another refiner already; "
                    "make one for each refiner"
                )
            _owners[id(thing)] = self

    def _accept(self, stream: Stream, vertex_count: int, triangle_count: int) -> None:
        """Raise ValueError unless the arrays are large enough; unchanged arrays pass quickly."""
        try:
            vertices = stream.vertices
            triangles = stream.triangles
            source = stream.source
        except AttributeError as error:
            raise ValueError(
                "a stream must have the arrays vertices, triangles and source "
                f"(refine.Stream); {type(stream).__name__} has no {error.name}"
            ) from None
        accepted = self._accepted
        is_known = vertices is accepted[0] and triangles is accepted[1] and source is accepted[2]
        if is_known and len(vertices) >= vertex_count and len(triangles) >= triangle_count:
            if vertices.flags.writeable and triangles.flags.writeable and source.flags.writeable:
                return
        check_lent("vertices", vertices, np.float32, (vertex_count, self.vertex_columns))
        check_lent("triangles", triangles, np.uint32, (triangle_count, 3))
        check_lent("source", source, np.int32, (triangle_count,))
        self._take_arrays(vertices, triangles, source)

    def _take_arrays(self, vertices: Floats32, triangles: Unsigned32, source: Integers32) -> None:
        self._accepted = StreamArrays(vertices, triangles, source)
        self._geometry = vertices[:, 0:3], vertices[:, 3:6]

    @cached_property
    def _own_stream(self) -> OwnStream:
        """The stream for frames for which the caller lends none."""
        return OwnStream(self.vertex_columns, self.vertex_capacity, self.triangle_capacity)

    def values_in(self, vertices: Floats32) -> tuple[Floats32 | None, Mapping[str, Floats32]]:
        """Return views of texture coordinates and attributes in the rows of a frame."""
        if self._values is None:
            return None, _NO_ATTRIBUTES
        values = vertices[:, GEOMETRY_COLUMNS:]
        uv = values[:, :2] if self._values.has_uv else None
        return uv, {name: values[:, columns] for name, columns in self._values.columns.items()}


_owners: "WeakValueDictionary[int, BaseRefiner]" = WeakValueDictionary()


_NO_ROWS = StreamArrays(
    vertices=np.zeros((0, GEOMETRY_COLUMNS), np.float32),
    triangles=np.zeros((0, 3), np.uint32),
    source=np.zeros(0, np.int32),
)
_NO_ATTRIBUTES: Mapping[str, Floats32] = MappingProxyType({})
