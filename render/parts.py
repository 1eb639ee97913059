"""Coloured parts, moved by bones: uploaded once, or again where one changes its shape."""

import weakref
from collections.abc import Callable, Iterable, Mapping
from typing import Protocol

import moderngl
import numpy as np
import numpy.typing as npt

from risorius.geometry.colour import to_linear

from .camera import CameraView, box_corners
from .translucency import blending

OF_SHELLS = "in_strand", "in_way", "in_dense"
# Striped parts: by the columns of their striation their kind, layout and attributes in OpenGL.
STRIPED = {2: ("FIBRES", " 2f", "in_fibre"), 6: ("SHELLS", " 2f 3f 1f", *OF_SHELLS)}
LAYERS = 9  # of shells; with more a picture takes longer, with fewer one sees between
FEWEST_LAYERS = 2  # shells
LAYER_PIXELS = 10.0  # that a layer is there for, where they are thickest
ROOT = -0.6  # of that way, from vertices
TIP = 0.4  # of that way, from vertices


class Part(Protocol):
    """The attributes that are read of a part.

    name: for messages. vertices, normals: shape (n, 3), float32. A part that is not rigid hands out
        other arrays of the same shape whenever its shape has changed.
    faces: counter-clockwise from the side that is seen, shape (m, 3), int32; the other side is not
        drawn. colours: sRGB 0..1, shape (n, 3), float32.
    bone: whose transform moves it. shine: 0 dull, 1 wet.
    is_enclosed: whether it lies within another surface, where light from behind does not get.
    strand_radius: half the thickness of the strands that it consists of; 0 where it is solid.
    striation: place of each vertex across and along fibres [mm], (n, 2), or None; of shells also
        the way from root to tip [mm], at 0.6 of which vertices lie, and how dense it is, (n, 6).
    """

    @property
    def name(self) -> str: ...
    @property
    def vertices(self) -> npt.NDArray[np.float32]: ...
    @property
    def normals(self) -> npt.NDArray[np.float32]: ...
    @property
    def faces(self) -> npt.NDArray[np.int32]: ...
    @property
    def colours(self) -> npt.NDArray[np.float32]: ...
    @property
    def bone(self) -> str: ...
    @property
    def shine(self) -> float: ...
    @property
    def is_enclosed(self) -> bool: ...
    @property
    def strand_radius(self) -> float: ...
    @property
    def striation(self) -> npt.NDArray[np.float32] | None: ...


class PartBuffers:
    """A part on the graphics card, and the arrays that were read of it.

    It keeps no part alive: `PartStore` gives it up with its part.
    """

    def __init__(self, gl: moderngl.Context, part: Part) -> None:
        self._gl = gl
        self.faces = part.faces
        self.shine = part.shine
        self.is_enclosed = part.is_enclosed
        self.strand_radius = part.strand_radius
        # The program that draws it: a define of surface.glsl, or SHELLS for shells.glsl.
        self.kind, layout, *more = "STRANDS" if part.strand_radius else "RIGID", ""
        columns = 0 if part.striation is None else np.shape(part.striation)[1]
        if columns:
            self.kind, layout, *more = STRIPED[columns]
        self._way = None if part.striation is None or columns < 6 else part.striation[:, 2:5]
        if self._way is not None:
            self._thick = float(np.abs((self._way * part.normals).sum(axis=1)).max())
        self._layout = (f"3f 3f 3f{layout}", "in_position", "in_normal", "in_colour", *more)
        # Blended over earlier drawings by its opacity.
        self.is_mixed = self.kind in ("STRANDS", "SHELLS")
        self._vertices = gl.buffer(reserve=4 * (9 + columns) * len(part.vertices))
        self._uploaded: npt.NDArray[np.float32] | None = None
        self.upload(part)
        self._indices = gl.buffer(np.ascontiguousarray(part.faces, np.uint32).tobytes())
        self._chosen = gl.buffer(reserve=self._indices.size, dynamic=True)
        self._chosen_count = 0
        self._arrays: dict[tuple[moderngl.Program, moderngl.Buffer], moderngl.VertexArray] = {}

    def upload(self, part: Part) -> None:
        """Upload the part's vertices, unless they are those that were uploaded last."""
        vertices = part.vertices
        if vertices is self._uploaded:
            return
        self.corners = box_corners(vertices)
        more = [] if part.striation is None else [part.striation]
        rows = np.hstack([vertices, part.normals, to_linear(part.colours), *more])
        self._vertices.write(rows.astype(np.float32).tobytes())
        self._uploaded = vertices

    def choose(self, is_chosen: npt.NDArray[np.bool_]) -> None:
        """Choose among its faces, (m,), for `draw` of the chosen."""
        chosen = np.ascontiguousarray(np.asarray(self.faces)[is_chosen], np.uint32)
        self._chosen_count = len(chosen)
        self._chosen.orphan()
        if len(chosen):
            self._chosen.write(chosen)

    def sides(self) -> list[npt.NDArray[np.float32]]:
        """Its vertices; of shells those of the innermost and of the outermost."""
        assert self._uploaded is not None
        if self._way is None:
            return [self._uploaded]
        return [self._uploaded + at * self._way for at in (ROOT, TIP)]

    def draw(self, program: moderngl.Program, *, chosen: bool = False, layers: int = 1) -> None:
        """Draw it; the program has in_position, and in_normal and in_colour if it wants them.

        chosen: only the faces that were chosen last. layers: how often, of shells.
        """
        if chosen and not self._chosen_count:
            return
        indices = self._chosen if chosen else self._indices
        if (program, indices) not in self._arrays:
            self._arrays[program, indices] = self._gl.vertex_array(
                program,
                [(self._vertices, *self._layout)],
                index_buffer=indices,
                index_element_size=4,
                skip_errors=True,  # not every program has a use for colours
            )
        count = self._chosen_count if chosen else len(self.faces)
        self._gl.enable(moderngl.CULL_FACE)
        self._arrays[program, indices].render(vertices=3 * count, instances=layers)
        self._gl.disable(moderngl.CULL_FACE)

    def draw_shells(self, program: moderngl.Program, view: CameraView, *, chosen: bool) -> None:
        """Draw its layers from the inside out; the outer ones, which are thin, hide nothing."""
        _, _, width, height = view.viewport
        pixels = view.camera.focal(width / height, height) / view.camera.distance
        layers = int(np.clip(np.ceil(self._thick * pixels / LAYER_PIXELS), FEWEST_LAYERS, LAYERS))
        inner = -(-layers // 2)
        program["layers"] = layers
        for first, count in ((0, inner), (inner, layers - inner)):
            program["first"] = first
            with blending(self._gl, hides=first == 0):
                self.draw(program, chosen=chosen, layers=count)


PlacedPart = tuple[PartBuffers, npt.NDArray[np.float64]]  # and the matrix of its bone


class PartStore:
    """The buffers of the parts that were drawn and still exist.

    A renderer may draw one person after the other: the buffers of a part on the graphics card go
    when the last reference to that part goes.
    """

    def __init__(self, gl: moderngl.Context) -> None:
        self._gl = gl
        # By the id of the part, which another part may have as soon as this one is gone.
        self._known: dict[int, tuple[Callable[[], Part | None], PartBuffers]] = {}

    def placed(
        self, parts: Iterable[Part], transforms: Mapping[str, npt.NDArray[np.float64]]
    ) -> list[PlacedPart]:
        """Each part, uploaded when it is first seen or has changed, with the matrix of its bone.

        Raises ValueError for a bone without one.
        """
        self._forget_lost()
        placed = []
        for part in parts:
            if part.bone not in transforms:
                raise ValueError(
                    f"part '{part.name}' moves with bone '{part.bone}'; transforms has only "
                    f"{', '.join(sorted(transforms)) or 'none'}"
                )
            placed.append((self._buffers_of(part), transforms[part.bone]))
        return placed

    def _buffers_of(self, part: Part) -> PartBuffers:
        """The buffers of a part, which hold its shape as it is now."""
        get_known, buffers = self._known.get(id(part), (None, None))
        if get_known is None or buffers is None or get_known() is not part:
            buffers = PartBuffers(self._gl, part)
            self._known[id(part)] = _reference_to(part), buffers
        buffers.upload(part)
        return buffers

    def _forget_lost(self) -> None:
        """Give up the buffers of parts that nobody holds any more."""
        lost = [key for key, (get_part, _) in self._known.items() if get_part() is None]
        for key in lost:
            del self._known[key]


def _reference_to(part: Part) -> Callable[[], Part | None]:
    """Returns the part while somebody holds it; a part without weak references is kept."""
    try:
        return weakref.ref(part)
    except TypeError:  # a named tuple, say
        return lambda: part
