"""The shadow that the skin throws in the key light: on itself, on eyes, on teeth.

A depth picture of the skin, taken from the key light, which hangs on the camera. Of both sides:
skin is a sheet, and what lies behind its lit side, in the mouth, has to be dark. It spans the whole
scene and depends on nothing that moves, so shadows do not crawl with the face. Its texels are
coarse on purpose: the look-up blends 4 x 4 of them, and that is how soft the shadow is.
Source: Williams 1978, "Casting curved shadows on curved surfaces"; filtering of depth tests as in
Reeves et al. 1987.
"""

import moderngl
import numpy as np
import numpy.typing as npt

from .camera_view import CameraView
from .programs import compile_program, write_uniform
from .stream import Stream

RESOLUTION = 288  # texels each way: 1.2 mm on a head, so its shadows fade within 5 mm
REACH = 1.15  # of the scene's radius: a face moves beyond its rest pose
TEXEL = 2.0 * REACH / RESOLUTION  # of the scene's radius

FloatArray = npt.NDArray[np.float64]

# -1..1 -> 0..1 in x, y and z, for row vectors.
_TO_TEXTURE = np.array([[0.5, 0, 0, 0], [0, 0.5, 0, 0], [0, 0, 0.5, 0], [0.5, 0.5, 0.5, 1.0]])


class ShadowMap:
    """One depth texture, redrawn for every mesh; parts drawn after it use it too."""

    def __init__(self, gl: moderngl.Context, to_key_light: tuple[float, float, float]) -> None:
        self._gl = gl
        self._basis = _basis(np.array(to_key_light))
        self._program = compile_program(gl, "shadow.glsl")
        self._depth = gl.depth_texture((RESOLUTION, RESOLUTION))
        self._depth.compare_func = "<="
        self._depth.repeat_x = self._depth.repeat_y = False
        self._depth.filter = moderngl.LINEAR, moderngl.LINEAR
        self._target = gl.framebuffer(depth_attachment=self._depth)

    def draw(self, stream: Stream, view: CameraView) -> None:
        """Take the depth picture of what `stream` uploaded."""
        gl = self._gl
        write_uniform(self._program, "light_matrix", view.world_to_view @ self._view_to_light(view))
        self._target.use()
        gl.viewport, gl.scissor = (0, 0, RESOLUTION, RESOLUTION), None
        self._target.clear(depth=1.0)
        stream.draw(self._program)

    def bind(self, unit: int) -> int:
        """Bind the depth texture to a texture unit, and return that unit."""
        self._depth.use(unit)
        return unit

    def lookup_matrix(self, view: CameraView) -> FloatArray:
        """View space -> texture coordinates and depth, 0..1, for row vectors, shape (4, 4)."""
        lookup: FloatArray = self._view_to_light(view) @ _TO_TEXTURE
        return lookup

    def _view_to_light(self, view: CameraView) -> FloatArray:
        """View space -> the light's clip space: all that throws and takes shadows fills it."""
        camera = view.camera
        centre = (np.append(camera.scene_centre, 1.0) @ view.world_to_view)[:3]
        matrix = np.eye(4)
        matrix[:3, :3] = self._basis.T / (REACH * camera.scene_radius)
        matrix[3, :3] = -centre @ matrix[:3, :3]
        return matrix


def _basis(toward: FloatArray) -> FloatArray:
    """Rows: right, up, and away from the light, for a camera in the light."""
    toward = toward / np.linalg.norm(toward)
    right = np.cross((0.0, 1.0, 0.0), toward)
    right /= np.linalg.norm(right)
    return np.stack([right, np.cross(toward, right), -toward])
