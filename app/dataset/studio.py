"""Draw the pictures, and compute the labels, of samples in one process.

No state passes from one sample to the next: the scene is reset, and reused objects (the OpenGL
context, the heads of some persons) do not depend on earlier samples. So a sample has the same
bytes in any process, and in any order.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
import PIL.Image

from risorius import render
from risorius.assets import Segment
from risorius.assets.identities import (
    colours_of_number,
    in_colours,
    make_person,
    sample_identity,
    wearing,
)

from ..control_names.angles import GAZE_ANGLE
from ..motion.life import looking_at
from ..passes.camera import CameraLabels
from ..passes.labels import Labelled
from ..passes.passes import Passes
from ..pictures import Image
from ..pipeline import Pipeline, Viewport
from ..refining.presets import Refinement
from ..scenes import FaceScene
from .degrading import degraded
from .folder import name_of
from .labels import labels_of_face
from .request import SetRequest
from .sampling import Sample, SampleCamera, chosen, draw
from .surroundings import laid_over, light_of
from .table import NOTHING_WORN

SHOT_SETTLING = 0.5  # [s] until skin is within 0.001 mm of its place; films take longer


@dataclass(frozen=True)
class Shot:
    """The picture of a sample (H, W, 3), and its labels and passes."""

    image: Image
    known: Labelled

    def save(self, picture: Path) -> None:
        """Write the picture to a path, and the other files beside it; may raise OSError."""
        # zlib's level 4 takes a third of the time of the default 6, and 6 % more bytes.
        PIL.Image.fromarray(self.image).save(picture, compress_level=4)
        self.known.save(picture)


@dataclass(frozen=True)
class _Model:
    """The scene of a person, with the objects that draw and label it."""

    scene: FaceScene
    pipeline: Pipeline
    passes: Passes
    labels: dict[str, Any]


class Studio:
    """Draws samples on an offscreen surface; it keeps the heads of the last four persons."""

    def __init__(self, request: SetRequest) -> None:
        self._request = request
        self._surface = render.open_offscreen(request.size, samples=8)
        self._renderer = render.Renderer(self._surface)
        self._person = lru_cache(4)(self._person_of)

    def shoot(self, index: int) -> Shot:
        """Draw sample number `index` of the request's seed, and label it."""
        request = self._request
        sample = draw(request.table, request.seed, index)
        model = self._person(sample.person)
        scene = model.scene
        camera = _posed(scene, sample, request.size)
        image, surroundings = self._picture(model, camera, sample)
        style = render.Style()  # light and background do not matter for passes
        is_masked = model.labels["mask"] != NOTHING_WORN
        needed = {"depth", "segmentation"} if is_masked else {"depth"}
        images = model.passes.draw(camera, style, {*needed, *request.passes})
        covered = images["segmentation"] == Segment.FACE_WEAR if is_masked else None
        labels = {
            "id": name_of(index),
            "index": index,
            "seed": sample.seed,
            "risorius": request.version,
            "kind": sample.kind,
            "name": sample.name,
            "person": model.labels,
            **surroundings,
            **labels_of_face(scene, camera, request.size, images["depth"], covered),
        }
        if request.degrade:
            image = degraded(image, sample.degradation)
            labels["degradation"] = asdict(sample.degradation)
        wanted = {name: images[name] for name in images if name in request.passes}
        return Shot(image, Labelled(wanted, labels))

    def _picture(
        self, model: _Model, camera: render.OrbitCamera, sample: Sample
    ) -> tuple[Image, dict[str, Any]]:
        """Draw the current scene; return the picture, and the labels of light and background."""
        request = self._request
        random = np.random.default_rng(sample.surroundings)
        lit = light_of(sample.light, request.lights, random)
        picture = None
        behind: render.Background | render.MapBackground | None = None
        label: Any = lit.name
        if request.backgrounds.pictures:
            label, picture = request.backgrounds.picture(random, request.size)
        elif lit.map is not None and request.backgrounds.colour is None:
            behind = lit.map.background(lit.turn, lit.exposure)
        else:
            behind = request.backgrounds.colours(random)
            label = asdict(behind)
        style = render.Style(light=lit.light, background=behind)
        model.pipeline.draw(camera, style, [Viewport(model.passes.drawn, (0, 0, *request.size))])
        if picture is None:
            image = self._surface.read()
        else:
            image = laid_over(picture, self._surface.read_scene(4))
        return image, {"light": lit.labels, "background": label}

    def _person_of(self, number: int) -> _Model:
        """Build person `number` of the table's population."""
        population = self._request.table.population
        person = make_person(sample_identity(number, population=population))
        colours = colours_of_number(person.identity, number, population=population)
        random = np.random.default_rng([number, 19])  # 18 is the stream of colours
        shirt = chosen(random, self._request.table.shirts)
        glasses = chosen(random, self._request.table.glasses)
        mask = chosen(random, self._request.table.masks)
        collar = chosen(random, self._request.table.collars)
        labels = {
            "number": number,
            "tone": round(colours.angle, 2),
            "irises": colours.irises,
            "sex": person.identity.sex.value,
            "age": round(person.identity.age, 1),
            "hair": person.identity.cut,
            "beard": round(colours.features.beard_length, 1),
            "shirt": shirt,
            "collar": collar,
            "glasses": glasses,
            "mask": mask,
            "measures": {code: round(value, 3) for code, value in person.measures.items()},
        }
        head = in_colours(person, colours, shrink=_shrink_for(self._request.size))
        frame = None if glasses == NOTHING_WORN else glasses
        cover = None if mask == NOTHING_WORN else mask
        worn = wearing(head, shirt=shirt, collar=collar, frame=frame, cover=cover)
        scene = FaceScene(worn)
        pipeline = Pipeline(scene, self._renderer)
        drawn = pipeline.bind(Refinement(refiner=self._request.refiner))
        return _Model(scene, pipeline, Passes(pipeline, drawn), labels)


def _shrink_for(size: tuple[int, int]) -> int:
    """Return the factor by which skin textures shrink for pictures of a size [pixels].

    At zoom 1, the height of the picture shows two thirds of the texture's height.
    """
    texels = 1280
    shrink = 1
    while shrink < 8 and texels // (2 * shrink) >= 2 * max(size):
        shrink *= 2
    return shrink


def _posed(scene: FaceScene, sample: Sample, size: tuple[int, int]) -> render.OrbitCamera:
    """Move a face into its pose, place the camera, and turn the eyes; return the camera."""
    scene.reset()
    scene.pose(sample.controls)
    scene.step(SHOT_SETTLING)
    camera = _camera_of(scene, sample.view, size)
    if sample.gaze is None:
        eyes = looking_at(scene.face, camera.eye)["eyes"]
    else:
        aside, up = (round(degrees / GAZE_ANGLE, 4) for degrees in sample.gaze)
        eyes = {"gaze_horizontal": aside, "gaze_vertical": up}
    scene.pose({**sample.controls, **eyes})
    scene.step(SHOT_SETTLING)
    return camera


def _camera_of(scene: FaceScene, view: SampleCamera, size: tuple[int, int]) -> render.OrbitCamera:
    """Return a camera that centres the current head of a scene, and then shift it.

    If landmarks would lie outside the picture of `size` pixels, the camera moves again.
    """
    rest = scene.rest_positions
    chin = 8  # a landmark
    below_chin = 12.0  # [mm] of the neck below the chin that belong to the framed head
    head = rest[:, 1] > rest[scene.landmarks[chin], 1] - below_chin
    camera = render.OrbitCamera.framing(
        np.vstack([scene.positions, rest]), view="front", field_of_view=view.field_of_view
    )
    camera.orbit(view.yaw, view.pitch)
    margin = 0.03  # fraction of the picture that is free on each side at zoom 1
    camera.fit(scene.positions[head], margin)
    camera.zoom(view.zoom)
    camera.pan(*view.shift)
    for _ in range(3):  # perspective makes one round inexact
        pixels = CameraLabels.from_camera(camera, size).project(scene.positions[scene.landmarks])
        fractions = pixels / size[1]
        end = np.array([size[0] / size[1], 1.0]) - margin
        right, down = np.maximum(fractions.max(axis=0) - end, 0.0) - np.maximum(
            margin - fractions.min(axis=0), 0.0
        )
        camera.pan(float(right), -float(down))
    return camera
