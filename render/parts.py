"""Coloured parts, moved by bones: uploaded once, or again where one changes its shape."""

from collections.abc import Iterable, Mapping
from typing import Protocol

import moderngl
import numpy as np
import numpy.typing as npt

from risorius.geometry.colour import to_linear

from .camera_view import CameraView, box_corners
from .outline import fringes

# What is striped: by which attribute of a part, and its kind, layout and attributes in OpenGL.
STRIPED = {
    "fibres": ("FIBRES", "2f", "in_fibre"),
    "strands": ("LOCKS", "2f 3f", "in_strand", "in_along"),
}


class Part(Protocol):
    """What is read of a part.

    name: for messages. vertices, normals: shape (n, 3), float32. A part that is not rigid hands out
        other arrays of the same shape whenever its shape has changed.
    faces: counter-clockwise from the side that is seen, shape (m, 3), int32; the other side is not
        drawn. colours: sRGB 0..1, shape (n, 3), float32.
    bone: whose transform moves it. shine: 0 dull, 1 wet. Hairs have `hair`, half their thickness,
        too; muscles `fibres`, the place of each vertex across and along them [mm], (n, 2); locks of
        hair `strands`: the same, and a unit vector along them, (n, 5).
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


class PartBuffers:
    """A part on the graphics card; keeps the part alive, and so its id."""

    def __init__(self, gl: moderngl.Context, part: Part) -> None:
        self.part = part
        shapes = {np.shape(part.vertices), np.shape(part.normals), np.shape(part.colours)}
        if len(shapes) != 1 or np.shape(part.vertices)[1:] != (3,):
            raise ValueError(
                f"part '{part.name}': vertices {np.shape(part.vertices)}, normals "
                f"{np.shape(part.normals)} and colours {np.shape(part.colours)} must all be (n, 3)"
            )
        self._gl = gl
        self.hair = getattr(part, "hair", 0.0)
        # What it is drawn with: a define of surface.glsl, or LOCKS for locks.glsl.
        self.kind = "HAIR" if self.hair else "RIGID"
        self._more: npt.NDArray[np.float32] | None = None  # attributes that others have not
        self._layout: tuple[str, ...] = ("3f 3f 3f", "in_position", "in_normal", "in_colour")
        for name, (kind, layout, *attributes) in STRIPED.items():
            if (more := getattr(part, name, None)) is not None:
                self.kind, self._more = kind, more
                self._layout = (f"{self._layout[0]} {layout}", *self._layout[1:], *attributes)
        # What stands out of the head has an outline of its own; the rest is seen before skin.
        self.is_outlined = self.kind == "RIGID" and part.bone == "neck"
        columns = 9 if self._more is None else 9 + np.shape(self._more)[1]
        self._vertices = gl.buffer(reserve=4 * columns * len(part.vertices))
        self._uploaded: npt.NDArray[np.float32] | None = None
        self.upload()
        self._indices = gl.buffer(np.ascontiguousarray(part.faces, np.uint32).tobytes())
        self._chosen = gl.buffer(reserve=self._indices.size, dynamic=True)
        self._chosen_count = 0
        self._arrays: dict[tuple[moderngl.Program, moderngl.Buffer], moderngl.VertexArray] = {}

    def upload(self) -> None:
        """Upload the part's vertices, unless they are those that were uploaded last."""
        part, vertices = self.part, self.part.vertices
        if vertices is self._uploaded:
            return
        self.corners = box_corners(vertices)
        rows = np.hstack(
            [
                vertices,
                part.normals,
                to_linear(part.colours),
                *([] if self._more is None else [self._more]),
            ]
        ).astype(np.float32)
        self._vertices.write(rows.tobytes())
        self._rows = rows if self.is_outlined else rows[:0]
        self._uploaded = vertices

    def fringes(self, view: CameraView, bone: npt.NDArray[np.float64]) -> npt.NDArray[np.float32]:
        """Of its outline, see outline.py."""
        return fringes(self._rows, self.part.faces, view, bone)

    def choose(self, is_chosen: npt.NDArray[np.bool_]) -> None:
        """Choose among its faces, (m,), for `draw` of the chosen."""
        chosen = np.ascontiguousarray(np.asarray(self.part.faces)[is_chosen], np.uint32)
        self._chosen_count = len(chosen)
        self._chosen.orphan()
        if len(chosen):
            self._chosen.write(chosen)

    def draw(self, program: moderngl.Program, *, chosen: bool = False) -> None:
        """Draw it; the program has in_position, and in_normal and in_colour if it wants them.

        chosen: only the faces that were chosen last.
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
        count = self._chosen_count if chosen else len(self.part.faces)
        self._gl.enable(moderngl.CULL_FACE)
        self._arrays[program, indices].render(moderngl.TRIANGLES, vertices=3 * count)
        self._gl.disable(moderngl.CULL_FACE)


PlacedPart = tuple[PartBuffers, npt.NDArray[np.float64]]  # and the matrix of its bone


class PartStore:
    """The buffers of all parts that were ever drawn."""

    def __init__(self, gl: moderngl.Context) -> None:
        self._gl = gl
        self.known: dict[int, PartBuffers] = {}

    def placed(
        self, parts: Iterable[Part], transforms: Mapping[str, npt.NDArray[np.float64]]
    ) -> list[PlacedPart]:
        """Each part, uploaded when it is first seen or has changed, with the matrix of its bone.

        Raises ValueError for a bone without one.
        """
        placed = []
        for part in parts:
            if id(part) not in self.known:
                self.known[id(part)] = PartBuffers(self._gl, part)
            if part.bone not in transforms:
                raise ValueError(
                    f"part '{part.name}' moves with bone '{part.bone}'; transforms has only "
                    f"{', '.join(sorted(transforms)) or 'none'}"
                )
            self.known[id(part)].upload()
            placed.append((self.known[id(part)], transforms[part.bone]))
        return placed
