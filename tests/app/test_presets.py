"""Looks: every refiner draws each look on every scene; the look paper is the paper's rule."""

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from risorius import refine, render
from risorius.app.capture.drawing import camera_for_whole_scene
from risorius.app.pipeline import Pipeline, Viewport
from risorius.app.refining.presets import PRESETS, Refinement
from risorius.app.refining.refiners import parse_comparison, refiner_for
from risorius.app.scenes import SCENES, Scene

SIZE = (160, 120)
MOVED_VALUES = {
    "face": {"disgust": 1.0},
    "plane": {"amplitude": 1.0, "phase": 0.3},
}


@pytest.fixture(scope="module")
def surface() -> Iterator[Any]:
    """A small offscreen surface."""
    with render.open_offscreen(SIZE, samples=0) as opened:
        yield opened


@pytest.fixture(scope="module")
def scenes() -> dict[str, Scene]:
    """Every scene, with moved vertices."""
    built = {name: build() for name, build in SCENES.items()}
    for name, scene in built.items():
        scene.pose(MOVED_VALUES[name])
        scene.step(0.5)
    return built


@pytest.mark.parametrize("refiner", [None, *refine.refiners.available()])
@pytest.mark.parametrize("look", PRESETS)
@pytest.mark.parametrize("name", SCENES)
def test_every_look_is_drawn_by_every_refiner(surface, scenes, name, look, refiner):
    """Each look is drawn by every refiner on every scene, visibly, without a crack."""
    scene = scenes[name]
    refinement = Refinement(look, refiner)
    pipeline = Pipeline(scene, render.Renderer(surface))
    drawn = pipeline.bind(refinement)
    camera = camera_for_whole_scene(scene, "front")
    pipeline.draw(camera, render.Style(), [Viewport(drawn, (0, 0, *SIZE))])
    assert np.ptp(surface.read()) > 30
    bound = refiner_for(scene, refinement)
    mesh = bound.refine(scene.positions)
    refine.check(bound, mesh, scene.positions)
    assert len(mesh.triangles) == drawn.triangle_count
    is_refined = len(mesh.triangles) > 1.2 * len(scene.faces)
    assert is_refined == (refiner != "none")


def test_the_look_paper_is_the_papers_rule(scenes):
    """On the face, the look paper makes the triangles of `kahler` without options.

    The look smooth makes more.
    """
    face = scenes["face"]
    skin = face.skin
    plain = refine.create("kahler", face.faces, face.rest_positions, skin.uv, skin.face_uv)
    wanted = plain.refine(face.positions)
    seen = refiner_for(face, Refinement("paper")).refine(face.positions)
    for array in ("triangles", "positions", "normals", "source", "uv"):
        assert np.array_equal(getattr(seen, array), getattr(wanted, array)), array
    smooth = refiner_for(face, Refinement("smooth")).refine(face.positions)
    assert len(smooth.triangles) > 1.2 * len(seen.triangles)


@pytest.mark.usefixtures("own_refiners")
def test_a_comparison_is_of_looks_and_refiners():
    """A comparison lists looks and refiners in order; a refiner gets the options of the look.

    The refiner may be a plug-in.
    """
    refine.refiners.register("far", refine.PassThrough)
    shown = Refinement("paper", "kahler", {"blend": True})
    assert parse_comparison("none,smooth,far", shown) == (
        Refinement("paper", "none"), Refinement("smooth"), Refinement("paper", "far"),
    )  # fmt: skip
    assert parse_comparison(None, shown) == ()
    assert parse_comparison("paper", shown) == (Refinement("paper"),)  # the current look stays
