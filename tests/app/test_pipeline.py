"""The paper's Figure 1 as a whole: an external refiner fits in, and the mesh is unchanged."""

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from pytest import approx

from risorius import render
from risorius.app.capture import Capture, CaptureOptions
from risorius.app.motion import SETTLING_TIME
from risorius.app.pipeline import Pipeline, Viewport
from risorius.app.refining.presets import Refinement
from risorius.app.scenes import FaceScene, PlaneScene
from risorius.app.script.script_file import parse_script

SIZE = (320, 240)


@pytest.fixture
def surface() -> Iterator[Any]:
    """A small offscreen surface."""
    with render.open_offscreen(SIZE, samples=0) as opened:
        yield opened


def image(pipeline, drawn):
    """The picture of a scene with one refiner."""
    surface = pipeline.renderer.surface
    camera = render.OrbitCamera.framing(pipeline.scene.rest_positions, view="front")
    pipeline.draw(camera, render.Style(), [Viewport(drawn, (0, 0, *SIZE))])
    return surface.read()


def test_the_mesh_and_the_simulation_never_notice(surface):
    """The simulation has the same bytes in each step with refinement and without."""
    scenes = [FaceScene(), FaceScene()]
    renderer = render.Renderer(surface)
    for scene, name in zip(scenes, ("none", "kahler"), strict=True):
        pipeline = Pipeline(scene, renderer)
        drawn = pipeline.bind(Refinement(refiner=name))
        faces = scene.faces.copy()
        scene.pose({"surprise": 1.0})
        for _ in range(15):
            pipeline.step(1 / 30)
            image(pipeline, drawn)
        assert np.array_equal(faces, scene.faces)
    assert scenes[0].positions.tobytes() == scenes[1].positions.tobytes()
    assert drawn.triangle_count > 1.1 * len(scenes[0].faces)


def test_refined_and_static_agree_where_nothing_moved(surface):
    """By the paper's criterion, the refined picture at rest equals the static one exactly."""
    pipeline = Pipeline(FaceScene(), render.Renderer(surface))
    asked = Refinement(refiner="none"), Refinement("paper")
    assert np.array_equal(*(image(pipeline, pipeline.bind(each)) for each in asked))


@pytest.mark.parametrize(("first", "settling"), [(0.0, 0.0), (0.5, SETTLING_TIME)])
@pytest.mark.parametrize("rate", [24.0, 30.0])
def test_a_film_takes_as_long_as_its_script(first, settling, rate):
    """The scene's time equals the time between frames, and each frame has its pose."""
    text = f"[[pose]]\ntime = 0\namplitude = {first}\n[[pose]]\ntime = 0.5\namplitude = 1\n"
    script = parse_script(text, source="wave")
    options = CaptureOptions(size=SIZE, samples=0, frames_per_second=rate)
    with Capture(PlaneScene(), options) as capture:
        steps = []
        capture.pipeline.step = steps.append
        times = list(capture.play(script, progress=False))
        assert times == approx(np.arange(len(times)) / rate)
        assert times[-1] == approx(0.5)
        assert sum(steps) == approx(0.5 + settling)
        assert capture.scene.values["amplitude"] == 1.0
