"""What `bench form` mends and writes: meshes without cuts, eyes behind lids, files that load."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from risorius.assets.intersections import self_intersections
from risorius.assets.loading import load_head
from risorius.assets.model import Head
from risorius.bench.form import MOST_WEIGHT, RMS, Form, drawn, save, settled, turned, without_cuts
from risorius.bench.form_parts import lids_and_eyes
from risorius.bench.registration import MIRROR
from risorius.geometry.normals import vertex_normals


def test_a_drawn_person_is_ordinary_and_always_the_same() -> None:
    """Weights are as people's, none of them odd; another number is another person."""
    weights = drawn(7, 50)
    assert 0.8 < np.sqrt((weights**2).mean()) <= RMS
    assert np.abs(weights).max() <= MOST_WEIGHT
    assert (weights == drawn(7, 50)).all()
    assert not (weights == drawn(8, 50)).any()


def test_eyes_and_lids_of_the_built_in_head_fit(head: Head) -> None:
    """They are found within half a millimetre of where they are, the same on both sides."""
    vertices, (right, left) = lids_and_eyes(head, head.vertices)
    assert left.centre == pytest.approx(head.eyes[1].centre, abs=0.5)
    assert right.centre == pytest.approx(left.centre * MIRROR)
    assert np.abs(vertices - head.vertices).max() < 0.7
    edge = vertices[head.rings["eye_1_left"]] - left.centre
    assert np.linalg.norm(edge, axis=1).min() > left.radius + 0.1


def test_lips_are_shut_and_insides_follow(head: Head) -> None:
    """The built-in head stays; lips that were pulled apart meet as they do there, with insides."""
    assert settled(head, head.vertices) == pytest.approx(head.vertices, abs=3.0)
    rows = [head.rings[f"mouth_{k}_left"] for k in range(3)]
    pulled = head.vertices.copy()
    lower = rows[2][8:]
    pulled[lower, 1] -= 2.0
    pulled[head.mirror[lower]] = pulled[lower] * MIRROR
    shut = settled(head, pulled)
    for upper in range(7):
        ends = rows[2][[upper, 14 - upper]]
        gap, wanted = (np.diff(x[ends], axis=0)[0] for x in (shut, head.vertices))
        assert gap == pytest.approx(wanted, abs=1e-9)
    inner = [x[rows[1]] - x[rows[2]] for x in (shut, head.vertices)]
    assert inner[0] == pytest.approx(inner[1], abs=1e-9)


def test_finer_meshes_step_back_where_they_cut_themselves(head: Head) -> None:
    """A vertex of the finest mesh that goes through the head comes back; the others stay."""
    fine = head.finer(2)
    through = fine.vertices.copy()
    x = through[len(head.vertices) :]
    tip = len(head.vertices) + int((x @ [0.0, 0.0, 1.0] - np.abs(x[:, 0])).argmax())
    through[tip] += [0.0, -45.0, -20.0]
    assert len(self_intersections(through, fine.faces))
    mended = without_cuts(head, fine, head.vertices, through)
    for level in (head.finer(1), fine):
        assert not len(self_intersections(mended[: len(level.vertices)], level.faces))
    moved = np.linalg.norm(mended - fine.vertices, axis=1) > 1e-4
    assert moved.mean() < 0.01


def test_directions_of_wrinkles_turn_with_the_skin(head: Head) -> None:
    """In a head that is turned as a whole they are turned alike; lengths stay."""
    turn = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
    across = head.wrinkles.across.astype(np.float64)
    found = turned(head, head.vertices @ turn.T, across)
    assert np.linalg.norm(found, axis=2) == pytest.approx(np.linalg.norm(across, axis=2))
    inside = np.linalg.norm(across, axis=2) > 0.1
    normals = vertex_normals(head.vertices, head.faces)[:, None]
    level = across - (across * normals).sum(axis=2)[:, :, None] * normals
    a, b = found[inside], (level @ turn.T)[inside]
    cosine = (a * b).sum(axis=1) / np.linalg.norm(a, axis=1) / np.linalg.norm(b, axis=1)
    assert cosine.min() > 0.999


def test_what_is_written_is_a_head(head: Head, tmp_path: Path) -> None:
    """All files load as one head: mesh, finer meshes, wrinkles, tones, picture and classes."""
    fine = head.finer(2)
    larger = Form(
        1.02 * head.vertices,
        1.02 * fine.vertices,
        tuple(replace(eye, centre=1.02 * eye.centre) for eye in head.eyes),
        head.parts,
        1.02 * head.jaw_axis,
        np.zeros((2, *head.vertices.shape)),
        np.zeros(2),
    )
    save(head, larger, tmp_path)
    found = load_head(tmp_path / "head.npz")
    assert (found.vertices == larger.vertices).all()
    assert (found.faces == head.faces).all()
    assert found.finer(2).vertices == pytest.approx(larger.finest, abs=1e-4)
    assert found.eyes[1].centre == pytest.approx(1.02 * head.eyes[1].centre)
    assert found.wrinkles.map.shape == head.wrinkles.map.shape
    assert found.albedo.shape == head.albedo.shape
    assert found.segments.shape == head.segments.shape
