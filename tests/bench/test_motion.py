"""Scores of motion for artificial references of known motion, with all spellings of names."""

from typing import Any

import numpy as np
import pytest
from numpy.linalg import norm

from risorius import assets, sim
from risorius.app.errors import UserError
from risorius.bench.motion import MotionRow, blobs_of, measure, report, targets
from tests.heads import METRES_PER_MILLIMETRE, SHIFT_VECTOR, TURN_MATRIX, shape, user_head
from tests.sim.poses import settled_displacement

# Scored fields: each name in a reference -> the controls with the same motion on the built-in head.
KNOWN_WEIGHTS = {
    "jawOpen": {"jawOpen": 1.0},
    "JawForward": {"jawForward": 1.0},
    "jawLeft": {"jaw_sideways": 1.0},
    "MouthRight": {"mouthRight": 1.0},
    "mouthRollLower": {"mouthRollLower": 1.0},
    "cheekPuff": {"cheekPuff": 1.0},
    "browInnerUp": {"browInnerUp": 1.0},
    "eyeBlink_L": {"orbicularis_oculi_palpebral_upper_left": 1.0},
    "EyeWideLeft": {"levator_palpebrae_left": 1.0},
    "mouthDimple": {"mouthDimpleLeft": 1.0, "mouthDimpleRight": 1.0},
    "cheekRaiser": {"cheekSquintLeft": 1.0, "cheekSquintRight": 1.0},
}


@pytest.fixture(scope="module")
def scored(tmp_path_factory: pytest.TempPathFactory) -> tuple[dict[str, MotionRow], list[str]]:
    """Scores of the built-in motion carried to a head with another shape, unit and orientation."""
    head = assets.load("head")
    simulation = sim.create(head)

    def field(moved):
        changed = (shape(head.vertices + moved) - shape(head.vertices)) @ TURN_MATRIX.T
        return changed * METRES_PER_MILLIMETRE

    fields = {
        name: field(settled_displacement(simulation, values))
        for name, values in KNOWN_WEIGHTS.items()
    }
    closed = settled_displacement(simulation, {"jaw_open": 1.0, "lips_closed": 1.0})
    fields["mouthClose"] = field(closed - settled_displacement(simulation, {"jaw_open": 1.0}))
    folder = tmp_path_factory.mktemp("reference")
    np.savez(
        folder / "face.npz",
        vertices=shape(head.vertices) @ TURN_MATRIX.T * METRES_PER_MILLIMETRE + SHIFT_VECTOR,
        triangles=head.faces,
        landmarks68=head.landmarks,
        earWiggle=fields["jawOpen"],
        eyeBlinkRight=np.zeros_like(head.vertices),
        **fields,
    )
    rows, left_out = measure(folder)
    return {row.shape: row for row in rows}, left_out


@pytest.mark.slow
def test_own_motion_is_known_again(scored):
    """The built-in head's motion, carried to another head, nearly equals each original."""
    rows, left_out = scored
    assert set(rows) == {*KNOWN_WEIGHTS, "mouthClose", "eyeBlinkLeft"} - {"eyeBlink_L"}
    assert left_out == ["earWiggle", "eyeBlinkRight"]  # an unknown name, and a field without motion
    cosines = {name: row.cosine for name, row in rows.items()}
    # The built-in head has its own mandible; on another head the mandible is guessed from
    # landmarks.
    jaw_cosine = cosines["jawOpen"]
    assert jaw_cosine > 0.82, cosines
    assert all(cosine > 0.9 for name, cosine in cosines.items() if name != "jawOpen"), cosines
    assert np.mean(list(cosines.values())) > 0.96
    for name, row in rows.items():
        is_guessed = name in ("jawOpen", "mouthClose")  # these use the guessed mandible
        assert 0.8 < row.magnitude < (1.5 if is_guessed else 1.25), name
        assert row.residual < (0.6 if is_guessed else 0.25), name


def held_to(*rows):
    """The targets missed by these rows beside a correct shape."""
    sound = MotionRow("jawOpen", 0.99, 1.0, 0.02, 0.5)
    return [target.text for target in targets([sound, *rows], []) if not target.is_met]


def test_a_shape_below_its_blob_is_missed():
    """A shape misses its target if a smooth bump is nearer to the scan, by direction or by size."""
    assert held_to() == []
    assert held_to(MotionRow("mouthLeft", 0.95, 1.0, 0.1, 0.9)) == []
    (astray,) = held_to(MotionRow("eyeWide", 0.95, 1.0, 0.1, 0.96))
    assert astray.startswith("residual beside its blob, eyeWide: 0.1, at most 0.078")
    (too_far,) = held_to(MotionRow("mouthShrugUpper", 0.98, 2.8, 3.35, 0.7))
    assert too_far.startswith("residual beside its blob, mouthShrugUpper: 3.35, at most 0.51")
    assert len(held_to(MotionRow("mouthLeft", np.nan, 1.0, np.nan, 0.9))) > 1


def test_the_blob_stands_beside_each_shape():
    """The last column has each shape's score of the smooth bump, and the mean of these scores."""
    text = report(
        [MotionRow("jawOpen", 0.95, 1.0, 0.1, 0.901), MotionRow("eyeWide", 0.96, 1.1, 0.1, 0.8)], []
    )
    lines = [line.split() for line in text.splitlines()]
    assert ["shape", "cosine", "magnitude", "residual", "blob"] in lines
    assert [line[-1] for line in lines if line[:1] in (["jawOpen"], ["mean"])] == ["0.901", "0.851"]


def test_a_bump_is_known_as_a_blob(head):
    """A bump on one side, or bumps on both, nearly equal one of the measure's smooth bumps."""
    for corners in (["cheek_left"], ["cheek_left", "cheek_right"]):
        places = head.vertices[[head.anatomy[name] for name in corners]]
        away = norm(head.vertices[:, None] - places, axis=2)
        scanned = np.exp(-((away / 20.0) ** 2)).sum(axis=1)[:, None] * [0.0, 1.0, 0.5]
        size = norm(scanned)
        cosines = [
            float((blob * scanned).sum() / (norm(blob) * size))
            for blob in blobs_of(head.vertices, scanned)
        ]
        assert max(cosines) > 0.99 > min(cosines)


@pytest.fixture(scope="module")
def arrays() -> dict[str, Any]:
    """The arrays of a head that can be fitted, with one field of the right shape."""
    other = user_head()
    return {
        "vertices": other.mesh.vertices,
        "triangles": other.mesh.faces,
        "landmarks68": other.landmarks,
        "jawOpen": np.ones_like(other.mesh.vertices),
    }


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("vertices", None, "has no array 'vertices'"),
        ("triangles", np.full((9, 3), 10**6), "holds no mesh with 68 of its vertices"),
        ("landmarks68", np.arange(3), "holds no mesh with 68 of its vertices"),
        ("jawOpen", np.zeros((3, 3)), "jawOpen must move all vertices"),
        pytest.param("jawOpen", None, "holds none of ARKit's shapes"),
    ],
)
def test_broken_references_are_named(arrays, tmp_path, name, value, message):
    """The message names the file, the array, and the allowed values."""
    changed = {**arrays, name: value}
    np.savez(
        tmp_path / "face.npz", **{key: kept for key, kept in changed.items() if kept is not None}
    )
    with pytest.raises(UserError, match=message):
        measure(tmp_path)


@pytest.mark.parametrize("content", [b"hello", b"PK\x03\x04 cut short", b""])
def test_files_that_hold_no_arrays_are_named(tmp_path, content):
    """A text file and a truncated archive are reported by name, without a traceback."""
    (tmp_path / "face.npz").write_bytes(content)
    with pytest.raises(UserError, match=r"face.npz: is broken, or no file of arrays"):
        measure(tmp_path)
