"""Draw the pictures of docs/controls.md: `python docs/figures/controls.py [FOLDER]`.

One contact sheet for each layer of controls: every action unit, expression, viseme and ARKit shape
at full value, settled and refined, from the front and in three-quarter view.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import figures
import numpy as np

from risorius.app.capture import CaptureOptions
from risorius.app.pictures import Image
from risorius.app.scenes import FaceScene, Scene

LAYER_PICTURES = {  # file -> the layer, and a number of columns that fills the last row
    "action_units": ("Action units", 4),
    "expressions": ("Expressions", 4),
    "visemes": ("Visemes", 5),
    "arkit": ("ARKit shapes", 4),
}


def without_sides(names: Sequence[str]) -> list[str]:
    """The names without sides of pairs, or with left sides if no name stands for both."""
    kept = []
    for name in names:
        if name.endswith(("_left", "_right")) and name.rpartition("_")[0] in names:
            continue  # a name stands for both sides
        if name.endswith("Right") and f"{name.removesuffix('Right')}Left" in names:
            continue
        kept.append(name)
    return kept


def portrait(scene: Scene, name: str, size: tuple[int, int]) -> Image:
    """All views of a control at full value, side by side."""
    turning_units = ("AU51", "AU52", "AU53", "AU54", "AU55", "AU56")
    is_turned = name.removesuffix("_left") in turning_units
    raised = 11.0  # [mm] of the view above the landmarks, because foreheads wrinkle
    target = None if is_turned else scene.framing.focus + np.array([0.0, raised, 0.0])
    pose = {name: 1.0}
    if name == "mouthClose":  # over a closed mouth it shows nothing
        pose = {"mouthClose": 0.5, "jawOpen": 0.5}
    zoom = 1.1 if is_turned else 1.7
    images = []
    for view in (f"0,0,{zoom}", f"-34,3,{zoom}"):  # front and three-quarter
        options = CaptureOptions(size, camera=view)
        images.append(figures.shoot(scene, pose, options, target))
    return np.concatenate(images, axis=1)


def title_of(scene: Scene, name: str) -> str:
    """The text below the portrait of a control."""
    title = name.removeprefix("viseme_")
    action = scene.actions.get(name, "").partition(":")[0]
    return f"{title}  {action}" if name[:2] == "AU" else title.replace("_", " ")


def layer(title: str, columns: int, size: tuple[int, int] = (150, 168)) -> Image:
    """A labelled portrait of each control of a layer."""
    scene = FaceScene()
    names = without_sides(scene.groups[title])
    cells = [(title_of(scene, name), portrait(scene, name, size)) for name in names]
    return figures.sheet(cells, columns)


if __name__ == "__main__":
    figures.run(
        __doc__, {file: partial(layer, *layer_of) for file, layer_of in LAYER_PICTURES.items()}
    )
