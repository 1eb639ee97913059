"""The search of the Face panel: words of the trade and everyday words find controls."""

import pytest

from risorius.app.scenes import FaceScene
from risorius.app.viewer.panels.face import rows_of, search_rows
from risorius.app.viewer.session.document import SceneControls


def groups_found(scene: FaceScene, words: str) -> set[str]:
    """The groups in which a search finds all rows."""
    found = set()
    values = scene.limits.pose({})
    for title, names in SceneControls(scene).groups.items():
        rows = rows_of(tuple(names), values, linked=True)
        if len(search_rows(rows, words, group=title, actions=scene.actions)) == len(rows):
            found.add(title)
    return found


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
    """An animator's word for a kind of control shows all of that kind."""
    assert group in groups_found(scene, words)


def test_other_words_do_not(scene):
    """A word of no meaning finds nothing."""
    assert not groups_found(scene, "carburettor")
