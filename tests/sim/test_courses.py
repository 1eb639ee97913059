"""Courses of muscles, as they are drawn: in the skin, smooth, and under the mouse."""

import re

import numpy as np
import pytest
from numpy.linalg import norm

from risorius.geometry.directions import unit_vectors
from tests.sim.poses import advance, settled_displacement


def test_fibres_shorten(simulation):
    """Every muscle has fibres to draw, which get shorter in a contraction."""
    relaxed = simulation.anatomy.fibres()
    assert all(relaxed[name] for name in relaxed)
    settled_displacement(simulation, {"zygomaticus_major_left": 1.0})
    tight = simulation.anatomy.fibres()["zygomaticus_major_left"]
    for before, after in zip(relaxed["zygomaticus_major_left"], tight, strict=True):
        assert _length(after) < 0.8 * _length(before)


def test_courses_stay_in_the_skin(simulation):
    """Where a muscle runs, its insertion stays in the skin; alone, the fibre shortens further.

    The window drew the latter, which ended in the middle of the cheek.
    """
    major = "zygomaticus_major_left"
    relaxed = simulation.anatomy.courses()
    for name, lines in simulation.anatomy.fibres().items():
        np.testing.assert_allclose(relaxed[name], lines, atol=1e-9)
    moved = settled_displacement(simulation, {major: 1.0})
    (*_, end) = relaxed[major][0]
    skin = moved[norm(simulation.rest_positions - end, axis=1).argmin()]
    course = simulation.anatomy.courses()[major][0]
    assert norm(course[-1] - end - skin) < 1.5
    assert norm(simulation.anatomy.fibres()[major][0][-1] - end - skin) > 5.0
    np.testing.assert_allclose(course[0], relaxed[major][0][0], atol=0.1)


def test_sphincters_are_drawn_without_corners(simulation):
    """The line of each sphincter is long, and has one corner at most, where a flat loop returns.

    It went from vertex to vertex in zigzags, and that of the cheek raiser was a single point.
    """
    sphincters = "orbicularis_oris|oculi_orbital|preseptal|cheek_puff|incisivus"
    courses = simulation.anatomy.courses()
    names = [name for name in courses if re.search(sphincters, name)]
    assert len(names) > 20
    for name in names:
        (line,) = courses[name]
        steps = np.diff(line, axis=0)
        assert _length(line) > 10.0, name
        ways = unit_vectors(steps)
        corners = (ways[1:] * ways[:-1]).sum(axis=1) < 0.5  # turns of more than 60 degrees
        assert corners.sum() <= 1, name


@pytest.mark.parametrize(("corner", "side"), [(48, "_right"), (54, "_left")])
def test_a_corner_of_the_mouth_shows_a_muscle_of_its_side(simulation, head, corner, side):
    """Rings of the other side also pass there, also where the head is turned."""
    for yaw in (0.0, 1.0):
        simulation.controls.set("head_yaw", yaw)
        advance(simulation, 30)
        place = simulation.positions[head.landmarks[corner]]
        assert simulation.anatomy.muscle_at(place, 14.0).endswith(side)


def test_courses_follow_the_lips_apart(simulation):
    """Over an open jaw, muscles of the lower lip go down with it, those of the upper stay."""
    relaxed = simulation.anatomy.courses()
    settled_displacement(simulation, {"jaw_open": 1.0})
    now = simulation.anatomy.courses()

    def rise(name):
        """How far the end of the muscle's first line has moved up [mm]."""
        end = now[name][0][-1]
        end_at_rest = relaxed[name][0][-1]
        return float(end[1] - end_at_rest[1])

    assert rise("depressor_labii_inferioris_left") < -10.0
    assert abs(rise("levator_labii_superioris_left")) < 4.0


def _length(line):
    return float(norm(np.diff(line, axis=0), axis=1).sum())
