"""Parts in the mouth: those farther back are darker."""

import numpy as np

from risorius.app.scenes.mouth import shaded_mouth
from tests.assets.checks import part_of


def test_a_mouth_gets_darker_toward_the_back(face):
    """Molars are darkened more than incisors, and eyes not at all."""
    head = face.head.parts
    shown = face.parts
    for given, drawn in zip(head, shown, strict=False):
        if given.name.startswith("eye"):
            assert drawn is given
        elif given.name.startswith("teeth"):
            left = (drawn.colours / given.colours).mean(axis=1)
            assert left[given.vertices[:, 2].argmax()] > 0.9
            assert left[given.vertices[:, 2].argmin()] < 0.85
    lower = {part.name: part.colours for part in shown}["teeth_lower"]
    given = {part.name: part for part in head}["teeth_lower"]
    red, _, blue = (lower / given.colours)[given.vertices[:, 2].argmin()]
    assert blue < 0.72 and blue < 0.92 * red  # grey edges would look like a broken tooth
    tongue = next(part for part in shown if part.name == "tongue")
    light = tongue.colours.mean(axis=1)
    depth = tongue.vertices[:, 2]
    assert light[depth.argmin()] < 0.6 * light[depth.argmax()]
    assert shaded_mouth(()) == ()


def test_a_tongue_has_a_groove_a_pale_coat_and_red_edges(face):
    """The tongue has a groove, a pale coat and red edges, instead of a single tone."""
    tongue = part_of(face, "tongue")
    rest = part_of(face.head, "tongue")
    depth = rest.vertices[:, 2].max() - rest.vertices[:, 2]
    rows = (depth > 8.0) & (depth < 30.0) & (rest.normals[:, 1] > 0.7)
    beside = np.abs(rest.vertices[:, 0])
    groove = rows & (beside < 1.0)
    coat = rows & (beside > 3.0) & (beside < 8.0)
    assert tongue.colours[groove].mean() < 0.88 * tongue.colours[coat].mean()
    edge = (depth > 8.0) & (depth < 30.0) & (rest.normals[:, 1] < 0.2)
    ratios = tongue.colours[:, 0] / tongue.colours[:, 1]
    redness = [ratios[edge].mean(), ratios[coat].mean()]
    assert redness[0] > 1.15 * redness[1]
    assert tongue.shine > rest.shine
    assert (tongue.unlit[:, 0] / tongue.unlit[:, 1]).mean() < 1.8  # not too pink
    assert tongue.unlit[:, 0].mean() < 0.68


def test_notches_of_gums_are_not_black(face):
    """Gums between crowns are lighter than in the file, where they are nearly black.

    In the corner of a smile they were dark shapes beside light crowns.
    """
    given = {part.name: part for part in face.head.parts}["gums_upper"]
    drawn = {part.name: part for part in face.parts}["gums_upper"]
    is_dark = given.colours.mean(axis=1) < 0.2
    assert is_dark.sum() > 50
    assert drawn.colours[is_dark].mean() > 1.7 * given.colours[is_dark].mean()
    darkest, lightest = np.percentile(drawn.colours[:, 0], (1, 99))
    assert 0.5 * lightest < darkest < 0.8 * lightest  # notches remain a little darker
