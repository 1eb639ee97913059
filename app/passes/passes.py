"""The passes of a picture: arrays that describe each pixel.

    depth         distance along the camera's axis [mm], 0 = nothing            (H, W) float32
    normal        unit normal, x right, y down, z away from the camera          (H, W, 3) float32
    triangle      index in the simulated mesh, -1 = nothing, an eye, ...       (H, W) int32
    splits        number of splits of that triangle's edges                     (H, W) uint8
    segmentation  class, by the numbers of FaceSynthetics (assets.Segment)      (H, W) uint8

The top row comes first. Where nothing is drawn, `triangle` is -1 and all other passes are 0.
Source of the classes: Wood et al. 2021, "Fake it till you make it".
"""

from __future__ import annotations

from collections.abc import Collection
from typing import Any

import numpy as np
import numpy.typing as npt

from risorius import render
from risorius.assets import Segment
from risorius.assets.identities import GLASSES_NAME, HAIR_NAME, MASK_NAME
from risorius.geometry.arrays import Unsigned8

from ..pipeline import Pipeline, Viewport
from ..refining.drawn_mesh import DrawnMesh

IMAGE_PASSES = ("depth", "normal", "triangle", "splits", "segmentation")
OF_FACES = ("segmentation", "landmarks")  # other scenes lack these
PASS_NAMES = (*IMAGE_PASSES, "landmarks")


class Passes:
    """Draws the passes of a mesh, as it was in the last picture of a pipeline."""

    def __init__(self, pipeline: Pipeline, drawn: DrawnMesh) -> None:
        self.scene = scene = pipeline.scene
        self._pipeline = pipeline
        self.drawn = drawn
        # Thin hairs get the class of the surface behind them, as in pictures labelled by hand.
        self._parts = [part for part in scene.parts if not part.strand_radius]
        self._part_classes = np.concatenate([np.zeros(0, np.uint8), *map(_classes, self._parts)])

    @property
    def size(self) -> tuple[int, int]:
        """Width and height of the passes and of the surface [pixels]."""
        return self._pipeline.renderer.surface.size

    def draw(
        self,
        camera: render.OrbitCamera,
        style: render.Style,
        wanted: Collection[str] = IMAGE_PASSES,
    ) -> dict[str, npt.NDArray[Any]]:
        """Draw the passes of these names, for the last picture of `Pipeline.draw`.

        The camera, the style and the scene must be the same as in that picture. Raises ValueError
        before the first picture, and for the segmentation of a scene that has none.
        """
        drawn = self.drawn
        if drawn.mesh is None:
            raise ValueError("nothing was drawn yet; call Pipeline.draw first")
        frame = self._pipeline.frame_of(camera, style, Viewport(drawn, (0, 0, *self.size)))
        geometry = self._pipeline.renderer.read(frame)
        # Pixels where nothing is drawn have the index -1, and take the last entry.
        parts = len(self._part_classes)
        found: dict[str, npt.NDArray[Any]] = {
            "depth": geometry.depth,
            "normal": geometry.normal,
        }
        if "triangle" in wanted:
            table = np.concatenate([drawn.mesh.source, np.full(parts + 1, -1, np.int32)])
            found["triangle"] = table[geometry.triangle]
        if "splits" in wanted:
            splits = drawn.splits()
            found["splits"] = np.append(splits, np.zeros(parts + 1, np.uint8))[geometry.triangle]
        if "segmentation" in wanted:
            found["segmentation"] = self._segmentation(geometry, drawn.triangle_count)
        return {name: found[name] for name in IMAGE_PASSES if name in wanted}

    def _segmentation(self, geometry: render.Geometry, skin_count: int) -> Unsigned8:
        """Return the classes of pixels: parts by their triangles, skin by a map of its texture."""
        face = self.scene.face
        if face is None:
            raise ValueError(f"the scene {self.scene.name} has no segmentation; a face has one")
        table = np.concatenate([np.zeros(skin_count, np.uint8), self._part_classes, [0]])
        classes: Unsigned8 = table.astype(np.uint8)[geometry.triangle]
        is_skin = (geometry.triangle >= 0) & (geometry.triangle < skin_count)
        map_ = face.head.segments
        size = len(map_)
        columns, rows = (geometry.uv[is_skin] * [size, -size] + [0.0, size]).T.astype(np.int64)
        classes[is_skin] = map_[np.clip(rows, 0, size - 1), np.clip(columns, 0, size - 1)]
        classes[is_skin & geometry.is_inside] = Segment.IGNORE  # seen through the neck
        return classes


def _classes(part: Any) -> Unsigned8:
    """Return the class of each triangle of a part."""
    if part.name.startswith(HAIR_NAME):
        return np.full(len(part.faces), Segment.HAIR, np.uint8)
    if part.name == GLASSES_NAME:
        return np.full(len(part.faces), Segment.GLASSES, np.uint8)
    if part.name == MASK_NAME:
        return np.full(len(part.faces), Segment.FACE_WEAR, np.uint8)
    by_side = {"eye_right": Segment.RIGHT_EYE, "eye_left": Segment.LEFT_EYE}
    if part.bone == "neck":
        return np.full(len(part.faces), Segment.CLOTHING, np.uint8)
    if part.bone in by_side:
        return np.full(len(part.faces), by_side[part.bone], np.uint8)
    if part.name in ("eye_corners", "wet_edges"):
        is_right = part.vertices[part.faces[:, 0], 0] < 0.0
        return np.where(is_right, Segment.RIGHT_EYE, Segment.LEFT_EYE).astype(np.uint8)
    return np.full(len(part.faces), Segment.MOUTH_INTERIOR, np.uint8)
