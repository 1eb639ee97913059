"""A finger on the skin, without a window: it sets the muscles that the user means."""

import numpy as np
import pytest

from risorius.app.viewer.picture.skin import SkinDrag
from risorius.app.viewer.settings import Settings
from tests.app.driving import run

SIGHT = np.array([0.0, 0.0, -1.0])  # from the front


@pytest.mark.parametrize(
    ("landmarks", "up", "wanted", "unwanted"),
    [
        ((43, 44), 3.0, "levator_palpebrae", "palpebral_lower"),
        ((57,), -8.0, "lower", "upper"),
        ((51,), 5.0, "peripheral_upper", "roll_lower"),
        ((50,), 5.0, "levator_labii_superioris", "roll_lower"),
        ((8,), -15.0, "jaw_open", "jaw_forward"),
        ((8,), -8.0, "jaw_open", "depressor_labii"),
    ],
)
def test_a_finger_sets_what_draws_its_skin(session, landmarks, up, wanted, unwanted):
    """The lip or lid beyond an opening stays, and no control works against the finger.

    The finger pulled skin within 16 mm through the air. So a pull at an upper lid tensed the lower
    one, and a pull at a lower lip rolled in the upper one. A pull at the chin also thrust the jaw
    forward, which lifts the chin, or lowered the lip instead of the jaw.
    """
    scene = session.scene
    place = scene.positions[scene.landmarks[list(landmarks)]].mean(axis=0)
    finger = SkinDrag(session, Settings(), place, SIGHT, poses=True)
    finger.drag_to(place + np.array([0.0, up, 0.0]))
    finger.release()
    found = {name for name, value in session.values.items() if value}
    assert any(wanted in name for name in found)
    assert not [name for name in found if unwanted in name]
    before = scene.positions[scene.landmarks[list(landmarks)]].mean(axis=0)
    run(session, 60)
    moved = scene.positions[scene.landmarks[list(landmarks)]].mean(axis=0) - before
    assert moved[1] / up > 0.8


@pytest.mark.parametrize("height", [0.65, 0.75])
def test_a_cheek_that_is_lifted_leaves_lid_and_nose(session, height):
    """Muscles of other skin are not used, although they move skin at the finger's rim.

    A pull at the cheek below the lid also lifted the lower lid with full force, or wrinkled the
    nose. height: 0 at the corner of the mouth, 1 at the lid.
    """
    positions = session.scene.positions
    lid, corner = (positions[session.scene.landmarks[k]].mean(axis=0) for k in ([46, 47], [54]))
    aim = height * lid + (1.0 - height) * corner
    aside = np.linalg.norm((positions - aim)[:, :2], axis=1)
    place = positions[np.where(positions[:, 2] > aim[2] - 25.0, aside, np.inf).argmin()]
    finger = SkinDrag(session, Settings(), place, SIGHT, poses=True)
    finger.drag_to(place + np.array([0.0, 4.0, 0.0]))
    finger.release()
    found = {name for name, value in session.values.items() if value}
    assert "orbicularis_oculi_orbital_left" in found
    assert not [name for name in found if "palpebral" in name or "labii" in name]
