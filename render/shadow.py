"""Draw the shadow map: the shadow of a mesh and of parts in the key light.

The map holds depths seen from the key light, which moves with the camera. Both sides of the mesh
are drawn, because the mesh is thin, and the mouth behind its lit side must be dark. The map covers
a region that does not depend on moving objects, so shadows do not flicker when the face moves. The
texels are coarse on purpose: the look-up blends 4 x 4 texels, which sets the softness of shadows.
Source: Williams 1978, "Casting curved shadows on curved surfaces". Depth tests are filtered as in
Reeves et al. 1987.
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

MAP_RESOLUTION = (
    288  # texels in width and height; on a head 1.2 mm each, so shadows fade within 5 mm
)
# These lengths are fractions of the scene's radius.
MAP_REACH = 1.15  # half the map's width; a face moves beyond its rest pose
TEXEL_SIZE = 2.0 * MAP_REACH / MAP_RESOLUTION  # size of a texel
LOOKUP_OFFSET = 0.003  # distance of look-ups above the surface, 0.45 mm on a head
STEEP_HEIGHT = 0.999  # y of a light's direction, above which y cannot be the map's up direction


# Matrix for row vectors that maps -1..1 to 0..1 in x, y and z.
_TO_TEXTURE = np.array([[0.5, 0, 0, 0], [0, 0.5, 0, 0], [0, 0, 0.5, 0], [0.5, 0.5, 0.5, 1.0]])


@dataclass(frozen=True, eq=False)
class Shadow:
    """The shadow in one picture.

    depth: depth texture of the first surfaces that the light reaches.
    view_to_light: matrix from view space to the light's clip space, for row vectors, (4, 4).
    radius: radius of the scene.
    """

    depth: moderngl.Texture
    view_to_light: Floats64
    radius: float

    def set_uniforms(self, program: moderngl.Program, unit: int) -> None:
        """Bind the shadow to a program, through a texture unit."""
        write_uniform(program, "shadow_matrix", self.view_to_light @ _TO_TEXTURE)
        program["shadow_offset"] = LOOKUP_OFFSET * self.radius
        program["shadow_reach"] = 2.0 * TEXEL_SIZE * self.radius  # radius of the look-up
        self.depth.use(unit)
        program["shadow_map"] = unit


class ShadowMap:
    """A depth texture, which is drawn again for every frame with shadows."""

    def __init__(self, gl: moderngl.Context) -> None:
        self._gl = gl
        self._program = compile_program(gl, "shadow.glsl")
        self._depth = gl.depth_texture((MAP_RESOLUTION, MAP_RESOLUTION))
        self._depth.compare_func = "<="
        self._depth.repeat_x = self._depth.repeat_y = False
        self._depth.filter = moderngl.LINEAR, moderngl.LINEAR
        self._target = gl.framebuffer(depth_attachment=self._depth)

    def draw(
        self, frame: Frame, view: PlacedView, parts: Sequence[PlacedBuffers], *, with_skin: bool
    ) -> Shadow:
        """Draw the shadow of some parts of a frame, and of its skin if `with_skin` is set."""
        gl = self._gl
        view_to_light = _view_to_light(view, _light_axes(np.array(frame.style.light.to_key)))
        to_light = view.world_to_view @ view_to_light
        self._target.use()
        gl.viewport = (0, 0, MAP_RESOLUTION, MAP_RESOLUTION)
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
    """Return the matrix from view space to the light's clip space; basis: see `_light_axes`."""
    camera = view.camera
    centre = (np.append(camera.scene_centre, 1.0) @ view.world_to_view)[:3]
    matrix = np.eye(4)
    matrix[:3, :3] = basis.T / (MAP_REACH * camera.scene_radius)
    matrix[3, :3] = -centre @ matrix[:3, :3]
    return matrix


def _light_axes(toward: Floats64) -> Floats64:
    """Return the axes of a camera at the light as rows, (3, 3): right, up, away from the light.

    toward: direction to the light, (3,).
    """
    toward = toward / np.linalg.norm(toward)
    above = (0.0, 0.0, 1.0) if abs(toward[1]) > STEEP_HEIGHT else (0.0, 1.0, 0.0)
    right = np.cross(above, toward)
    right /= np.linalg.norm(right)
    return np.stack([right, np.cross(toward, right), -toward])
