"""Parts in the mouth: the farther back, the darker."""

from risorius.app.scenes.mouth import shaded_mouth


def test_a_mouth_gets_darker_toward_the_back(face):
    """Molars lose more than incisors, eyes nothing."""
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
    assert blue < 0.72 and blue < 0.92 * red  # grey ones look like one broken tooth
    tongue = next(part for part in shown if part.name == "tongue")
    light = tongue.colours.mean(axis=1)
    depth = tongue.vertices[:, 2]
    assert light[depth.argmin()] < 0.6 * light[depth.argmax()]
    assert shaded_mouth(()) == ()
