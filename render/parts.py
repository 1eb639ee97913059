"""Keep the buffers of coloured parts: upload a part first, and again after each change of shape."""

import weakref
from collections.abc import Callable, Iterable
from typing import NamedTuple, Self

import moderngl
import numpy as np

from ..geometry.arrays import Floats32, Floats64, Integers32
from ..geometry.colour import to_linear
from ..geometry.directions import unit_vectors
from ..geometry.normals import cross_products
from ..geometry.sides import edges_of
from ..geometry.transforms import moved_points
from .camera import PlacedView, box_corners
from .frame import DrawnPart, PlacedPart
from .translucency import blending

SHELL_ATTRIBUTES = "in_strand", "in_way", "in_dense", "in_fray"
# Number of columns of a part's striation -> kind of part, layout and attributes of its vertices.
STRIATION_LAYOUTS = {
    2: ("FIBRES", " 2f", "in_fibre"),
    5: ("LOCKS", " 3f 1f 1f", "in_along", "in_half", "in_opacity"),
    7: ("SHELLS", " 2f 3f 1f 1f", *SHELL_ATTRIBUTES),
}
MOST_LAYERS = 9  # greatest number of shells; more take longer, fewer show gaps
FEWEST_LAYERS = 2  # smallest number of shells
LAYER_PIXELS = 10.0  # [pixels] between two layers, where shells are thickest
SHADING_DENSITY = 0.6  # density of shells from which they throw a shadow
# Density of shells from which the lowest layer is opaque from any side. At this density even the
# most ragged strand of shells.glsl has the density 1.
HIDING_DENSITY = 1.2
LEAST_RISE = 0.5  # cosine between strands and the normal, from which they hide the surface below


class PartBuffers:
    """The buffers of a part on the graphics card.

    They hold no reference to the part, so that `PartStore` can release them with the part.

    kind: "RIGID", "STRANDS", "FIBRES", "LOCKS" or "SHELLS".
    is_mixed: whether the part is blended over earlier drawings.
    """

    def __init__(self, gl: moderngl.Context, part: DrawnPart) -> None:
        """Reserve buffers for the part; `upload` fills them."""
        self._gl = gl
        self.faces = part.faces
        self.shine = part.shine
        self.is_enclosed = part.is_enclosed
        self.strand_radius = part.strand_radius
        # A define of surface.glsl; SHELLS and LOCKS have programs of their own.
        self.kind, layout, *more = "STRANDS" if part.strand_radius else "RIGID", ""
        columns = 0 if part.striation is None else np.shape(part.striation)[1]
        if columns:
            self.kind, layout, *more = STRIATION_LAYOUTS[columns]
        self._way = None if part.striation is None or columns < 6 else part.striation[:, 2:5]
        if self._way is not None:
            self._thick = float(np.abs((self._way * part.normals).sum(axis=1)).max())
        self._layout = (f"3f 3f 3f{layout}", "in_position", "in_normal", "in_colour", *more)
        self._breadth = np.ones((1, 1), np.float32)
        if self.kind == "STRANDS":
            self._breadth = _strand_breadths(part.faces, len(part.vertices))
        self.is_mixed = self.kind in ("STRANDS", "LOCKS", "SHELLS")
        self._vertices = gl.buffer(reserve=4 * (9 + columns) * len(part.vertices))
        self._rows = np.empty((len(part.vertices), 9 + columns), np.float32)
        if part.striation is not None:
            self._rows[:, 9:] = part.striation
        self._uploaded: Floats32 | None = None
        self._colours: Floats32 | None = None
        self._indices = gl.buffer(np.ascontiguousarray(part.faces, np.uint32).tobytes())
        self._throwing = self._indices, len(part.faces)
        self._hiding = self._indices, 0
        if self._way is not None and part.striation is not None:
            least = part.striation[:, 5][part.faces].min(axis=1)
            # Uneven edges of loose hair would throw a shadow with steps.
            shading = part.striation[:, 5] + np.maximum(-part.striation[:, 6], 0.0)
            is_throwing = shading[part.faces].min(axis=1) > SHADING_DENSITY
            self._throwing = _index_buffer(gl, part.faces[is_throwing])
            # The inner side of hanging hair and flat hair do not hide the surface below.
            outward = unit_vectors(cross_products(part.vertices, part.faces))[:, None]
            rise = (unit_vectors(self._way)[part.faces] * outward).sum(axis=2).min(axis=1)
            is_hiding = (least >= HIDING_DENSITY) & (rise > LEAST_RISE)
            self._hiding = _index_buffer(gl, part.faces[is_hiding])
        self._arrays: dict[tuple[moderngl.Program, moderngl.Buffer], moderngl.VertexArray] = {}

    def upload(self, placed: PlacedPart) -> None:
        """Upload the vertices of the part, unless the same arrays have been uploaded before."""
        vertices = placed.vertices
        if vertices is self._uploaded:
            return
        self.corners = box_corners(vertices)
        self._rows[:, :3] = vertices
        self._rows[:, 3:6] = placed.normals * self._breadth
        if placed.colours is not self._colours:
            self._rows[:, 6:9] = to_linear(placed.colours)
            self._colours = placed.colours
        self._vertices.write(self._rows)
        self._uploaded = vertices

    def draw(self, program: moderngl.Program, *, layers: int = 1) -> None:
        """Draw the part by a program with in_position, and optionally in_normal and in_colour.

        layers: number of layers of shells.
        """
        self._render(program, self._indices, len(self.faces), layers)

    def draw_shadow(self, program: moderngl.Program) -> None:
        """Draw the faces that throw a shadow; thin shells at a hem throw none."""
        self._render(program, *self._throwing, 1)

    def draw_hiding(self, program: moderngl.Program, view: PlacedView) -> None:
        """Draw the shells that are dense enough to hide the surface below."""
        program["layers"] = self.layer_count(view)
        self._render(program, *self._hiding, 1)

    def _render(
        self, program: moderngl.Program, indices: moderngl.Buffer, count: int, layers: int
    ) -> None:
        """Draw the front faces among the first `count` triangles of an index buffer."""
        if not count:
            return
        if (program, indices) not in self._arrays:
            self._arrays[program, indices] = self._gl.vertex_array(
                program,
                [(self._vertices, *self._layout)],
                index_buffer=indices,
                index_element_size=4,
                skip_errors=True,  # not every program uses colours
            )
        self._gl.enable(moderngl.CULL_FACE)
        self._arrays[program, indices].render(vertices=3 * count, instances=layers)
        self._gl.disable(moderngl.CULL_FACE)

    def layer_count(self, view: PlacedView) -> int:
        """Return the number of layers of the part's shells in a view."""
        _, _, width, height = view.viewport
        pixels = view.camera.focal(width / height, height) / view.camera.distance
        return int(
            np.clip(np.ceil(self._thick * pixels / LAYER_PIXELS), FEWEST_LAYERS, MOST_LAYERS)
        )

    def draw_shells(self, program: moderngl.Program, view: PlacedView) -> None:
        """Draw the layers from the inside out; the thin outer layers do not write depths."""
        layers = self.layer_count(view)
        inner = -(-layers // 2)
        program["layers"] = layers
        for first, count in ((0, inner), (inner, layers - inner)):
            program["first"] = first
            with blending(self._gl, hides=first == 0):
                self.draw(program, layers=count)


def _index_buffer(gl: moderngl.Context, faces: Integers32) -> tuple[moderngl.Buffer, int]:
    """Return an index buffer of faces (m, 3), and the number of faces."""
    indices = np.ascontiguousarray(faces, np.uint32)
    return gl.buffer(indices.tobytes() or bytes(12)), len(indices)


def _strand_breadths(faces: Integers32, vertex_count: int) -> Floats32:
    """Return relative widths of three-sided strands at vertices, (n, 1): 0 at tips, else 1.

    At a tip three triangles and three edges meet; at an open end four edges meet.
    """
    edge_counts = np.bincount(edges_of(faces).ravel(), minlength=vertex_count)
    face_counts = np.bincount(faces.ravel(), minlength=vertex_count)
    is_tip = (edge_counts == 3) & (face_counts == 3)
    return np.where(is_tip, 0.0, 1.0)[:, None].astype(np.float32)


class PlacedBuffers(NamedTuple):
    """A placed part with its buffers.

    number: number of the surface, see surface_number.glsl.
    """

    buffers: PartBuffers
    part: PlacedPart
    number: int

    def as_background(self) -> Self:
        """Return the part with the number of the background: its edges are smooth already."""
        return self._replace(number=0)

    @property
    def corners(self) -> Floats64:
        """Return the corners of the part's bounding box in the world, (8, 3)."""
        return moved_points(self.part.transform, self.buffers.corners)


class PartStore:
    """The buffers of all drawn parts that still exist.

    A renderer may draw one person after another, so the buffers of a part are released when the
    last reference to the part is gone.
    """

    def __init__(self, gl: moderngl.Context) -> None:
        self._gl = gl
        # The keys are ids of parts; Python may reuse an id when its part no longer exists.
        self._known: dict[int, tuple[Callable[[], DrawnPart | None], PartBuffers]] = {}

    def uploaded(self, parts: Iterable[PlacedPart]) -> list[PlacedBuffers]:
        """Return the buffers of each part; upload new parts, and parts with a changed shape."""
        self._forget_lost()
        return [
            PlacedBuffers(self._buffers_of(each), each, 2 + index % 187)
            for index, each in enumerate(parts)
        ]

    def _buffers_of(self, placed: PlacedPart) -> PartBuffers:
        """Return the buffers of a part, uploaded with its current shape."""
        part = placed.part
        get_known, buffers = self._known.get(id(part), (None, None))
        if get_known is None or buffers is None or get_known() is not part:
            buffers = PartBuffers(self._gl, part)
            self._known[id(part)] = _reference_to(part), buffers
        buffers.upload(placed)
        return buffers

    def _forget_lost(self) -> None:
        """Release the buffers of parts that no longer exist."""
        lost = [key for key, (get_part, _) in self._known.items() if get_part() is None]
        for key in lost:
            del self._known[key]


def _reference_to(part: DrawnPart) -> Callable[[], DrawnPart | None]:
    """Return a function that returns the part while it exists.

    If the part's class has no weak references, the function keeps the part alive.
    """
    try:
        return weakref.ref(part)
    except TypeError:  # for example a named tuple
        return lambda: part
