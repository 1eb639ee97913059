"""Fine shape of the skin: in comparisons, in passes, and on persons."""

from dataclasses import replace

import numpy as np

from risorius import render
from risorius.app.capture import Capture, CaptureOptions
from risorius.app.passes.passes import Passes
from risorius.app.refining.presets import Refinement

SIZE = (400, 300)


def images(scene):
    """Static beside refined, with maps and without, (2, H, W, 3); normals with maps, too."""
    scene.reset()
    options = CaptureOptions(
        size=SIZE, camera="0,0,0.8", beside=(Refinement(refiner="none"),), captions=False
    )
    with Capture(scene, options) as capture:
        found = []
        normals = []
        for is_on in (True, False):
            capture.options = replace(options, style=render.Style(skin_maps=is_on))
            found.append(capture.draw_image().astype(np.int32))
            passes = Passes(capture.pipeline, capture.viewports[-1].drawn)
            found_passes = passes.draw(capture.camera, capture.options.style, ("normal",))
            normals.append(found_passes["normal"])
    return np.stack(found), np.stack(normals)


def test_both_sides_wear_it(scene):
    """Maps change static and refined skin equally, and normals of passes; the background stays."""
    (shown, plain), normals = images(scene)
    changed = np.abs(shown - plain).max(axis=2) > 3
    static, refined = (half.mean() for half in np.split(changed, 2, axis=1))
    assert 0.07 < static < 0.9
    assert abs(static - refined) < 0.03
    assert not changed[:8].any()
    assert 0.05 < (np.abs(normals[0] - normals[1]).max(axis=2) > 0.02).mean() < 0.9
