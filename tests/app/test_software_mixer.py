"""Edges smoothed by kernels on the processor equal those smoothed by a graphics card."""

from collections.abc import Iterator

import numpy as np
import pytest

from risorius import render
from risorius.app.anatomy import AnatomyView
from risorius.app.capture import Capture, CaptureOptions
from risorius.app.capture.drawing import camera_for
from risorius.app.refining.presets import STATIC_REFINER, Refinement
from risorius.app.scenes import FaceScene
from risorius.render.renderer import Renderer
from risorius.render.sample_mixer import SampleMixer
from risorius.render.software_mixer import SoftwareMixer

POSES = ({}, {"jaw_open": 1.0, "tongue_out": 1.0}, {"AU43": 1.0, "AU12": 1.0}, {"head_yaw": 1.0})
CAMERAS = ("front", "20,-60", "-30,10,6")


@pytest.fixture(scope="module")
def studio() -> Iterator[Capture]:
    """Two heads side by side, in a size that is not a multiple of a tile."""
    options = CaptureOptions(
        size=(405, 231), beside=(Refinement(refiner=STATIC_REFINER),), captions=False, samples=4
    )
    with Capture(FaceScene(), options) as opened:
        if not opened.surface.is_software or not opened.surface.samples:
            pytest.skip("a GPU has passes alone")
        yield opened


@pytest.fixture
def share_off(studio, monkeypatch):
    """A function of camera, style and anatomy, for the fraction of visibly different pixels."""

    def measured(camera="front", style=None, anatomy=None):
        """Fractions of pixels over 8 levels apart: of both mixers, with and without smoothing."""
        view = camera if isinstance(camera, render.OrbitCamera) else None
        studio.camera = view or camera_for(studio.scene, camera)
        style = style or studio.options.style
        seen = []
        target = studio.surface.target
        for mixer in (SoftwareMixer(target), SampleMixer(studio.surface.gl, target), NotSmooth()):
            monkeypatch.setattr(Renderer, "_new_mixer", lambda *_, new=mixer: new)
            studio.pipeline.renderer._mixer = None
            studio.pipeline.draw(
                studio.camera, style, studio.viewports, anatomy=anatomy or AnatomyView()
            )
            seen.append(studio.surface.read().astype(int))
        monkeypatch.undo()
        studio.pipeline.renderer._mixer = None
        kernels, samples, rough = seen
        off = (np.abs(kernels - samples).max(axis=2) > 8).mean()
        smoothed = (np.abs(kernels - rough).max(axis=2) > 8).mean()
        return float(off), float(smoothed)

    return measured


class NotSmooth:
    """A mixer that does not smooth edges."""

    target = None

    def mix(self, *_):
        """Do nothing."""


@pytest.mark.parametrize("camera", CAMERAS)
@pytest.mark.parametrize("pose", POSES)
def test_a_face_has_the_same_edges(studio, share_off, camera, pose):
    """A face has the same edges from everywhere, with eyes and mouth open or shut.

    Hair and lips are included.
    """
    known = studio.scene.limits
    studio.scene.reset()
    studio.scene.pose({name: value for name, value in pose.items() if name in known})
    studio.scene.step(0.5)
    off, smoothed = share_off(camera)
    assert off < 2e-4
    assert smoothed > 5e-3 or camera == CAMERAS[-1]


@pytest.mark.parametrize(
    "style",
    [
        render.Style(shading=render.Shading.FLAT),
        render.Style(shading=render.Shading.GOURAUD, textured=False),
        render.Style(colour_by=render.ColourBy.SPLITS),
        render.Style(background=None),
    ],
)
def test_every_style_has_the_same_edges(studio, share_off, style):
    """Every style has the same edges: flat triangles, unused normals, no background."""
    studio.scene.reset()
    off, smoothed = share_off("20,-60", style)
    assert off < 3e-4
    assert smoothed > 5e-3


@pytest.mark.parametrize("side", ["both", "left"])
def test_opened_skin_has_the_same_edges(studio, share_off, side):
    """Opened skin has the same edges: muscles below translucent skin, skull below cut skin."""
    studio.scene.reset()
    seen = AnatomyView(("muscles", "skull"), side=side)
    off, smoothed = share_off("front", anatomy=seen)
    assert off < 3e-4
    assert smoothed > 5e-3


def test_triangles_reach_behind_the_eye(studio, share_off):
    """Edges are the same with the camera at the cheek, and a part of the head behind it."""
    studio.scene.reset()
    camera = camera_for(studio.scene, "-30,10")
    camera.distance = 0.12 * camera.scene_radius
    camera.target = camera.scene_centre + np.array([0.0, 0.0, 0.45 * camera.scene_radius])
    off, smoothed = share_off(camera)
    assert off < 2e-4
    assert smoothed > 5e-4
