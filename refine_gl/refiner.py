"""The refiner `kahler-gl`: the paper's, frame by frame on the graphics card.

Kähler, Haber, Seidel 2003, sections 4.1 to 4.4, as `refine.Kahler` does them; frames.py has the
passes. With a stream on the card (`refine.GpuStream`), it writes into that stream, in the caller's
context, and fetches nothing. With arrays, or without a stream, it uses its own context.
"""

import functools
import logging
import operator
from collections.abc import Mapping, Sequence
from typing import Annotated, Literal, Unpack, cast

import numpy as np
import numpy.typing as npt

from risorius.geometry.arrays import Unsigned8
from risorius.refine import (
    THRESHOLD_ONCE,
    THRESHOLD_TWICE,
    BaseRefiner,
    Criterion,
    GpuRefiner,
    GpuStream,
    Kahler,
    NormalDrop,
    Option,
    Origins,
    RefinedMesh,
    Stream,
    Values,
    View,
    create_kahler,
    port,
)

from .context import GpuError, OwnContext, own_context
from .frames import VECTOR_BYTES, Frames, programs_of
from .refined import GpuBuffers, GpuMesh, Run
from .rules import RefinerSettings, Rules
from .tables import tables_of

Threshold = Annotated[
    float, Option("drop of the normals' dot product above which an edge splits", least=0.0)
]
log = logging.getLogger(__name__)


def create_kahler_gl(
    faces: npt.ArrayLike,
    rest_positions: npt.ArrayLike,
    *,
    threshold_once: Threshold = THRESHOLD_ONCE,
    threshold_twice: Threshold = THRESHOLD_TWICE,
    criterion: str | Criterion | Sequence[str | Criterion] = "normal",
    splits: npt.ArrayLike | None = None,
    scheme: Literal["loop", "cubic"] = "loop",
    blend: bool | None = None,
    coherent: bool = False,
    **values: Unpack[Values],
) -> "KahlerGl | Kahler":
    """Bind the paper's refiner to a mesh (`refine.create`), on the card where OpenGL allows it.

    - `threshold_once`, `threshold_twice`: drop of the normals' dot product above which an edge is
      split once or twice, for the paper's criterion, "normal".
    - `criterion`: "normal", "rest", "displacement", or several, such as "normal+rest"; the
      processor measures others, by name or as objects, in every frame.
    - `splits`: 0, 1 or 2 for every edge, shape (E,), in place of a criterion: all frames have the
      same vertices and triangles.
    - `scheme`: "loop", the paper's, with its normals, or "cubic", with normals of its own surface.
    - `blend`: whether points move gradually out of their edges, so that nothing pops. None, the
      default, chooses True for "cubic", unless it is `coherent`, and False for "loop", where True
      is refused.
    - `coherent`: whether triangulations continue those of the frame before (section 4.4).
    - `values`: `uv`, `face_uv`, `attributes` and `crease_angle`, as `refine.create` takes them.
      Cubic edges with creases are refined by the processor.

    If there is no OpenGL 4.3, too little room for the mesh, or a driver that refuses a shader, one
    warning is logged, and the refiner `kahler` with the same options is returned.
    """
    if blend and (coherent or scheme == "loop"):
        raise ValueError('blend=True needs scheme="cubic" in kahler-gl, and coherent=False')
    if blend is None:
        blend = scheme == "cubic" and not coherent
    decides = port.criterion_of(criterion, NormalDrop(threshold_once, threshold_twice), splits)
    settings = RefinerSettings(scheme, decides, blend, bool(coherent))
    if scheme == "cubic" and values.get("crease_angle") is not None:
        warn_once("kahler-gl: cubic edges beside creases are refined by the processor (kahler)")
        return create_kahler(faces, rest_positions, **settings._asdict(), **values)
    try:
        return KahlerGl(faces, rest_positions, own=own_context(), settings=settings, **values)
    except GpuError as error:
        warn_once(f"kahler-gl: {error}; the processor refines instead (kahler)")
    return create_kahler(faces, rest_positions, **settings._asdict(), **values)


@functools.cache
def warn_once(text: str) -> None:
    """Write a warning into the log, only the first time."""
    log.warning(text)


class KahlerGl(BaseRefiner, GpuRefiner):
    """Refinement after Kähler, Haber, Seidel 2003, by compute shaders."""

    def __init__(
        self,
        faces: npt.ArrayLike,
        rest_positions: npt.ArrayLike,
        *,
        own: OwnContext,
        settings: RefinerSettings,
        **values: Unpack[Values],
    ) -> None:
        """Bind to a mesh; see `create_kahler_gl`. `own`: OpenGL for frames whose caller has none.

        Raises GpuError if the driver refuses a shader, or a mesh of this size.
        """
        super().__init__(faces, rest_positions, **values)
        self._claim(settings.criterion, *settings.criterion.parts)
        self.find_normals()
        self._rules = Rules(self.connectivity, self.rest_positions, self.normals, settings)
        none = np.zeros((len(self.rest_positions), 0), np.float32)
        table = none if self._values is None else self._values.values
        self._tables = tables_of(self.connectivity, table, self._rules)
        own.run(programs_of, own.gl, self._tables, self._rules)
        self._own_context = own
        self._own_buffers: GpuBuffers | None = None
        self._frames: Frames | None = None  # those of the last frame's context
        self._run: Run = operator.call
        self._has_new_values = False  # values that the card does not have yet
        self._fetched_splits: Unsigned8 | None = self.edge_splits

    @property
    def vertex_capacity(self) -> int:
        """Greatest number of output vertices: wedges, 3 points per attribute edge, and centres."""
        return self._tables.sizes["most_rows"]

    @property
    def triangle_capacity(self) -> int:
        """Greatest possible number of output triangles, by the longest row of the table."""
        return self._tables.sizes["most_subtriangles"] * len(self.connectivity.faces)

    @property
    def splits(self) -> Unsigned8:
        """How often each edge was split in the last frame, shape (E,), fetched from the card."""
        if self._fetched_splits is None:
            assert self._frames is not None
            numbers = self._run(self._frames.fetch, "splits", len(self.edges))
            self._fetched_splits = numbers.astype(np.uint8)
            self._fetched_splits.flags.writeable = False
        return self._fetched_splits

    @property
    def removals_out_of_order(self) -> int:
        """Splits taken back while a later one stayed, in all frames of this context; fetched."""
        frames = self._frames
        return 0 if frames is None else int(self._run(frames.fetch, "removals", 1)[0])

    def origins(self) -> Origins:
        """Return the place on the input mesh of each vertex of the last frame, from the card."""
        mesh = self.connectivity
        splits = self.splits
        ends = mesh.edges[mesh.attribute_edges]
        points = port.points_on_edges(ends, splits[mesh.attribute_edges])
        origins = super().origins().followed_by(*points)
        if not self._rules.blends or self._frames is None:
            return origins
        counts = np.append(splits, 0)[mesh.triangle_edges].sum(axis=1)
        centres = np.flatnonzero(counts > 1)  # where the fan has a point in the middle
        vectors = self._run(self._frames.fetch, "centres", len(mesh.faces), VECTOR_BYTES)
        weights = vectors.view(np.float32).reshape(-1, 4)[centres, :3]
        return origins.followed_by(mesh.faces[centres], weights)

    def refine(
        self,
        positions: npt.NDArray[np.floating],
        out: Stream | None = None,
        view: View | None = None,
        values: Mapping[str, npt.ArrayLike] | None = None,
    ) -> RefinedMesh:
        """Turn deformed `positions`, shape (V, 3), into triangles; see `Refiner.refine`."""
        if out is not None:
            return super().refine(positions, out, view, values)
        self.take_frame(positions, view, values)
        return cast(RefinedMesh, self._refine_own(view))  # it has all members of a RefinedMesh

    def refine_on_card(
        self,
        positions: npt.NDArray[np.floating],
        out: GpuStream,
        view: View | None = None,
        values: Mapping[str, npt.ArrayLike] | None = None,
    ) -> RefinedMesh:
        """Refine into the buffers of a stream; see `GpuRefiner`."""
        self.take_frame(positions, view, values)
        return cast(RefinedMesh, self._refine_in(out, operator.call, view))

    def follow_values(self) -> None:
        """Note that values have changed; the next frame takes them to the card."""
        super().follow_values()
        self._has_new_values = True

    def fill(self, stream: Stream, view: View | None) -> tuple[int, int]:
        """Refine in a context of our own, and copy the frame into lent arrays."""
        mesh = self._refine_own(view)
        vertex_count = mesh.vertex_count
        triangle_count = mesh.triangle_count
        out = self.reserve(stream, vertex_count, triangle_count)
        out.vertices[:vertex_count] = mesh.vertices
        out.triangles[:triangle_count] = mesh.triangles
        out.source[:triangle_count] = mesh.source
        return vertex_count, triangle_count

    def _refine_own(self, view: View | None) -> GpuMesh:
        own = self._own_context
        own.run(own.gl.gc)  # frees objects without references
        if self._own_buffers is None:
            room = self.vertex_columns, self.vertex_capacity, self.triangle_capacity
            self._own_buffers = own.run(GpuBuffers, own.gl, *room)
        return self._refine_in(self._own_buffers, own.run, view)

    def _refine_in(self, stream: GpuStream, run: Run, view: View | None) -> GpuMesh:
        """Refine into the buffers of a stream; a new context gets the mesh first."""
        if self._frames is None or self._frames.gl is not stream.context:
            self._frames = run(
                Frames, stream.context, self._tables, self._rules, self.rest_positions
            )
            self._has_new_values = self._values is not None
        self._run = run
        if self._has_new_values:
            assert self._values is not None
            ends = self._values.values[self.connectivity.attribute_edge_uv]
            run(self._frames.write_values, self._wedge_values, ends)
            self._has_new_values = False
        self._fetched_splits = None
        measured = None  # metric from the processor
        if self._rules.others is not None:
            self.find_normals()
            measured = self._rules.measure_others(self.positions, self.normals, view)
        run(self._frames.run, self.positions, measured, stream)
        return GpuMesh(stream, run, self.vertex_columns, self.values_in)
