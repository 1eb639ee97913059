"""A drawable: a triangle mesh whose vertices move, its images, and further parts.

A drawable has all that drawing needs. A scene (scene.py) also moves the mesh by controls.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from risorius import assets
from risorius.assets.identities import BEARD_NAME
from risorius.geometry.arrays import Floats32, Floats64, Integers32, Unsigned8

from .bent_part import HeadPart
from .face_under_skin import Face
from .openings import Rim


@dataclass(frozen=True, eq=False, kw_only=True)
class SkinImages:
    """The images on a mesh, its texture coordinates, and the fade at its end.

    uv: texture coordinates, (U, 2). face_uv: row of `uv` at each corner, (F, 3).
    albedo: sRGB, (H, W, 3). in_tone: makes the albedo for an individual typology angle [deg].
    ambient_occlusion: factor on the light, (H, W); None: no occlusion.
    oil: strength of highlights, 255 is full, (h, w); None: full everywhere.
    fine_shape: form of the skin beyond its triangles. wrinkles: the furrows of the skin.
    fade: for each vertex, (V, 2): the opacity, 0 to 1 after clamping; and a number below 0 where
        the inner side is invisible. None: the whole mesh is visible.
    """

    uv: Floats32 | None = None
    face_uv: Integers32 | None = None
    albedo: Unsigned8 | None = None
    in_tone: Callable[[float], Unsigned8] | None = None
    ambient_occlusion: Unsigned8 | None = None
    oil: Unsigned8 | None = None
    fine_shape: assets.FineShape | None = None
    wrinkles: assets.Wrinkles | None = None
    fade: Floats32 | None = None


NO_IMAGES = SkinImages()


@dataclass(frozen=True, eq=False)
class Framing:
    """Points that place a camera [mm].

    extent: points around the whole scene, (n, 3). framed: points that fill the picture, (n, 3).
    focus: the point that a near camera looks at, (3,).
    """

    extent: Floats64
    framed: Floats64
    focus: Floats64


class Drawable:
    """A mesh for drawing.

    name: name of the scene, by which looks choose options.
    faces: (F, 3). rest_positions: (V, 3) [mm].
    called: name of the head, or "". face: the simulated face, or None.
    """

    called = ""

    def __init__(
        self,
        name: str,
        faces: Integers32,
        rest_positions: Floats64,
        *,
        skin: SkinImages = NO_IMAGES,
        face: Face | None = None,
    ) -> None:
        self.name = name
        self.faces = faces
        self.rest_positions = rest_positions
        self._positions_now = rest_positions
        self.skin = skin
        self.face = face

    @property
    def positions(self) -> Floats64:
        """The current vertices [mm], shape (V, 3), read only."""
        return self._positions_now

    def place(self, positions: Floats64) -> None:
        """Set the vertices [mm], shape (V, 3)."""
        self._positions_now = positions

    @property
    def parts(self) -> tuple[HeadPart, ...]:
        """The parts that move with bones or the skin, in their current shape: eyes, teeth, ..."""
        return ()

    @property
    def exported_parts(self) -> tuple[HeadPart, ...]:
        """The parts in files: no hairs of beards, which the texture shows, too.

        A thousand hairs that move with the skin would double a file of morph targets.
        """
        return tuple(part for part in self.parts if part.name != BEARD_NAME)

    def rims(self, point_count: int) -> Mapping[str, Rim]:
        """Return the current openings of the skin, by the names in `openings.opening_before`.

        point_count: even number of points of each rim.
        """
        return {}

    def bone_transforms(self) -> Mapping[str, Floats64]:
        """Return the current place of each bone, a matrix (4, 4); rigid parts move with bones."""
        return {}

    def step(self, seconds: float) -> None:
        """Advance in time; here nothing moves."""
