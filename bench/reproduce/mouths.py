"""Opened mouths of the built-in head, coarse and dense: what figures 9 and 10 are made of.

The built-in head with 16 times the triangles is moved by its own muscles, and the coarse one goes
along. Both are drawn from near the lips, with skin, parts inside the mouth and background in
colours of their own; a pixel is wrong where one shows the opening between the lips and the other
does not.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from risorius import assets, refine, render
from risorius.app.capture.cameras import camera_for
from risorius.app.scenes import FaceScene

from ..canvas import Canvas, Drawing
from ..subjects import SETTLE, Points, fine_simulation, settled_positions

Kinds = npt.NDArray[np.uint8]

LEVEL = 2  # of the finer head: 16 times the triangles
SKIN, MOUTH, BACKGROUND = range(3)  # channels of a picture of kinds
BLUE = render.Background((0.0, 0.0, 1.0), (0.0, 0.0, 1.0))
GREEN = np.array([0.0, 1.0, 0.0], np.float32)
KINDS = render.Style(
    shading=render.Shading.FLAT, textured=False, albedo=(1.0, 0.0, 0.0), gloss=0.0, subsurface=0.0,
    shadows=False, background=BLUE,
)  # fmt: skip


@dataclass(frozen=True)
class Variant:
    """One way to refine a mesh, for a row or column of a figure or table."""

    title: str
    refiner: str
    options: Mapping[str, Any] = field(default_factory=dict)
    wants_detail: bool = False  # the finer head at rest is handed to the scheme


class Mouths:
    """The dense head, the coarse one that goes along, and what is in their mouths."""

    def __init__(self, variants: Sequence[Variant]) -> None:
        self._scene, self._head = FaceScene(), assets.load("head")
        fine = self._head.finer(LEVEL)
        self._simulation = fine_simulation(self._head, fine)
        self._rest = fine.vertices, fine.faces
        self.dense = refine.create("none", fine.faces, fine.vertices)
        self.refiners = [self._refiner_of(variant) for variant in variants]
        self._green_parts = tuple(
            replace(part, colours=np.tile(GREEN, (len(part.colours), 1)), shine=0.0)
            for part in self._scene.parts
        )
        self.pose({})

    def _refiner_of(self, variant: Variant) -> refine.Refiner:
        options = dict(variant.options)
        if variant.wants_detail:
            options["detail"] = self._rest
        return refine.create(variant.refiner, self._head.faces, self._head.vertices, **options)

    def pose(self, values: Mapping[str, float]) -> None:
        """Hold controls until nothing moves."""
        self._now: Points = settled_positions(self._simulation, values, SETTLE)
        self._bones = self._simulation.bone_transforms()

    def camera(self, view: str, landmark: int | None = None) -> render.OrbitCamera:
        """A camera that looks at the middle of the lips, or at a landmark, as they are now.

        `view`: yaw, pitch [degrees] and zoom.
        """
        places = self._now[self._head.landmarks[48:68]]
        if landmark is not None:
            places = self._now[self._head.landmarks[[landmark]]]
        camera = camera_for(self._scene, view)
        camera.target = 0.5 * (places.min(axis=0) + places.max(axis=0))
        return camera

    def image(
        self, canvas: Canvas, refiner: refine.Refiner, camera: render.OrbitCamera,
        style: render.Style,
    ) -> npt.NDArray[np.uint8]:  # fmt: skip
        """Draw the head of a refiner as it is now."""
        # The first vertices of the dense mesh are those of the coarse one.
        positions = self._now if refiner is self.dense else self._now[: len(self._head.vertices)]
        parts = self._green_parts if style is KINDS else self._scene.parts
        return canvas.draw_image(
            refiner, positions, Drawing(camera, style, parts=parts, bones=self._bones)
        )

    def kinds(self, canvas: Canvas, refiner: refine.Refiner, camera: render.OrbitCamera) -> Kinds:
        """SKIN, MOUTH or BACKGROUND of every pixel, shape (H, W)."""
        image = self.image(canvas, refiner, camera, KINDS)
        return np.asarray(image.argmax(axis=2), dtype=np.uint8)


def wrong_pixels(kinds: Kinds, truth: Kinds) -> int:
    """How many pixels are the opening of the mouth here, or there, but not in both."""
    return int(((kinds == MOUTH) != (truth == MOUTH)).sum())
