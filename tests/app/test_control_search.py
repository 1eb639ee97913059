"""The search of the Face panel: technical and everyday words find controls."""

from collections.abc import Iterator

import pytest

from risorius.app.scenes import FaceScene
from risorius.app.viewer.panels.face import ControlRow, rows_of, search_rows
from risorius.app.viewer.session.document import SceneControls


def rows_found(
    scene: FaceScene, words: str
) -> Iterator[tuple[str, list[ControlRow], list[ControlRow]]]:
    """For each group, the rows that a search finds and all its rows."""
    values = scene.limits.pose({})
    for title, names in SceneControls(scene).groups.items():
        rows = rows_of(tuple(names), values, linked=True)
        yield title, search_rows(rows, words, group=title, actions=scene.actions), rows


def groups_found(scene: FaceScene, words: str) -> set[str]:
    """The groups of which a search finds all rows."""
    return {title for title, found, rows in rows_found(scene, words) if found == rows}


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        ("smile", {"joy", "AU12", "mouthSmile", "zygomaticus_major"}),
        ("frown", {"anger", "AU4", "mouthFrown", "corrugator_supercilii"}),
        ("chew", {"AU26", "jawOpen", "jaw_open"}),
    ],
)
def test_plain_words_find_controls(scene, words, expected):
    """Everyday words find expressions, units, shapes and muscles, and few other rows."""
    labels = {row.label for _, found, _ in rows_found(scene, words) for row in found}
    assert expected <= labels and len(labels) < 20


@pytest.mark.parametrize(
    ("words", "group"),
    [
        ("blendshape", "ARKit shapes"),
        ("shape keys", "ARKit shapes"),
        ("morph target", "ARKit shapes"),
        ("ARKit", "ARKit shapes"),
        ("viseme", "Visemes"),
        ("lip sync", "Visemes"),
        ("AU", "Action units"),
        ("FACS", "Action units"),
        ("emotion", "Expressions"),
    ],
)
def test_words_of_the_trade_find_a_group(scene, words, group):
    """An animator's word for a kind of control finds all controls of that kind."""
    assert group in groups_found(scene, words)


def test_other_words_do_not(scene):
    """A meaningless word finds nothing."""
    assert not groups_found(scene, "carburettor")
