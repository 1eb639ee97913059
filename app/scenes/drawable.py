"""A drawable: a triangle mesh whose vertices move, images over it, and parts beside it.

Drawing needs no more. What moves the mesh, and by which controls, is a scene's (scene.py).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from risorius import assets
from risorius.geometry.arrays import Floats32, Integers32

from .face_under_skin import Face
from .openings import Rim

Points = npt.NDArray[np.float64]
Pixels = npt.NDArray[np.uint8]


@dataclass(frozen=True, eq=False, kw_only=True)
class SkinImages:
    """The images over a mesh, by its texture coordinates, and where it ends.

    uv: texture coordinates, (U, 2). face_uv: which of them each corner has, (F, 3).
    albedo: sRGB, (H, W, 3). in_tone: albedos by their individual typology angle [deg].
    ambient_occlusion: over the albedo, (H, W); None: light gets everywhere.
    fine_shape: of the skin, which its triangles do not hold. wrinkles: where skin wrinkles.
    fade: of each vertex, (V, 2): the share that shows, 0 to 1, also beyond; and a number below 0
        where the inner side does not show. None: all of it shows.
    """

    uv: Floats32 | None = None
    face_uv: Integers32 | None = None
    albedo: Pixels | None = None
    in_tone: Callable[[float], Pixels] | None = None
    ambient_occlusion: Pixels | None = None
    fine_shape: assets.FineShape | None = None
    wrinkles: assets.Wrinkles | None = None
    fade: Floats32 | None = None


BARE = SkinImages()


@dataclass(frozen=True, eq=False)
class Framing:
    """Points that place a camera [mm].

    extent: points around the whole scene, (n, 3). framed: points that fill the picture, (n, 3).
    focus: the point that a near camera looks at, (3,).
    """

    extent: Points
    framed: Points
    focus: Points


class Drawable:
    """A mesh as drawing sees it.

    name: of the scene, by which looks choose their options.
    faces: (F, 3). rest_positions: (V, 3) [mm].
    called: whose head it is, if it is one. face: what muscles move, if they do.
    """

    called = ""

    def __init__(
        self,
        name: str,
        faces: Integers32,
        rest_positions: Points,
        *,
        skin: SkinImages = BARE,
        face: Face | None = None,
    ) -> None:
        self.name = name
        self.faces = faces
        self.rest_positions = rest_positions
        self._positions_now = rest_positions
        self.skin = skin
        self.face = face

    @property
    def positions(self) -> Points:
        """The vertices now [mm], shape (V, 3); read only for others."""
        return self._positions_now

    def place(self, positions: Points) -> None:
        """Bring the vertices to these places [mm], shape (V, 3)."""
        self._positions_now = positions

    @property
    def parts(self) -> tuple[Any, ...]:
        """The parts that move with bones or the skin, as they are now: eyes, teeth, lashes, ..."""
        return ()

    def rims(self, point_count: int) -> Mapping[str, Rim]:
        """The openings of its skin as they are now, by names of `openings.opening_before`.

        point_count: of each rim, even.
        """
        return {}

    def bone_transforms(self) -> Mapping[str, Points]:
        """Where the rigid parts are now: a (4, 4) matrix for each bone."""
        return {}

    def step(self, seconds: float) -> None:
        """Let time pass; nothing moves by itself."""
