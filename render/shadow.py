"""The shadow that a mesh and parts throw in the key light, on themselves and on parts.

A depth map, taken from the key light, which hangs on the camera. Of both sides of a mesh: it is
thin, and the mouth behind its lit side has to be dark. It spans the whole
scene and depends on nothing that moves, so shadows do not crawl with the face. Its texels are
coarse on purpose: the look-up blends 4 x 4 of them, and that is how soft the shadow is.
Source: Williams 1978, "Casting curved shadows on curved surfaces"; filtering of depth tests as in
Reeves et al. 1987.
"""

from collections.abc import Sequence

import moderngl
import numpy as np
import numpy.typing as npt

from .camera import CameraView
from .parts import PlacedPart
from .programs import compile_program, write_uniform
from .stream import MeshBuffers
from .style import Vector

RESOLUTION = 288  # texels each way: 1.2 mm on a head, so its shadows fade within 5 mm
MAP_REACH = 1.15  # of the scene's radius: a face moves beyond its rest pose
TEXEL = 2.0 * MAP_REACH / RESOLUTION  # of the scene's radius
OFFSET = 0.003  # of the scene's radius, above the surface: 0.45 mm on a head
STEEP_HEIGHT = 0.999  # of a light's height, from which on it has no direction sideways

Thrower = MeshBuffers | PlacedPart
FloatArray = npt.NDArray[np.float64]

# -1..1 -> 0..1 in x, y and z, for row vectors.
_TO_TEXTURE = np.array([[0.5, 0, 0, 0], [0, 0.5, 0, 0], [0, 0, 0.5, 0], [0.5, 0.5, 0.5, 1.0]])


class ShadowMap:
    """One depth texture, redrawn for every mesh; parts drawn after it use it too."""

    def __init__(self, gl: moderngl.Context) -> None:
        self._gl = gl
        self._basis: FloatArray = np.eye(3)  # of the light that it was last drawn for
        self._program = compile_program(gl, "shadow.glsl")
        self._depth = gl.depth_texture((RESOLUTION, RESOLUTION))
        self._depth.compare_func = "<="
        self._depth.repeat_x = self._depth.repeat_y = False
        self._depth.filter = moderngl.LINEAR, moderngl.LINEAR
        self._target = gl.framebuffer(depth_attachment=self._depth)
        self._drawn_for: tuple[int, CameraView | None] = (0, None)

    def draw(
        self,
        throwers: Sequence[Thrower],
        view: CameraView,
        frame_number: int,
        to_key: Vector,
    ) -> None:
        """Take the depth map of uploaded streams, and of parts, in the frame of that number.

        to_key: unit vector toward the key light, in view space.
        """
        gl = self._gl
        self._basis = _basis(np.array(to_key))
        to_light = view.world_to_view @ self._view_to_light(view)
        write_uniform(self._program, "light_matrix", to_light)
        self._target.use()
        gl.viewport = (0, 0, RESOLUTION, RESOLUTION)
        gl.scissor = None
        self._target.clear(depth=1.0)
        for thrower in throwers:
            transform = np.eye(4) if isinstance(thrower, MeshBuffers) else thrower[1]
            write_uniform(self._program, "light_matrix", transform.T @ to_light)
            (thrower if isinstance(thrower, MeshBuffers) else thrower[0]).draw(self._program)
        self._drawn_for = frame_number, view

    def is_of(self, view: CameraView, frame_number: int) -> bool:
        """Whether it was last drawn for this view, in the frame of that number."""
        return self._drawn_for == (frame_number, view)

    def set_uniforms(self, program: moderngl.Program, view: CameraView, unit: int) -> None:
        """Let a program look up the shadow, through a texture unit."""
        radius = view.camera.scene_radius
        write_uniform(program, "shadow_matrix", self._view_to_light(view) @ _TO_TEXTURE)
        program["shadow_offset"] = OFFSET * radius
        program["shadow_reach"] = 2.0 * TEXEL * radius  # of the look-up, to each side
        self._depth.use(unit)
        program["shadow_map"] = unit

    def _view_to_light(self, view: CameraView) -> FloatArray:
        """View space -> the light's clip space: all that throws and takes shadows fills it."""
        camera = view.camera
        centre = (np.append(camera.scene_centre, 1.0) @ view.world_to_view)[:3]
        matrix = np.eye(4)
        matrix[:3, :3] = self._basis.T / (MAP_REACH * camera.scene_radius)
        matrix[3, :3] = -centre @ matrix[:3, :3]
        return matrix


def _basis(toward: FloatArray) -> FloatArray:
    """Rows: right, up, and away from the light, for a camera in the light."""
    toward = toward / np.linalg.norm(toward)
    above = (0.0, 0.0, 1.0) if abs(toward[1]) > STEEP_HEIGHT else (0.0, 1.0, 0.0)
    right = np.cross(above, toward)
    right /= np.linalg.norm(right)
    return np.stack([right, np.cross(toward, right), -toward])
