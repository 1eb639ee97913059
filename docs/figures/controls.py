"""Draw the pictures of docs/controls.md: `python docs/figures/controls.py [FOLDER]`.

One contact sheet for each layer of controls: every action unit, expression, viseme and ARKit shape
at full value, settled and refined, from the front and in three-quarter view. With `--only AU12 joy`
some of them, larger with `--width`, go into some.webp: to judge a row while it is edited.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial

import figures
import numpy as np

from risorius import render
from risorius.app.capture import Capture, CaptureOptions
from risorius.app.capture.cameras import camera_for
from risorius.app.capture.captions import contact_sheet
from risorius.app.files import Image
from risorius.app.scenes import FaceScene, Scene
from risorius.bench.canvas import without_noise

LAYERS = {
    "Action units": "action_units",
    "Expressions": "expressions",
    "Visemes": "visemes",
    "ARKit shapes": "arkit",
}
SHOWN_OVER = {"mouthClose": {"mouthClose": 0.5, "jawOpen": 0.5}}  # a share shows nothing alone
CELL = (150, 168)  # [pixels] of one view
VIEWS = ("0,0,1.7", "-34,3,1.7")  # front and three-quarter
RAISED = 11.0  # [mm] that these look higher than at the landmarks: foreheads wrinkle
FAR_VIEWS = ("0,0,1.1", "-34,3,1.1")  # of a head that turns
COLUMNS = (4, 5, 3)  # from the best to the worst, where all leave as few cells of a row empty
SETTLED = 1.5  # [s] after which a pose stands still


def without_sides(names: Sequence[str]) -> list[str]:
    """The names without the sides of pairs, or with their left sides where no name has both."""
    known = set(names)
    return [
        name
        for name in names
        if not (name.endswith(("_left", "_right")) and name.rpartition("_")[0] in known)
        and not (name.endswith("Right") and f"{name.removesuffix('Right')}Left" in known)
    ]


def columns_for(count: int) -> int:
    """How many columns leave the fewest cells of the last row empty."""
    return min(count, min(COLUMNS, key=lambda columns: -count % columns))


def portrait(capture: Capture, pose: Mapping[str, float]) -> Image:
    """Hold a pose until it stands still; all views of it, side by side."""
    scene = capture.scene
    scene.reset()
    scene.pose(pose)
    scene.step(SETTLED)
    is_turned = not np.allclose(scene.bone_transforms()["cranium"], np.eye(4))
    images = []
    for view in FAR_VIEWS if is_turned else VIEWS:
        capture.camera = camera_for(scene, view)
        if not is_turned:
            capture.camera.target += np.array([0.0, RAISED, 0.0])
        images.append(capture.draw_image())
    return np.concatenate(images, axis=1)


def title_of(scene: Scene, name: str) -> str:
    """What stands below the portrait of a control."""
    title = name.removeprefix("viseme_")
    action = scene.actions.get(name, "").partition(":")[0]
    return f"{title}  {action}" if name[:2] == "AU" else title.replace("_", " ")


def contact_sheet_of(capture: Capture, names: Sequence[str]) -> Image:
    """A labelled portrait of each control at full value."""
    cells = [
        (title_of(capture.scene, name), portrait(capture, SHOWN_OVER.get(name, {name: 1.0})))
        for name in names
    ]
    width = len(VIEWS) * capture.surface.size[0]
    sheet = contact_sheet(cells, columns=columns_for(len(cells)), cell_width=width)
    return without_noise(sheet)


def main(arguments: Sequence[str]) -> None:
    """Draw the contact sheets into the folder given."""
    given = figures.parse(arguments, __doc__, width=CELL[0])
    scene = FaceScene()
    names_by_file = {
        file: without_sides(scene.groups.get(layer, ())) for layer, file in LAYERS.items()
    }
    if given.only:
        names_by_file = {"some": given.only}
    size = given.width, given.width * CELL[1] // CELL[0]
    with Capture(scene, CaptureOptions(size=size, style=render.Style())) as capture:
        figures.draw(
            given.folder,
            {
                file: partial(contact_sheet_of, capture, names)
                for file, names in names_by_file.items()
            },
        )


if __name__ == "__main__":
    figures.run(main)
