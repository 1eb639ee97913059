"""The rig file: its keys, and mistakes reported with muscle, key and remedy."""

import copy

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from risorius import sim
from risorius.sim.landmarks import LandmarkPoint, Side
from risorius.sim.rig import LinearMuscle, RingMuscle, Tissue, read_rig
from tests.sim.poses import both_sides, moved_landmarks, settled_displacement, without


def _fibre():
    return {
        "origin": {"landmarks": {"45": 0.6, "14": 0.4}, "offset": [-4.5, -17.6, -5.6]},
        "insertion": {"landmark": 54},
    }


def _document():
    """A small rig with every kind of muscle."""
    text = {"action": "moves", "group": "Group"}
    return {
        "format": 1,
        "tissue": {"tangential": 0.5},
        "jaw": {"seeds": {"8": 1.0, "30": 0.0}},
        "muscle": {
            "puller": {"kind": "linear", **text, "width": 12.0, "fibre": [_fibre()]},
            "closer": {"kind": "ring", **text, "pair": False, "radii": [20, 10, 12]},
            "lifter": {"kind": "lid", **text, "lid": "upper_raise", "travel": 0.3},
        },
    }


def test_small_rig_is_read():
    """Given values are read, and missing ones have their documented default."""
    rig = read_rig(_document())
    assert rig.tissue == Tissue(tangential=0.5)
    puller, closer, lifter = rig.muscles
    assert isinstance(puller, LinearMuscle)
    assert puller.fibres[0].origin == LandmarkPoint(((45, 0.6), (14, 0.4)), (-4.5, -17.6, -5.6))
    assert isinstance(closer, RingMuscle)
    assert (closer.radii, closer.pair) == ((20.0, 10.0, 12.0), False)
    assert lifter.name == "lifter"


def test_empty_rig_is_plain_tissue():
    """Without a rig file there are no muscles; it is not an error."""
    assert read_rig({}).muscles == ()


def _set(*path, value=None):
    """Set a value at a place of the document; None removes it."""

    def change(document):
        place = document
        for key in path[:-1]:
            place = place[key]
        if value is None:
            del place[path[-1]]
        else:
            place[path[-1]] = value

    return change


RING = {"kind": "ring", "action": "moves", "group": "Group"}
PULLER = ("muscle", "puller")


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (_set("format", value=2), r"'format': was 2, must be one of 1"),
        (_set("muscles", value={}), r"unknown key 'muscles'; did you mean 'muscle'\?"),
        (_set("tissue", "shear", value="soft"), r"'shear': was 'soft', must be a number"),
        (_set("tissue", "sheer", value=1.0), r"unknown key 'sheer'; did you mean 'shear'\?"),
        (_set("jaw", "opening_deg", value=True), r"'opening_deg': was True, must be a number"),
        (_set("jaw", "opening_glide", value=[1, 2]), r"'opening_glide' 3: is missing"),
        (_set("jaw", "seeds", value={"99": 1.0}), r"'99', must be a landmark, 0 to 67"),
        (_set("eyes", value={"gaze_deg": float("nan")}), r"'eyes', 'gaze_deg': was nan"),
        (_set(*PULLER, value=3), r"'muscle', 'puller': was 3, must be a table whose 'kind' is one"),
        (_set(*PULLER, "kind", value="sheet"), r"'kind' is one of linear, ring"),
        (_set(*PULLER, "action"), r"'muscle', 'puller', 'action': is missing"),
        (_set(*PULLER, "pair", value="no"), r"'pair': was 'no', must be true or false"),
        (_set(*PULLER, "with", value=12), r"unknown key 'with'; did you mean 'width'\?"),
        (_set(*PULLER, "width", value=0.0), r"'puller', 'width': was 0.0, must be .* 1 to 60"),
        (_set(*PULLER, "bone", value="maxilla"), r"'bone': was 'maxilla', must be one of cranium"),
        (_set(*PULLER, "radii", value=[1, 1, 1]), r"'puller': unknown key 'radii'\. Allowed: "),
        (_set(*PULLER, "fibre"), r"'puller': a linear muscle needs a"),
        (_set(*PULLER, "fibre", value={}), r"'fibre': was \{\}, must be a list"),
        (_set(*PULLER, "fibre", 0, "origin"), r"'fibre' 1, 'origin': is missing"),
        (
            _set(*PULLER, "fibre", 0, "insertion", "landmarks", value={"54": 1.0}),
            r"'insertion': give exactly one of 'landmark' and 'landmarks'",
        ),
        (
            _set(*PULLER, "fibre", 0, "origin", "landmarks", value={"45": 0.5}),
            r"'origin': the landmark weights add up to 0.5; they must add up to 1",
        ),
        (
            _set(*PULLER, "fibre", 0, "origin", "landmarks", value={}),
            r"'landmarks': is empty, must be a table landmark number = weight",
        ),
        (
            _set(*PULLER, "fibre", 0, "insertion", value={"landmark": "lip"}),
            r"'landmark': was 'lip', must be a whole number from 0 to 67",
        ),
        (_set(*PULLER, "lies_on", value="closer"), r"'lies_on': was 'closer', must be a list"),
        (
            _set(*PULLER, "lies_on", value=["closser"]),
            r"'puller', 'lies_on': there is no muscle 'closser'; did you mean 'closer'\?",
        ),
        (_set(*PULLER, "lies_on", value=["puller"]), r"puller on puller is a circle"),
        (_set(*PULLER, "lies_on", value=["lifter"]), r"'lifter' is a lid, which carries nothing"),
        (
            _set("muscle", "lifter", "lies_on", value=["puller"]),
            r"'lifter', 'lies_on': a lid lies on the eyeball",
        ),
        (_set("muscle", "closer", "radii", value=[0, 1, 1]), r"'closer', 'radii' 1: was 0"),
        (_set("muscle", "Big Muscle", value=RING), r"'Big Muscle': a name is lower case"),
        (_set("muscle", "puller_left", value=RING), r"'puller_left': the side is added by itself"),
    ],
)  # fmt: skip
def test_each_mistake_is_named(change, message):
    """Errors name the place, the value and the allowed values."""
    document = copy.deepcopy(_document())
    change(document)
    with pytest.raises(ValueError, match=message):
        read_rig(document)


def test_persons_share_a_rig():
    """Equal documents give one rig; True, which equals 1 in Python, is refused also after 1."""
    document = {**_document(), "tissue": {"tangential": 1}}
    assert read_rig(document) is read_rig(copy.deepcopy(document))
    document["tissue"]["tangential"] = True
    with pytest.raises(ValueError, match="'tangential': was True"):
        read_rig(document)


def test_built_in_rig_is_complete(head):
    """The face has the muscles of textbooks; every real muscle has its action unit."""
    rig = read_rig(head.rig)
    assert sum(muscle.tone for muscle in rig.muscles) >= 27
    for muscle in rig.muscles:
        assert "AU" in muscle.action or not muscle.tone, muscle.name


def test_points_are_mirrored():
    """A point of the right side uses the mirrored landmark and the mirrored offset."""
    landmarks = np.zeros((68, 3))
    landmarks[54] = (30.0, -60.0, 5.0)
    landmarks[48] = (-30.0, -60.0, 5.0)
    point = LandmarkPoint(((54, 1.0),), (2.0, 3.0, 4.0))
    assert np.array_equal(point.position(landmarks, Side.LEFT), [32.0, -57.0, 9.0])
    assert np.array_equal(point.position(landmarks, Side.RIGHT), [-32.0, -57.0, 9.0])


def test_rig_moves_with_the_head(head):
    """A smile is the same on a head turned, moved and ten times smaller, with a guessed jaw."""
    turn = Rotation.from_euler("y", 30.0, degrees=True).as_matrix()
    plain = without(head, "eyes", "jaw_axis", "mandible_weight")
    other = copy.copy(plain)
    other.vertices = 0.1 * plain.vertices @ turn.T + (5.0, -3.0, 2.0)
    smiles = []
    for face in (plain, other):
        simulation = sim.create(face)
        values = both_sides(simulation, {"zygomaticus_major": 1.0, "jaw_open": 0.3})
        smiles.append(settled_displacement(simulation, values, frames=40))
    assert np.abs(10.0 * smiles[1] @ turn - smiles[0]).max() < 1e-6
    assert moved_landmarks(head, smiles[0], 54)[0] > 3.0
