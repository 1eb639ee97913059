"""Draw the G-buffer: depth, normal and triangle of the surface in each pixel of a picture.

It uses the vertex buffers and matrices of the colour picture, but one sample at the centre of each
pixel. So no value is a mean of two surfaces. Source: Saito and Takahashi 1990, "Comprehensible
rendering of 3-D shapes".
"""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import moderngl
import numpy as np

from ..geometry.arrays import Flags, Floats32, Integers32
from .camera import PlacedView
from .frame import Frame
from .parts import PlacedBuffers
from .programs import compile_program, write_uniform
from .texture import BumpMap


class Geometry(NamedTuple):
    """The G-buffer of a picture, top row first.

    Empty pixels have -1 in `triangle`, and 0 in all other arrays. Axes are those of a camera in
    computer vision: x right, y down, z away from the camera.
    """

    depth: Floats32
    """Distance along the camera's axis, not along the ray [unit of the scene], (H, W)."""
    normal: Floats32
    """Interpolated unit normals of the visible side, (H, W, 3)."""
    triangle: Integers32
    """Number of the triangle, (H, W); triangles of the skin come first, then those of each part.

    Parts with strands are left out.
    """
    is_inside: Flags
    """Whether a pixel shows the back of a triangle of the skin, (H, W)."""
    uv: Floats32
    """Texture coordinates, (H, W, 2); 0 on parts, and in streams without texture coordinates."""


class GeometryBuffer:
    """The textures of a G-buffer of one size."""

    def __init__(self, gl: moderngl.Context, size: tuple[int, int]) -> None:
        self.size = size
        self._gl = gl
        self._programs: dict[tuple[str, ...], moderngl.Program] = {}  # the keys are defines
        self._textures = [gl.texture(size, components, dtype="f4") for components in (4, 4)]
        self._target = gl.framebuffer(self._textures, gl.depth_renderbuffer(size))

    def draw(self, frame: Frame, parts: Sequence[PlacedBuffers], view: PlacedView) -> Geometry:
        """Draw the G-buffer of a frame's skin and of the given parts; see `Renderer.read`."""
        gl = self._gl
        program = self._program_of({})
        self._target.use()
        gl.enable_only(moderngl.DEPTH_TEST)
        gl.scissor = None
        self._target.clear()
        gl.viewport = view.viewport
        gl.scissor = view.clip
        write_uniform(program, "projection", view.projection)
        first = 1
        if frame.skin is not None:
            skin = self._program_of(frame.skin.shown_maps(frame.style))
            write_uniform(skin, "projection", view.projection)
            write_uniform(skin, "model_view", view.world_to_view)
            skin["first"] = float(first)
            frame.skin.stream.draw(skin)
            first += frame.skin.stream.triangle_count
        for buffers, part, _ in parts:
            write_uniform(program, "model_view", part.transform.T @ view.world_to_view)
            program["first"] = float(first)
            buffers.draw(program)
            first += len(buffers.faces)
        return self._read()

    def _program_of(self, maps: Mapping[BumpMap, float]) -> moderngl.Program:
        """Return the program for a mesh with some maps, and set its uniforms."""
        names = tuple(each.define for each in maps)
        if names not in self._programs:
            self._programs[names] = compile_program(self._gl, "geometry.glsl", *names)
        program = self._programs[names]
        for map_, strength in maps.items():
            map_.set_uniforms(program, strength)
        return program

    def _read(self) -> Geometry:
        """Fetch the textures, top row first."""
        width, height = self.size
        images = []
        for texture in self._textures:
            rows = np.frombuffer(texture.read(), np.float32).reshape(height, width, -1)
            images.append(rows[::-1])  # the first row of a texture is the lowest
        normal_depth, number_side_uv = images
        return Geometry(
            depth=np.ascontiguousarray(normal_depth[..., 3]),
            normal=np.ascontiguousarray(normal_depth[..., :3]),
            triangle=number_side_uv[..., 0].astype(np.int32) - 1,  # exact up to 2^24
            is_inside=number_side_uv[..., 1] < 0.0,
            uv=number_side_uv[..., 2:],
        )
