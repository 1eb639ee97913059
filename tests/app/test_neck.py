"""The end of a head's neck: only this end fades, wherever jaw and head move."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import PIL.Image
import PIL.ImageDraw
import pytest

from risorius import assets, render
from risorius.app.passes.camera import CameraLabels
from risorius.app.pipeline import Pipeline, Viewport
from risorius.app.refining.presets import Refinement
from risorius.app.scenes import FaceScene
from risorius.assets.fitting import fit
from risorius.assets.meshes import Mesh

SIZE = (240, 240)
STYLE = render.Style(background=render.WHITE, shadows=False)
POSES = (
    {"jaw_open": 1.0},
    {"jaw_open": 1.0, "head_pitch": -1.0, "head_yaw": 0.6},
    {"jaw_open": 1.0, "head_yaw": 1.0, "head_roll": 0.7},
)


@pytest.fixture(scope="module")
def renderer() -> Iterator[render.Renderer]:
    """A renderer of small pictures."""
    with render.open_offscreen(SIZE, samples=1) as surface:
        yield render.Renderer(surface)


@pytest.fixture(scope="module")
def short_necked() -> FaceScene:
    """The built-in head with a quarter of its neck, cut off without a shirt, as a user's head."""
    return with_short_neck(forward=0.0)


def with_short_neck(forward: float) -> FaceScene:
    """A scene of such a head; below the chin its neck is moved forward by this distance [mm]."""
    head = assets.load("head")
    vertices = head.vertices.copy()
    below = np.minimum(vertices[:, 1] - vertices[head.landmarks[8], 1], 0.0)
    vertices[:, 1] -= 0.75 * below
    vertices[:, 2] += np.where(below < -40.0, forward, 0.0)
    return FaceScene(fit(Mesh(vertices, head.faces), head.landmarks))


class Sitter:
    """A scene before a camera, drawn with one refiner."""

    def __init__(self, scene, renderer, refiner):
        self.pipeline = Pipeline(scene, renderer)
        self.drawn = self.pipeline.bind(Refinement(refiner=refiner))
        self.viewport = Viewport(self.drawn, (0, 0, *SIZE))

    def picture(self, camera):
        """The picture, (H, W, 3)."""
        self.pipeline.draw(camera, STYLE, [self.viewport])
        return self.pipeline.renderer.surface.read().astype(int)

    def whole_skin(self, camera):
        """The scene's triangle at each pixel, if its outer side is visible and it never fades.

        -1 at all other pixels; shape (H, W).
        """
        frame = self.pipeline.frame_of(camera, STYLE, self.viewport)
        found = self.pipeline.renderer.read(frame)
        is_skin = (found.triangle >= 0) & ~found.is_inside
        is_skin &= found.triangle < self.drawn.triangle_count
        numbers = self.drawn.mesh.source[np.where(is_skin, found.triangle, 0)]
        scene = self.pipeline.scene
        fades = (scene.skin.fade[scene.faces, 0] < 1.0).any(axis=1)
        return np.where(is_skin & ~fades[numbers], numbers, -1)


@pytest.mark.slow
@pytest.mark.parametrize("refiner", [None, "none"])
@pytest.mark.parametrize("pose", POSES)
def test_an_open_chin_does_not_fade_beside_a_short_neck(short_necked, renderer, pose, refiner):
    """An open chin beside a short neck has the same colours as without a fade.

    Once the fade was fixed in space, so that a chin that sank below the neck's edge vanished.
    """
    scene = short_necked
    scene.reset()
    scene.pose(pose)
    scene.step(0.6)
    fade = scene.skin.fade
    edge = scene.positions[fade[:, 0] <= 0.0, 1].max()
    jaw = scene.landmarks[4:13]
    assert scene.positions[scene.landmarks[8], 1] < edge  # the chin is below the edge
    for yaw, pitch in ((0.0, 0.0), (0.0, -40.0), (50.0, -20.0)):
        camera = render.OrbitCamera.framing(scene.rest_positions, view="front")
        camera.orbit(yaw, pitch)
        camera.fit(scene.positions, 0.02)
        sitter = Sitter(scene, renderer, refiner)
        faded = sitter.picture(camera)
        shown = sitter.whole_skin(camera)
        images = scene.skin
        scene.skin = replace(images, fade=None)
        whole = Sitter(scene, renderer, refiner).picture(camera)
        scene.skin = images
        off = np.abs(whole - faded).max(axis=2)
        assert off[shown >= 0].max() <= 2
        assert np.isin(scene.faces[shown[shown >= 0]], jaw).any(axis=1).sum() > 50
        assert (off[shown < 0] > 20).sum() > 50  # the neck


@pytest.fixture(scope="module")
def thick_necked() -> FaceScene:
    """A head with a short neck so far forward that the chin of a nod enters it."""
    return with_short_neck(forward=60.0)


def test_a_faded_neck_makes_no_hole_in_a_mouth(thick_necked, renderer):
    """When a nod with an open jaw moves the neck's front into the mouth, the mouth stays dark."""
    thick_necked.reset()
    thick_necked.pose({"jaw_open": 1.0, "head_pitch": -1.0})
    thick_necked.step(0.6)
    for yaw in (-30.0, 0.0, 30.0):
        camera = render.OrbitCamera.framing(thick_necked.rest_positions, view="front")
        camera.orbit(yaw, 0.0)
        camera.fit(thick_necked.positions, 0.02)
        picture = Sitter(thick_necked, renderer, "none").picture(camera)
        places = CameraLabels.from_camera(camera, SIZE).project(
            thick_necked.positions[thick_necked.landmarks[60:68]]
        )
        lips = PIL.Image.new("1", SIZE)
        PIL.ImageDraw.Draw(lips).polygon([tuple(place) for place in places.tolist()], fill=1)
        assert (picture.min(axis=2) > 250)[np.asarray(lips)].sum() == 0
