"""Frames drawn directly from the card: the same pictures as with uploaded arrays."""

import os
import sys
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

from risorius import render
from risorius.app.dataset.request import request_of
from risorius.app.dataset.studio import Studio
from risorius.app.pipeline import Pipeline, Viewport
from risorius.app.refining import drawn_mesh
from risorius.app.refining.presets import Refinement
from risorius.app.scenes import FaceScene
from risorius.refine_gl import LEAST_VERSION, KahlerGl
from tests.app.command_line import succeeded
from tests.sim.poses import advance

from .agreement import needs_exact_driver

pytestmark = needs_exact_driver
SIZE = (200, 240)
PLAIN_STYLE = render.Style(textured=False, bumps=0.0)
STYLES = {
    "skin": render.Style(bumps=0.0),
    "wrinkles": render.Style(),
    "flat": replace(PLAIN_STYLE, shading=render.Shading.FLAT),
    "wireframe": replace(PLAIN_STYLE, wireframe=True),
    "splits": replace(PLAIN_STYLE, colour_by=render.ColourBy.SPLITS),
    "translucent": replace(PLAIN_STYLE, opacity=0.6),
}


@pytest.fixture(scope="module")
def scene() -> FaceScene:
    """A laughing face."""
    scene = FaceScene()
    scene.pose({"joy": 1.0})
    advance(scene, 30, 1 / 30)
    return scene


@pytest.fixture(scope="module", params=[0, 4])
def pipeline(request: pytest.FixtureRequest, scene: FaceScene) -> Iterator[Pipeline]:
    """The scene on an offscreen surface, with one sample per pixel, or four."""
    with render.open_offscreen(SIZE, samples=request.param) as surface:
        yield Pipeline(scene, render.Renderer(surface))


def image(pipeline, drawn, style):
    """The pipeline's picture."""
    surface = pipeline.renderer.surface
    camera = render.OrbitCamera.framing(pipeline.scene.rest_positions, view="three-quarter")
    size = surface.frame_size if isinstance(surface, render.WindowSurface) else surface.size
    pipeline.draw(camera, style, [Viewport(drawn, (0, 0, *size))])
    return surface.read()


def both(pipeline, look="paper"):
    """The frame made by the processor, and the frame made on the card."""
    drawn = [pipeline.bind(Refinement(look, name)) for name in ("kahler", "kahler-gl")]
    assert isinstance(drawn[1].refiner, KahlerGl)
    assert isinstance(drawn[1].stream, render.GpuStream)
    return drawn[0], drawn[1]


def drawn_by(monkeypatch, kind):
    """Make any driver count as software or as hardware."""
    is_software = kind == "software"
    monkeypatch.setattr(render.Surface, "is_software", property(lambda _: is_software))


def test_a_card_takes_large_meshes_by_itself(pipeline, monkeypatch):
    """With a hardware driver, a large mesh in a look is refined on the card automatically.

    The picture is that of the same refiner on the processor. Only the built-in head's nostrils,
    whose rims a look rounds, would differ, and this head is not large.
    """
    smooth = Refinement("smooth")
    processor = pipeline.bind(Refinement("smooth", "kahler"))
    count = len(pipeline.scene.faces)
    monkeypatch.setattr(drawn_mesh, "LARGE_MESH", count)
    drawn_by(monkeypatch, "software")
    before = pipeline.bind(smooth)
    drawn_by(monkeypatch, "hardware")
    now = pipeline.bind(smooth)
    assert isinstance(now.refiner, KahlerGl)
    assert not isinstance(before.refiner, KahlerGl)
    pictures = [image(pipeline, each, render.Style()).astype(int) for each in (processor, now)]
    assert np.abs(pictures[0] - pictures[1]).max() <= 2
    assert now.triangle_count == processor.triangle_count
    assert now.label == before.label
    for other in (Refinement("smooth", "kahler"), replace(smooth, options={"blend": False})):
        assert not isinstance(pipeline.bind(other).refiner, KahlerGl)
    monkeypatch.setattr(drawn_mesh, "LARGE_MESH", count + 1)
    assert not isinstance(pipeline.bind(smooth).refiner, KahlerGl)


@pytest.mark.parametrize("kind", ["software", "hardware"])
@pytest.mark.parametrize("style", STYLES)
def test_pictures_are_the_same(pipeline, style, kind, monkeypatch):
    """Pictures of both frames are equal in every style, for software and hardware drivers."""
    drawn_by(monkeypatch, kind)
    processor, card = both(pipeline)
    wanted, got = (image(pipeline, each, STYLES[style]) for each in (processor, card))
    assert np.array_equal(wanted, got)
    assert wanted.std() > 10.0
    assert card.caption.endswith(f"\n{processor.triangle_count} triangles")


def test_nothing_is_downloaded(scene, monkeypatch):
    """A hardware driver draws a frame that stays on the card, if no numbers are requested."""
    drawn_by(monkeypatch, "hardware")
    with render.open_offscreen(SIZE, samples=4) as surface:
        pipeline = Pipeline(scene, render.Renderer(surface))
        _, card = both(pipeline)
        image(pipeline, card, PLAIN_STYLE)
        assert not {"_counts", "vertices", "triangles", "source"} & set(vars(card.mesh))
        assert card.refiner._fetched_splits is None


@pytest.mark.parametrize("options", [["paper", "--compare", "none"], ["smooth"]])
def test_films_are_the_same(tmp_path, options):
    """`capture --refiner kahler-gl` writes the film that `--refiner kahler` writes."""
    pictures = []
    for name in ("kahler-gl", "kahler"):
        path = tmp_path / f"{name}.png"
        still = ("--set", "joy=1", "--size", "160x120", "--look")
        succeeded("capture", "-o", path, *still, *options, "--refiner", name)
        pictures.append(np.asarray(Image.open(path)))
    assert np.array_equal(*pictures)


@pytest.mark.slow
def test_samples_of_data_sets_are_the_same(tmp_path):
    """`dataset --refiner kahler-gl` makes the same pictures, passes and labels as `kahler`."""
    passes = ("depth", "normal", "splits", "segmentation")
    requests = (
        request_of(tmp_path, seed=3, size=(80, 64), passes=passes, refiner=name)
        for name in ("kahler-gl", "kahler")
    )
    card, processor = (Studio(request).shoot(0) for request in requests)
    assert np.array_equal(card.image, processor.image)
    assert card.image.std() > 10.0
    assert card.known.labels == processor.known.labels
    for name in passes:
        np.testing.assert_array_equal(card.known.images[name], processor.known.images[name])


@pytest.mark.window
@pytest.mark.skipif(
    sys.platform.startswith("linux") and not os.environ.get("DISPLAY"), reason="needs a display"
)
@pytest.mark.parametrize("look", ["paper", "smooth"])
def test_a_window_that_is_resized(scene, look):
    """A resized window shows the same picture from the card as from the processor."""
    with render.open_window((200, 150), "kahler-gl", samples=0) as window:
        if window.gl.version_code < LEAST_VERSION:
            driver = window.gl.info["GL_RENDERER"]
            pytest.skip(f"windows are drawn by {driver}, which has no OpenGL 4.3")
        pipeline = Pipeline(scene, render.Renderer(window))
        processor, card = both(pipeline, look)
        for size in ((200, 150), (320, 200), (100, 240)):
            resize(window, size)
            wanted, got = (image(pipeline, each, PLAIN_STYLE) for each in (processor, card))
            assert got.shape[:2] == size[::-1]
            assert np.array_equal(wanted, got)


def resize(window, size):
    """Request a size, and wait until the window has it."""
    import glfw

    glfw.set_window_size(window.handle, *size)
    for _ in range(10_000):
        glfw.poll_events()
        if window.frame_size == size:
            return
    raise AssertionError(f"the window has {window.frame_size}")
