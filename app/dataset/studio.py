"""The studio: takes the picture and the labels of one sample after the other, in one process.

Nothing of one sample is left for the next: the scene is reset, and what is kept (the context, the
heads of some persons) is the same whoever came before. So a sample is the same bytes from any
process, in any order.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import PIL.Image

from risorius import render

from ..files import Image
from ..idle import looking_at
from ..looks import Refinement
from ..motion import SETTLING
from ..passes.passes import Passes
from ..pipeline import Pipeline
from ..scenes import FaceScene
from .cameras import camera_of
from .folder import Writer, name_of
from .labels import labels_of_face
from .request import Request
from .sampling import Sample, draw, gaze_controls

SAMPLES = 8  # of each pixel
MOST_PERSONS = 4  # that are kept, those that came last


@dataclass(frozen=True)
class Shot:
    """A sample as it was taken: what goes into its files."""

    image: Image
    passes: Mapping[str, Any]
    labels: dict[str, Any]


class Studio:
    """A frame without a window, and the heads of some persons before it."""

    def __init__(self, request: Request) -> None:
        self.request = request
        self.surface = render.open_offscreen(request.size, samples=SAMPLES)
        self._renderer = render.Renderer(self.surface)
        self._persons: dict[int, Pipeline] = {}

    def shoot(self, index: int) -> Shot:
        """Take sample number `index` of the request's seed."""
        request = self.request
        sample = draw(request.table, request.seed, index)
        pipeline = self._person(sample.person)
        scene = pipeline.scene
        assert isinstance(scene, FaceScene)
        camera = self._posed(scene, sample)
        self.surface.begin()
        pipeline.draw(camera, sample_style, [(0, 0, *request.size)])
        self.surface.end()
        image = self.surface.read()
        passes = Passes(pipeline).draw(camera, {"depth", *request.passes} - {"landmarks"})
        labels = labels_of_face(scene, camera, request.size, passes["depth"])
        return Shot(image, passes, {**_head(sample), **labels})

    def _posed(self, scene: FaceScene, sample: Sample) -> render.OrbitCamera:
        """Let the face come to rest in its pose; the camera before it."""
        scene.reset()
        scene.pose(sample.controls)
        scene.step(SETTLING)
        camera = camera_of(scene, sample.view)
        if sample.gaze is not None:
            eyes = gaze_controls(sample.gaze)
        else:
            eyes = looking_at(scene, camera.eye)["eyes"]
        scene.pose({**sample.controls, **eyes})
        scene.step(SETTLING)
        return camera
