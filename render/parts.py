"""Rigid coloured parts: uploaded once, moved by bones, and what of them can be seen."""

import functools
from collections.abc import Iterable, Mapping
from typing import Protocol

import moderngl
import numpy as np
import numpy.typing as npt

from .camera_view import CameraView, box_corners
from .occlusion import DepthReader, ProjectedFaces
from .render_target import Rectangle, RenderTarget, bounding_rectangle
from .style import linear


class Part(Protocol):
    """What is read of a rigid part.

    name: for messages. vertices, normals: shape (n, 3), float32.
    faces: counter-clockwise from the side that is seen, shape (m, 3), int32; the other side is not
        drawn. colours: sRGB 0..1, shape (n, 3), float32.
    bone: whose transform moves it. shine: 0 dull, 1 wet.
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
    """A rigid part on the graphics card, uploaded once; keeps the part alive, and so its id."""

    def __init__(self, gl: moderngl.Context, part: Part) -> None:
        self.part = part
        shapes = {np.shape(part.vertices), np.shape(part.normals), np.shape(part.colours)}
        if len(shapes) != 1 or np.shape(part.vertices)[1:] != (3,):
            raise ValueError(
                f"part '{part.name}': vertices {np.shape(part.vertices)}, normals "
                f"{np.shape(part.normals)} and colours {np.shape(part.colours)} must all be (n, 3)"
            )
        self.corners = box_corners(part.vertices)
        rows = np.hstack([part.vertices, part.normals, linear(part.colours)]).astype(np.float32)
        self._gl = gl
        self._vertices = gl.buffer(rows.tobytes())
        self.face_corners = np.ascontiguousarray(part.faces.T, np.intp)
        self._faces = np.ascontiguousarray(part.faces, np.uint32)
        self._indices = gl.buffer(self._faces.tobytes(), dynamic=True)
        self.face_count = len(self._faces)
        self._arrays: dict[moderngl.Program, moderngl.VertexArray] = {}
        self._projection: tuple[object, ProjectedFaces] | None = None

    def projected(self, matrix: npt.NDArray[np.float64], viewport: Rectangle) -> ProjectedFaces:
        """Its faces as the camera sees them, as computed last where part and camera stood still."""
        key = matrix.tobytes(), viewport
        if self._projection is None or self._projection[0] != key:
            faces = ProjectedFaces(self.part.vertices, self.face_corners, matrix, viewport)
            self._projection = key, faces
        return self._projection[1]

    def choose(self, is_visible: npt.NDArray[np.bool_]) -> int:
        """Draw only the faces that are visible, shape (m,), from now on; return their number."""
        visible = self._faces[is_visible]
        self.face_count = len(visible)
        self._indices.orphan()
        self._indices.write(visible)
        return self.face_count

    def draw(self, program: moderngl.Program) -> None:
        """Draw it with a program that has in_position, in_normal and in_colour."""
        if program not in self._arrays:
            self._arrays[program] = self._gl.vertex_array(
                program,
                [(self._vertices, "3f 3f 3f", "in_position", "in_normal", "in_colour")],
                index_buffer=self._indices,
                index_element_size=4,
            )
        self._gl.enable(moderngl.CULL_FACE)
        self._arrays[program].render(moderngl.TRIANGLES, vertices=3 * self.face_count)
        self._gl.disable(moderngl.CULL_FACE)


PlacedPart = tuple[PartBuffers, npt.NDArray[np.float64]]  # and the matrix of its bone


class PartStore:
    """The buffers of all parts that were ever drawn."""

    def __init__(self, gl: moderngl.Context) -> None:
        self._gl = gl
        self.known: dict[int, PartBuffers] = {}
        self._depths: DepthReader | None = None

    def placed(
        self, parts: Iterable[Part], transforms: Mapping[str, npt.NDArray[np.float64]]
    ) -> list[PlacedPart]:
        """Each part, uploaded when it is first seen, with the matrix of its bone.

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
            placed.append((self.known[id(part)], transforms[part.bone]))
        return placed

    def visible(
        self, placed: list[PlacedPart], view: CameraView, target: RenderTarget
    ) -> list[PlacedPart]:
        """Leave out all triangles of the parts that are hidden by what was drawn so far."""
        models = [np.asarray(transform, np.float64).T for _, transform in placed]
        covered = [
            view.covered_pixels(buffers.corners, model=model)
            for (buffers, _), model in zip(placed, models, strict=True)
        ]
        covered = [pixels for pixels in covered if pixels[2] and pixels[3]]
        if not covered:
            return []
        if self._depths is None or self._depths.scene is not target:
            self._depths = DepthReader(self._gl, target)
        self._depths.find_farthest(functools.reduce(bounding_rectangle, covered))
        projected = [
            buffers.projected(model @ view.world_to_clip, view.viewport)
            for (buffers, _), model in zip(placed, models, strict=True)
        ]
        depths = self._depths.read()
        return [
            placed_part
            for placed_part, faces in zip(placed, projected, strict=True)
            if placed_part[0].choose(depths.visible(faces))
        ]
