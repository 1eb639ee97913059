"""The coarse head moves like the built-in one, and no look refines it with a crack."""

from itertools import product
from pathlib import Path

import numpy as np
import pytest
from numpy.linalg import norm
from PIL import Image

from risorius import refine, render
from risorius.app import capture as capture_room
from risorius.app.capture.drawing import camera_for
from risorius.app.refining.drawn_mesh import bind
from risorius.app.refining.presets import PRESETS, STATIC_REFINER, Refinement
from risorius.app.refining.refiners import refiner_for
from risorius.app.scenes import FaceScene, called_head
from risorius.assets.topology import boundary_loops
from risorius.geometry.rays import crossings
from tests.app.command_line import refusal, risorius, succeeded
from tests.sim.poses import advance

STEPS = 40  # steps of 1/60 s until a pose is reached


@pytest.fixture(scope="module")
def scene():
    """A face of the coarse head."""
    return FaceScene(called_head("coarse"))


def held(scene, **pose):
    """Positions [mm] of the vertices in a held pose, shape (V, 3)."""
    scene.reset()
    scene.pose(pose)
    advance(scene, STEPS)
    return scene.positions.copy()


def gap(scene, positions, upper, lower):
    """Distance between two landmarks [mm]."""
    first, second = positions[scene.landmarks[[upper, lower]]]
    return float(norm(first - second))


def test_coarse_head_has_all_controls_of_the_built_in_one(scene):
    """Both heads have the same muscles, action units, expressions, visemes and shapes."""
    assert scene.groups == FaceScene().groups


def test_each_shape_moves_the_coarse_head_sanely(scene):
    """All 52 ARKit shapes move skin by plausible amounts, equally on both halves."""
    shapes = scene.groups["ARKit shapes"]
    assert len(shapes) == 52
    rest = held(scene)
    looks = {f"eyeLook{way}{side}" for way, side in product(("In", "Out"), ("Left", "Right"))}
    alone_still = {*looks, "tongueOut", "mouthClose"}
    for name in shapes:
        moved = held(scene, **{name: 1.0})
        far = np.abs(moved - rest).max()
        assert np.isfinite(moved).all(), name
        assert far < 45.0, name
        assert far > 0.3 or name in alone_still, name
    left = held(scene, mouthSmileLeft=1.0)
    right = held(scene, mouthSmileRight=1.0)
    mirrored = left[scene.head.mirror] * (-1.0, 1.0, 1.0)
    assert np.abs(mirrored - right).max() < 1e-6


def test_even_poses_keep_the_coarse_head_even(scene):
    """A mirrored pose gives a mirrored face."""
    for pose in ({"joy": 1.0}, {"jaw_open": 1.0}, {"mouthPucker": 1.0}):
        moved = held(scene, **pose)
        mirrored = moved[scene.head.mirror] * (-1.0, 1.0, 1.0)
        assert np.abs(mirrored - moved).max() < 1e-6


def test_lips_and_lids_of_the_coarse_head_close(scene):
    """Lips touch at rest and part with the jaw; lids meet in a blink."""
    middle_of_lips = (62, 66)
    rest = held(scene)
    assert gap(scene, rest, *middle_of_lips) < 1.0
    assert gap(scene, held(scene, jaw_open=1.0), *middle_of_lips) > 20.0
    shut = held(scene, eyeBlinkLeft=1.0, eyeBlinkRight=1.0)
    for lids in ((43, 47), (44, 46), (37, 41), (38, 40)):
        assert gap(scene, shut, *lids) < 0.35 * gap(scene, rest, *lids)


def test_closed_lids_cover_the_eyes_by_every_look(scene):
    """Seen from the front, closed lids cover the eyes, unrefined and in every look.

    The paper's rule pulls lids apart.
    """
    shut = held(scene, blink=1.0)
    for look in (STATIC_REFINER, "paper", "smooth"):
        refinement = (
            Refinement(refiner=STATIC_REFINER) if look == STATIC_REFINER else Refinement(look)
        )
        mesh = refiner_for(scene, refinement).refine(shut)
        corners = np.asarray(mesh.positions, float)[mesh.triangles]
        for eye in scene.head.eyes:
            for x, y in product(np.linspace(-0.8, 0.8, 17), repeat=2):
                front = eye.centre + eye.radius * np.array([x, y, 0.0])
                volume, u, v, ahead = crossings(front, np.array([0.0, 0.0, -1.0]), corners)
                is_met = (volume > 0.0) & (np.minimum(u, v) >= 0.0) & (u + v <= 1.0)
                assert (is_met & (ahead < 0.0)).any(), (look, x, y)


def test_smile_of_the_coarse_head_lifts_the_corners(scene):
    """A smile lifts the corners of the mouth and moves them apart."""
    corners = scene.landmarks[[48, 54]]
    rest = held(scene)[corners]
    smile = held(scene, joy=1.0)[corners]
    assert (smile[:, 1] - rest[:, 1]).min() > 4.0
    assert np.ptp(smile[:, 0]) > np.ptp(rest[:, 0]) + 6.0


def test_refined_coarse_head_has_no_crack(scene):
    """In strongly bent poses the refined head has no crack, and more triangles, in any look."""
    for look in PRESETS:
        refiner = refiner_for(scene, Refinement(look))
        for pose in ({}, {"joy": 1.0}, {"jaw_open": 1.0}, {"mouthPucker": 1.0}, {"fear": 1.0}):
            positions = held(scene, **pose)
            mesh = refiner.refine(positions)
            refine.check(refiner, mesh, positions)
        assert len(mesh.triangles) > len(scene.faces)


def test_command_draws_the_coarse_head(tmp_path):
    """`--head coarse` draws the coarse head, and excludes landmarks of a file."""
    picture = tmp_path / "coarse.png"
    pose = ("--set", "joy", "--size", "64x48", "--quiet", "-o", picture)
    said = succeeded("capture", "--head", "coarse", "--refiner", "none", *pose)
    assert f"{len(called_head('coarse').faces)} triangles at most" in said
    assert Image.open(picture).size == (64, 48)
    refused = refusal(risorius("capture", "--head", "coarse", "--landmarks", "a.json", *pose))
    assert "its landmarks are known" in refused


def test_splits_beyond_rest_are_where_muscles_pull(scene):
    """The look smooth splits edges at rest; a kiss adds splits at the mouth only."""
    with render.open_offscreen((64, 64)) as surface:
        renderer = render.Renderer(surface)
        camera = camera_for(scene, None)
        smooth = bind(scene, renderer, Refinement())
        smooth.refine(held(scene), camera)
        assert smooth.splits().max() > 0
        assert smooth.splits_beyond_rest().max() == 0
        drawn = bind(scene, renderer, Refinement("paper"))
        drawn.refine(held(scene, mouthPucker=1.0), camera)
        added = drawn.splits_beyond_rest()
        sources = np.unique(drawn.mesh.source[added > 0])
        middles = scene.rest_positions[scene.faces[sources]].mean(axis=1)
        mouth = scene.rest_positions[scene.landmarks[48:68]].mean(axis=0)
        assert len(middles) > 3
        assert np.median(norm(middles - mouth, axis=1)) < 40.0


def test_border_of_an_opened_mouth_is_refined(scene):
    """The look smooth splits the border of an opened mouth, whose edges turn.

    Otherwise the lower lip would be a V.
    """
    refiner = refiner_for(scene, Refinement())
    refiner.refine(held(scene, jaw_open=1.0))
    loops = boundary_loops(scene.faces)
    centre = scene.rest_positions[scene.landmarks[60:68]].mean(axis=0)
    mouth = min(
        loops, key=lambda loop: norm(scene.rest_positions[list(loop)].mean(axis=0) - centre)
    )
    is_mouth = np.isin(refiner.edges, list(mouth)).all(axis=1)
    splits = refiner.splits[is_mouth]
    assert len(splits) == len(mouth)
    assert (splits > 0).mean() > 0.5


def test_demo_films_the_coarse_head_by_three_looks(monkeypatch):
    """The demo films three looks of the coarse head speaking, in clay and with wires.

    It also makes a sheet of expressions.
    """
    drawn = []

    def note(script, options, **outputs):
        """Record a call instead of drawing, which takes half a minute."""
        drawn.append((script.title, options, outputs))
        return 1

    monkeypatch.setattr(capture_room, "capture", note)
    said = succeeded("demo")
    (speech, filmed, film), (_, still, sheet) = drawn
    assert speech == "Speech"
    assert film == {"output": Path("out/demo.mp4")}
    assert sheet == {"sheet": Path("out/demo.png")}
    assert filmed.style.colour_by is render.ColourBy.SPLIT_WIRES
    assert filmed.is_alive
    for options in (filmed, still):
        looks = [each.label for each in (*options.beside, options.refinement)]
        assert looks == ["static", "paper", "smooth"]
        assert options.head.called == "coarse"
        assert not options.style.textured
    assert "out/demo.mp4 (6.1 s) and out/demo.png" in said
