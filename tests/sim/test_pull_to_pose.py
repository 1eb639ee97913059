"""Pull to pose: muscles hold skin at the place to which it was pulled."""

from types import SimpleNamespace

import numpy as np
import pytest
from numpy.linalg import norm
from pytest import approx

from risorius import sim
from tests.sim.poses import advance

FINGER_REACH = 16.0  # [mm]
RIGHT_CORNER = 48
LEFT_CORNER = 54
LEFT_BROW = 24
NOSE_LANDMARK = 30
CHIN_LANDMARK = 8
LEFT_LID = 44
INNER_BROW = 22
LEFT_WING = 35
LEFT_LOWER_LIP = 56


def candidates(face):
    """All muscles of one side, and the jaw."""
    names = face.controls.lowest
    return [
        (name,)
        for name in names
        if f"{name}_left" not in names
        and not name.startswith(("gaze_", "head_", "tongue_", "lips_closed"))
    ]


def pull_at(face, vertex, offset, **options):
    """Solve for skin around a vertex pulled by an offset [mm]; return its middle's motion."""
    distance = norm(face.positions - face.positions[vertex], axis=1)
    finger = np.flatnonzero(distance < FINGER_REACH)
    firmness = (1.0 - (distance[finger] / FINGER_REACH) ** 2) ** 2
    pull = sim.Pull(face, finger, firmness, candidates(face), **options)
    pull.targets = pull.targets + np.asarray(offset)
    before = pull.remaining
    pull.solve()
    return pull, before


def values_of(pull):
    """The solved values of the controls, sides apart."""
    return {name: value for names, value in pull.changes.items() for name in names}


def settled(face, values):
    """The places of the skin after these controls have settled."""
    face.controls.set_all(values)
    advance(face, 60)
    return face.positions.copy()


def test_a_corner_pulled_up_and_back_smiles(simulation, head):
    """A corner of the mouth pulled up and back, as in joy, is held by zygomaticus major."""
    corner = head.landmarks[LEFT_CORNER]
    drawn = settled(simulation, {"joy": 1.0})[corner] - simulation.rest_positions[corner]
    simulation.reset()
    pull, before = pull_at(simulation, corner, drawn)
    found = values_of(pull)
    assert next(iter(found)) == "zygomaticus_major_left"
    assert len(found) <= 4
    assert before > 5.0
    assert pull.remaining < 2.5
    off = settled(simulation, found)[corner] - simulation.rest_positions[corner] - drawn
    assert norm(off[:2]) < 2.5


@pytest.mark.parametrize(
    ("landmark", "offset", "wanted"),
    [
        (LEFT_BROW, (0.0, 5.0, 0.0), {"frontalis_lateral_left", "frontalis_medial_left"}),
        (CHIN_LANDMARK, (0.0, -15.0, 0.0), {"jaw_open"}),
        (CHIN_LANDMARK, (8.0, 0.0, 0.0), {"jaw_sideways"}),
        (LEFT_CORNER, (0.0, -6.0, 0.0), {"depressor_anguli_oris_left"}),
        (LEFT_LID, (0.0, -5.0, 0.0), {"orbicularis_oculi_palpebral_upper_left"}),
        (LEFT_CORNER, (5.0, 0.0, 0.0), {"risorius_left", "zygomaticus_major_left"}),
        (LEFT_CORNER, (0.0, 5.0, 0.0), {"levator_anguli_oris_left"}),
        (LEFT_LOWER_LIP, (0.0, -5.0, 0.0), {"depressor_labii_inferioris_left"}),
    ],
)
def test_skin_is_held_by_the_muscles_of_anatomy(simulation, head, landmark, offset, wanted):
    """Pulled brow, chin, corner, lid and lip are each held by the few muscles of anatomy.

    The corner drawn outward moved the whole mouth, the corner drawn up wrinkled the nose, and the
    lip drawn down opened the jaw.
    """
    pull, before = pull_at(simulation, head.landmarks[landmark], offset)
    found = values_of(pull)
    assert wanted <= found.keys()
    assert len(found) <= 3
    assert pull.remaining < 0.8 * before


def test_skin_without_muscles_does_not_move(simulation, head):
    """Pulled forward, the nose above its tip does not move, and neither does the crown."""
    pull, before = pull_at(
        simulation, head.landmarks[NOSE_LANDMARK - 1], (0.0, 0.0, 10.0), sight=(1.0, 0.0, 0.0)
    )
    assert not pull.changes
    assert pull.remaining == approx(before)
    crown = int(simulation.rest_positions[:, 1].argmax())
    for candidates_there in (candidates(simulation), []):
        pull = sim.Pull(simulation, [crown], [1.0], candidates_there)
        pull.targets = pull.targets + 5.0
        pull.solve()
        assert not pull.changes


class FlatFace:
    """A row of skin, moved in proportion to its controls; it has all that a pull needs."""

    def __init__(self, motions):
        """motions: motion of each point [mm] at the limit of a control, (n,), by its name."""
        self.motions = motions
        (count,) = {len(motion) for motion in motions.values()}
        self.areas = np.ones(count)
        names = dict.fromkeys(motions, 0.0)
        limits = dict.fromkeys(motions, (0.0, 1.0))
        self.controls = SimpleNamespace(values=names, limits=limits)

    @property
    def positions(self):
        """The points, (n, 3): they move up."""
        height = sum(self.controls.values[name] * motion for name, motion in self.motions.items())
        return np.column_stack([np.arange(len(height)), height, 0.0 * height])

    def clone(self):
        """Return a copy."""
        copy = FlatFace(self.motions)
        copy.copy_from(self)
        return copy

    def copy_from(self, other):
        """Take over the values of another row."""
        self.controls.values = dict(other.controls.values)

    def jump(self, values):
        """Set values of controls."""
        self.controls.values.update(values)

    def step(self, seconds):
        """Do nothing: the row is always at rest."""


def names_for(face, distance):
    """The controls that hold the first point, in the finger's middle, after a pull up [mm]."""
    firmness = [1.0, 0.3, 0.3]
    pull = sim.Pull(face, [0, 1, 2], firmness, [(name,) for name in face.motions])
    pull.targets = pull.targets + np.array([0.0, distance, 0.0])
    pull.solve()
    return set(values_of(pull))


def test_skin_at_the_mouse_counts_more_than_skin_at_the_rim():
    """A control that moves the finger's rim most is only used if no other control answers.

    A brow that was drawn up opened the lid at the finger's rim.
    """
    brow = np.array([4.0, 1.5, 1.5, 0.0])
    lid = np.array([4.0, 10.0, 10.0, 0.0])
    assert names_for(FlatFace({"brow": brow, "lid": lid}), 5.0) == {"brow"}
    assert names_for(FlatFace({"brow": -brow, "lid": lid}), 5.0) == {"lid"}


@pytest.mark.parametrize(
    ("landmark", "way"),
    [
        (LEFT_CORNER, (0.8, 0.6, 0.0)),
        (INNER_BROW, (-1.0, 0.0, 0.0)),
        (NOSE_LANDMARK, (0.0, 1.0, 0.0)),
        (LEFT_WING, (1.0, 0.0, 0.0)),
    ],
)
def test_a_far_pull_ends_at_the_limit_of_muscles(simulation, head, landmark, way):
    """Skin pulled too far moves to the limit of at most three muscles."""
    went = []
    for length in (6.0, 20.0, 40.0):
        simulation.reset()
        vertex = head.landmarks[landmark]
        pull, _ = pull_at(simulation, vertex, length * np.array(way))
        assert 1 <= len(pull.changes) <= 3
        there = settled(simulation, values_of(pull))[vertex] - simulation.rest_positions[vertex]
        went.append(float(there @ way))
    assert went[1] > 0.95 * went[0]
    assert went[2] > 0.95 * went[1]


def test_mirrored_pulls_are_mirrored(simulation, head):
    """A mirrored pull is held by the muscles of the other side."""
    left, _ = pull_at(simulation, head.landmarks[LEFT_CORNER], (7.0, 8.0, 0.0))
    right, _ = pull_at(simulation, head.landmarks[RIGHT_CORNER], (-7.0, 8.0, 0.0))
    mirrored = {name.replace("left", "right"): value for name, value in values_of(left).items()}
    assert values_of(right) == approx(mirrored, abs=0.01)
    assert right.remaining == approx(left.remaining, abs=0.02)


def test_the_answer_does_not_depend_on_the_way(simulation, head):
    """The result depends on the end of a pull only, not on detours in many frames."""
    straight, _ = pull_at(simulation, head.landmarks[LEFT_CORNER], (7.0, 8.0, 0.0))
    winding, _ = pull_at(simulation, head.landmarks[LEFT_CORNER], (0.0, 0.0, 0.0))
    at_rest = winding.targets
    for offset in ((0.0, -6.0, 0.0), (3.0, 0.0, 0.0), (7.0, 8.0, 0.0)):
        winding.targets = at_rest + np.array(offset)
        winding.solve()
    assert winding.changes == straight.changes


def test_a_pose_stays_and_is_only_added_to(simulation, head):
    """A brow pulled up does not change a smile; a corner pulled back down removes the smile."""
    settled(simulation, {"zygomaticus_major_left": 0.8})
    brow, _ = pull_at(simulation, head.landmarks[LEFT_BROW], (0.0, 5.0, 0.0))
    assert "zygomaticus_major_left" not in values_of(brow)
    corner = head.landmarks[LEFT_CORNER]
    back = simulation.rest_positions[corner] - simulation.positions[corner]
    undone, before = pull_at(simulation, corner, back)
    assert values_of(undone)["zygomaticus_major_left"] < 0.4
    assert undone.remaining < 0.3 * before


@pytest.mark.slow
def test_few_muscles_are_found_again(simulation, head, generator):
    """Skin moved by one to three random muscles is nearly held there, by as few.

    At most an eighth of the motions has no answer.
    """
    muscles = [c[0] for c in candidates(simulation) if c[0].endswith("_left")]
    muscles = [name for name in muscles if not name.startswith(("levator_palp", "lips"))]
    front = simulation.rest_positions[:, 2] > simulation.rest_positions[:, 2].max() - 75.0
    shares = []
    while len(shares) < 48:
        chosen = generator.choice(muscles, int(generator.integers(1, 4)), replace=False)
        simulation.reset()
        moved = settled(simulation, {n: float(generator.uniform(0.3, 1.0)) for n in chosen})
        moved -= simulation.rest_positions
        vertex = int((norm(moved, axis=1) * front).argmax())
        simulation.reset()
        distance = norm(simulation.positions - simulation.positions[vertex], axis=1)
        finger = np.flatnonzero(distance < FINGER_REACH)
        if norm(moved[finger].mean(axis=0)[:2]) < 1.5:  # mm, as seen from the front
            continue
        pull = sim.Pull(simulation, finger, np.ones(len(finger)), candidates(simulation))
        pull.targets = pull.targets + moved[finger]
        before = pull.remaining
        pull.solve()
        assert len(pull.changes) <= 4
        shares.append(pull.remaining / before)
    held = [share for share in shares if share < 0.3]
    assert len(held) >= 42
    assert np.mean(held) < 0.1


def test_the_motion_of_a_muscle_ignores_the_pose(simulation, head):
    """The motion is that of a smile at rest, although the face shows a kiss; the face stays."""
    expected = sim.motion_of(simulation, "zygomaticus_major_left")
    simulation.controls.set("orbicularis_oris_sphincter", 1.0)
    advance(simulation, 20)
    before = simulation.positions.copy()
    found = sim.motion_of(simulation, "zygomaticus_major_left")
    assert (simulation.positions == before).all()
    assert found == approx(expected, abs=1e-6)
    corner, other_corner = norm(found[head.landmarks[[LEFT_CORNER, RIGHT_CORNER]]], axis=1)
    assert corner > 5.0
    assert other_corner < 2.0
