"""The shadow that a mesh and parts throw in the key light, on themselves and on parts.

The shadow is a depth map seen from the key light, which moves with the camera. The map has both
sides of a mesh, because a mesh is thin, and the mouth behind its lit side must be dark. The map
spans the whole scene and does not depend on moving objects, so shadows do not flicker with the
face. Its texels are coarse on purpose: the look-up blends 4 x 4 of them, which sets the softness of
the shadow. Source: Williams 1978, "Casting curved shadows on curved surfaces"; filtering of depth
tests as in Reeves et al. 1987.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import moderngl
import numpy as np

from ..geometry.arrays import Floats64
from .camera import PlacedView
from .frame import Frame
from .parts import PlacedBuffers
from .programs import compile_program, write_uniform

RESOLUTION = 288  # texels each way: 1.2 mm on a head, so its shadows fade within 5 mm
MAP_REACH = 1.15  # of the scene's radius: a face moves beyond its rest pose
TEXEL = 2.0 * MAP_REACH / RESOLUTION  # of the scene's radius
OFFSET = 0.003  # of the scene's radius, above the surface: 0.45 mm on a head
STEEP_HEIGHT = 0.999  # of a light's height: above it there is no sideways direction


# -1..1 -> 0..1 in x, y and z, for row vectors.
_TO_TEXTURE = np.array([[0.5, 0, 0, 0], [0, 0.5, 0, 0], [0, 0, 0.5, 0], [0.5, 0.5, 0.5, 1.0]])


@dataclass(frozen=True, eq=False)
class Shadow:
    """The shadow in one picture.

    depth: the map of the first surfaces that the light reaches. view_to_light: view space -> the
    light's clip space. radius: that of the scene.
    """

    depth: moderngl.Texture
    view_to_light: Floats64
    radius: float

    def set_uniforms(self, program: moderngl.Program, unit: int) -> None:
        """Bind the shadow to a program, through a texture unit."""
        write_uniform(program, "shadow_matrix", self.view_to_light @ _TO_TEXTURE)
        program["shadow_offset"] = OFFSET * self.radius
        program["shadow_reach"] = 2.0 * TEXEL * self.radius  # reach of the look-up to each side
        self.depth.use(unit)
        program["shadow_map"] = unit


class ShadowMap:
    """One depth texture, drawn anew for every frame that has shadows."""

    def __init__(self, gl: moderngl.Context) -> None:
        self._gl = gl
        self._program = compile_program(gl, "shadow.glsl")
        self._depth = gl.depth_texture((RESOLUTION, RESOLUTION))
        self._depth.compare_func = "<="
        self._depth.repeat_x = self._depth.repeat_y = False
        self._depth.filter = moderngl.LINEAR, moderngl.LINEAR
        self._target = gl.framebuffer(depth_attachment=self._depth)

    def draw(
        self, frame: Frame, view: PlacedView, parts: Sequence[PlacedBuffers], *, with_skin: bool
    ) -> Shadow:
        """Draw the shadow of these parts of a frame, and of its skin if the skin throws one."""
        gl = self._gl
        view_to_light = _view_to_light(view, _basis(np.array(frame.style.light.to_key)))
        to_light = view.world_to_view @ view_to_light
        self._target.use()
        gl.viewport = (0, 0, RESOLUTION, RESOLUTION)
        gl.scissor = None
        self._target.clear(depth=1.0)
        if with_skin and frame.skin is not None:
            write_uniform(self._program, "to_clip", to_light)
            frame.skin.stream.draw(self._program)
        for buffers, part, _ in parts:
            write_uniform(self._program, "to_clip", part.transform.T @ to_light)
            buffers.draw_shadow(self._program)
        return Shadow(self._depth, view_to_light, view.camera.scene_radius)


def _view_to_light(view: PlacedView, basis: Floats64) -> Floats64:
    """View space -> the light's clip space, which holds all that throws and takes shadows."""
    camera = view.camera
    centre = (np.append(camera.scene_centre, 1.0) @ view.world_to_view)[:3]
    matrix = np.eye(4)
    matrix[:3, :3] = basis.T / (MAP_REACH * camera.scene_radius)
    matrix[3, :3] = -centre @ matrix[:3, :3]
    return matrix


def _basis(toward: Floats64) -> Floats64:
    """Return the axes of a camera at the light, as rows: right, up, away from the light.

    toward: direction to the light."""
    toward = toward / np.linalg.norm(toward)
    above = (0.0, 0.0, 1.0) if abs(toward[1]) > STEEP_HEIGHT else (0.0, 1.0, 0.0)
    right = np.cross(above, toward)
    right /= np.linalg.norm(right)
    return np.stack([right, np.cross(toward, right), -toward])
