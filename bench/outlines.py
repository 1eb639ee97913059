"""How true the outline of an opened mouth is: pixels that are not as those of a dense head.

The built-in head with 16 times the triangles is moved by its own muscles, and the coarse one goes
along. Both are drawn from near the lips, with skin, parts inside the mouth and background in
colours of their own; a pixel is wrong where one shows the opening between the lips and the other
does not. The criterion `border` was tuned on the poses CHOSEN_BY, and on none of OTHERS.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from risorius import assets, refine, render
from risorius.app.cameras import camera_for
from risorius.app.scenes import FaceScene

from .canvas import Canvas, Drawing
from .report import table
from .subjects import SETTLE, Points, fine_simulation, settled_positions

Kinds = npt.NDArray[np.uint8]

LEVEL = 2  # of the finer head: 16 times the triangles
SKIN, MOUTH, BACKGROUND = range(3)  # channels of a picture of kinds
BLUE = render.Background((0.0, 0.0, 1.0), (0.0, 0.0, 1.0))
GREEN = np.array([0.0, 1.0, 0.0], np.float32)
KINDS = render.Style(
    shading=render.Shading.FLAT, textured=False, albedo=(1.0, 0.0, 0.0), gloss=0.0, subsurface=0.0,
    shadows=False, background=BLUE,
)  # fmt: skip

SIZE = (800, 700)  # [pixels] of a frame, at ZOOM about 13 for a millimetre
ZOOM = 5.4
CHOSEN_BY = ("joy", "surprise", "yawn", "mouth_open", "fear"), ("0,0", "-30,0", "0,-15")
OTHERS = (
    ("disgust", "viseme_aa", "viseme_oh", "viseme_E", "AU10+AU16+AU25", "AU20+AU27", "AU22+AU26"),
    ("18,6", "-45,-8", "8,-25"),
)
"""Poses, and the views that each is looked at from: yaw and pitch [degrees]."""


@dataclass(frozen=True)
class Variant:
    """One way to refine a mesh, for a row or column of a figure or table."""

    title: str
    refiner: str
    options: Mapping[str, Any] = field(default_factory=dict)
    wants_detail: bool = False  # the finer head at rest is handed to the scheme


def _variants() -> list[Variant]:
    """What is compared, beside the mesh as it is."""
    variants = [Variant("static", "none")]
    for scheme, criteria in (
        ("loop", ("normal", "border")),
        ("cubic", ("normal", "border", "normal+border", "bulge", "bulge+border")),
        ("detail", ("bulge", "bulge+border")),
    ):
        for criterion in criteria:
            options = {"scheme": scheme, "criterion": criterion}
            variants.append(
                Variant(f"{scheme}, {criterion}", "kahler", options, scheme == "detail")
            )
    return variants


VARIANTS = tuple(_variants())


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


@dataclass(frozen=True)
class Outline:
    """What one variant makes of some poses, each from some views."""

    title: str
    triangles: float  # mean
    wrong: tuple[int, ...]  # pixels, by pose and view


def measure(
    poses: Sequence[str], views: Sequence[str], *, size: tuple[int, int] = SIZE,
    variants: Sequence[Variant] = VARIANTS, progress: Callable[[str], object] = lambda _: None,
) -> list[Outline]:  # fmt: skip
    """Count wrong pixels of every variant; a pose is one control, or several joined by +."""
    mouths = Mouths(variants)
    wrong: list[list[int]] = [[] for _ in variants]
    triangles: list[list[int]] = [[] for _ in variants]
    with Canvas(size, samples=1) as canvas:
        for pose in poses:
            progress(pose)
            mouths.pose(dict.fromkeys(pose.split("+"), 1.0))
            for view in views:
                camera = mouths.camera(f"{view},{ZOOM}")
                truth = mouths.kinds(canvas, mouths.dense, camera)
                for k, refiner in enumerate(mouths.refiners):
                    kinds = mouths.kinds(canvas, refiner, camera)
                    wrong[k].append(wrong_pixels(kinds, truth))
                    triangles[k].append(canvas.stream_for(refiner).triangle_count)
    return [
        Outline(variant.title, float(np.mean(counts)), tuple(found))
        for variant, counts, found in zip(variants, triangles, wrong, strict=True)
    ]


def report(title: str, outlines: Sequence[Outline]) -> str:
    """The text to print; the first of the outlines is that of the mesh as it is."""
    static = outlines[0].wrong
    rows = [
        (
            one.title,
            one.triangles,
            float(np.mean(one.wrong)),
            100.0 * (1.0 - np.mean(one.wrong) / np.mean(static)),
            sum(count < before for count, before in zip(one.wrong, static, strict=True)),
        )
        for one in outlines
    ]
    columns = "variant:<22|triangles:9.0f|wrong pixels:12.0f|fewer %:7.0f|pictures with fewer:19d"
    return "\n".join([f"{title}: {len(static)} pictures", *table(columns, rows)])
