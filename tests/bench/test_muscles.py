"""Each muscle alone moves the regions of its anatomy, and hardly any others."""

import copy
from types import SimpleNamespace

import numpy as np
import pytest

from risorius import sim
from risorius.bench.muscles import (
    MOST_ELSEWHERE,
    MOVED_REGIONS,
    REGION_POINTS,
    MuscleRow,
    measure_head,
    regions_of,
    report,
    targets,
)
from risorius.sim.coordinates import FaceSpace
from tests.heads import person_of
from tests.sim.poses import settled_displacement

NO_MUSCLES = {"cheek_puff", "upper_lip_shrug", "lips_sideways"}  # pressure, and pushes from below


def with_rig(head, rig):
    """A head with all that a simulation needs, and another rig."""
    names = ("vertices", "faces", "landmarks", "layers", "jaw_axis", "mandible_weight", "eyes")
    return SimpleNamespace(**{name: getattr(head, name) for name in names}, rig=rig)


def test_each_muscle_of_the_rig_moves_its_own_regions(head):
    """No muscle moves a region of another muscle by more than the bound.

    The levator of the mouth's corner lifted chin and throat by 7 mm, and a muscle of the upper lip
    lifted the throat by 4 mm.
    """
    rows = list(measure_head("built-in", head))
    assert all(target.is_met for target in targets(rows))
    assert "levator_anguli_oris" in report(rows)
    muscles = head.rig["muscle"]
    assert {name for name, muscle in muscles.items() if muscle["kind"] != "lid"} == (
        MOVED_REGIONS.keys() | NO_MUSCLES
    )


def test_a_sharp_lip_puller_leaves_the_chin(head):
    """AU13 lifts the corners of the mouth by 4 to 7 mm, and the chin by less than 1.5 mm.

    It lifted the chin by 7 mm.
    """
    moved = settled_displacement(sim.create(head), {"AU13": 1.0})
    corner, chin = moved[head.landmarks[[54, 8]]]
    assert 4.0 < corner[1] < 7.0
    assert np.linalg.norm(chin) < 1.5


def test_a_muscle_that_reaches_too_far_is_named(head):
    """A levator that holds skin within 34 mm of its end misses the target, by chin or throat."""
    rig = copy.deepcopy(dict(head.rig))
    levator = rig["muscle"]["levator_anguli_oris"]
    levator["width"] = 20.3
    levator["beyond"] = 18.6
    levator["fibre"][0]["width_factor"] = 1.83
    (target,) = targets(list(measure_head("wide", with_rig(head, rig))))
    assert not target.is_met
    assert "levator_anguli_oris moves" in target.text


def test_the_worst_region_is_one_that_the_muscle_must_not_move():
    """Motion of a muscle's own regions does not count."""
    motions = dict.fromkeys(REGION_POINTS, 0.0) | {"chin": 9.0, "throat": 4.0, "nose": 1.0}
    row = MuscleRow("head", "mentalis", tuple(motions.values()))
    assert row.elsewhere() == ("throat", 4.0)
    (target,) = targets([row])
    assert not target.is_met
    assert f"at most {MOST_ELSEWHERE:g} mm" in target.text


@pytest.mark.parametrize(
    ("landmark", "region"),
    [
        (57, "lower lip"), (51, "upper lip"), (48, "corners"), (8, "chin"), (33, "wings"),
        (30, "nose"), (19, "brows"), (37, "lids"), (5, "jaw"),
    ],
)  # fmt: skip
def test_landmarks_lie_in_their_regions(head, landmark, region):
    """A landmark belongs to the region of its name; the back of the head belongs to none."""
    space = FaceSpace.from_landmarks(head.vertices[head.landmarks])
    skin = space.to_standard(head.vertices)
    regions = regions_of(skin, skin[head.landmarks])
    assert list(REGION_POINTS)[regions[head.landmarks[landmark]]] == region
    assert regions[np.argmin(skin[:, 2])] == -1


def test_persons_have_the_same_muscles():
    """The bound holds on a head with another form."""
    rows = list(measure_head("person 7", person_of(7)))
    assert all(target.is_met for target in targets(rows))
