"""The plug-in border: the protocol of refiners, their input and their output.

Kähler, Haber, Seidel 2003, Fig. 1 and section 3: refinement sits between the deformed mesh and the
rendering engine. It reads the mesh, passes triangles to the engine, and keeps no geometry between
frames. So a refiner is bound once to the connectivity and the undeformed positions of a mesh, and
then turns positions into triangles, frame by frame:

    refiner = refine.create("kahler", faces, rest_positions)
    mesh = refiner.refine(positions)          # draw mesh.positions, mesh.normals, mesh.triangles

New refiners join by name (registry.py).
"""

from abc import abstractmethod
from collections.abc import Mapping
from types import MappingProxyType
from typing import Any, NamedTuple, Protocol, runtime_checkable

import numpy as np
import numpy.typing as npt


class RefinedMesh(NamedTuple):
    """Triangles of one frame: views of buffers that the next frame overwrites.

    A refiner whose output lies elsewhere, for example in buffers of a GPU, returns an object of its
    own class with these members, counts included. That object fetches arrays when they are read.
    """

    positions: npt.NDArray[np.float32]
    """Vertex positions [unit of the input], shape (N, 3)."""
    normals: npt.NDArray[np.float32]
    """Unit vertex normals, zero where the surface has none, shape (N, 3)."""
    triangles: npt.NDArray[np.uint32]
    """Vertices of each triangle, counter-clockwise as in the input, shape (M, 3)."""
    source: npt.NDArray[np.int32]
    """Input triangle that each triangle is part of, shape (M,)."""
    uv: npt.NDArray[np.float32] | None
    """Texture coordinates, shape (N, 2); None if the mesh was bound without."""
    attributes: Mapping[str, npt.NDArray[np.float32]] = MappingProxyType({})
    """The attributes that were bound, by name, shape (N, k)."""

    @property
    def vertex_count(self) -> int:
        """N; a renderer can read this count without fetching arrays."""
        return len(self.positions)

    @property
    def triangle_count(self) -> int:
        """M."""
        return len(self.triangles)

    def __reduce__(self) -> tuple[Any, ...]:
        """Copy and pickle the arrays, to keep a frame or to send it to another process."""
        return RefinedMesh, (*self[:-1], dict(self.attributes))


class View(NamedTuple):
    """The viewpoint of a frame, for criteria that depend on it."""

    eye: npt.ArrayLike
    """Position of the eye [unit of the input], shape (3,)."""


class Origins(NamedTuple):
    """Place of every output vertex on the undeformed input mesh.

    Output vertex n is the mix of input vertices `vertices[n]` with `weights[n]`, before smoothing.
    Mix any other attribute equally: `(colours[o.vertices] * o.weights[..., None]).sum(1)`.
    """

    vertices: npt.NDArray[np.int32]
    """Input vertices, shape (N, 3)."""
    weights: npt.NDArray[np.float32]
    """Their barycentric weights, shape (N, 3), which are not negative and add up to one."""

    @classmethod
    def at(cls, vertices: npt.ArrayLike) -> "Origins":
        """Return the origins of output vertices at the input vertices `vertices`, shape (N,)."""
        corners = np.stack([np.asarray(vertices, dtype=np.int32)] * 3, axis=1)
        weights = np.zeros(corners.shape, dtype=np.float32)
        weights[:, 0] = 1.0
        return cls(corners, weights)

    def followed_by(self, vertices: npt.ArrayLike, weights: npt.ArrayLike) -> "Origins":
        """Return these origins, then the origins of K more output vertices, shape (K, 3) each."""
        return Origins(
            np.concatenate([self.vertices, np.asarray(vertices, dtype=np.int32)]),
            np.concatenate([self.weights, np.asarray(weights, dtype=np.float32)]),
        )


class Stream(Protocol):
    """Arrays lent by the caller, which the refiner fills from the top.

    They must hold `vertex_capacity` vertices and `triangle_capacity` triangles. Each frame may lend
    different arrays. They may be views of mapped memory: of a file, of another process, or of a GPU
    buffer. The built-in refiners also read rows that they wrote in the same frame, so the memory
    should be fast to read.
    """

    @property
    def vertices(self) -> npt.NDArray[np.float32]:
        """Rows `x y z, nx ny nz[, u v][, attributes]`; C-contiguous, shape (.., vertex_columns)."""

    @property
    def triangles(self) -> npt.NDArray[np.uint32]:
        """C-contiguous, shape (.., 3)."""

    @property
    def source(self) -> npt.NDArray[np.int32]:
        """C-contiguous, shape (..,)."""


class GpuStream(Protocol):
    """A stream that lives on the graphics card, for refiners that write there (`refine_gl/`).

    Its moderngl buffers belong to an OpenGL context that must be current when the refiner is
    called. They must hold `vertex_capacity` vertices and `triangle_capacity` triangles. Rows,
    triangles and sources have the layout of the arrays of a `Stream`; their numbers are not read
    back from the card.
    """

    @property
    def context(self) -> Any:
        """The context; a refiner uploads its mesh when it meets a new context."""

    @property
    def vertex_buffer(self) -> Any:
        """Rows, 4 x vertex_columns bytes each."""

    @property
    def index_buffer(self) -> Any:
        """Triangles, 12 bytes each."""

    @property
    def source_buffer(self) -> Any:
        """The input triangle of each triangle, 4 bytes."""

    @property
    def command_buffer(self) -> Any:
        """Seven numbers of 4 bytes: a DrawElementsIndirectCommand (OpenGL 4.0) that draws the frame
        as one instance, then its numbers of vertices and triangles.
        """


@runtime_checkable
class Refiner(Protocol):
    """A refinement method bound to one mesh of V vertices, F triangles and E edges."""

    @property
    def edges(self) -> npt.NDArray[np.int32]:
        """End points of each edge of the input mesh, shape (E, 2), in any order."""

    @property
    def triangle_edges(self) -> npt.NDArray[np.int32]:
        """Edges of each input triangle, from corner i to i + 1, shape (F, 3); -1 for no edge."""

    @property
    @abstractmethod
    def splits(self) -> npt.NDArray[np.uint8]:
        """How often each edge was split in the last frame, shape (E,): s for 2^s sub-edges."""

    @property
    @abstractmethod
    def vertex_capacity(self) -> int:
        """Greatest number of output vertices of a frame."""

    @property
    @abstractmethod
    def triangle_capacity(self) -> int:
        """Greatest number of output triangles of a frame."""

    @property
    def vertex_columns(self) -> int:
        """Columns of a stream's vertices: 6, plus 2 with texture coordinates, plus attributes."""

    def refine(
        self,
        positions: npt.NDArray[np.floating],
        out: Stream | None = None,
        view: View | None = None,
        values: Mapping[str, npt.ArrayLike] | None = None,
    ) -> RefinedMesh:
        """Turn deformed `positions`, shape (V, 3), any float type, into triangles.

        `positions` are never written. The result is a view of the arrays of `out`, or of
        the refiner's own stream if `out` is None. `view`: for criteria that depend on the eye.
        `values`: attributes of this frame by name, which replace bound attributes of the same
        shape, (V, k) for values of vertices. A refiner makes one frame at a time, so each thread
        needs its own refiner. Do not fork a process while one of its threads compiles: numba's lock
        would stay locked in the child. (If a first frame was refined before the fork, nothing is
        left to compile.)
        """

    @abstractmethod
    def origins(self) -> Origins:
        """Return the place on the input mesh of every vertex of the last frame (allocates)."""


class GpuRefiner(Refiner):
    """A refiner that can also write into buffers of the graphics card."""

    @abstractmethod
    def refine_on_card(
        self,
        positions: npt.NDArray[np.floating],
        out: GpuStream,
        view: View | None = None,
        values: Mapping[str, npt.ArrayLike] | None = None,
    ) -> RefinedMesh:
        """Refine into a stream whose context is current; arrays are fetched when they are read."""
