"""The pictures of docs/controls.md: `python -m risorius.app.sheet [FOLDER]` draws them anew.

One contact sheet for each layer of controls: every action unit, expression and viseme at full
value, settled and refined, from the front and in three-quarter view. `--only AU12 joy` draws
some of them, larger with `--width`, into sheet.png: to judge a row while it is edited.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np
from PIL import Image

from risorius import render

from .cameras import camera_for
from .errors import run_alone
from .labels import contact_sheet
from .outputs import Frame, check_picture, written_aside
from .parameters import pixels
from .pipeline import Pipeline, texture_of
from .scenes import FaceScene, Scene
from .wrinkling import wrinkling_of

FOLDER = Path("docs/pictures")
TITLES = {"Action units": "action_units", "Expressions": "expressions", "Visemes": "visemes"}
CELL = (150, 168)  # [pixels] of one view: a sheet stays below 1.5 MB
VIEWS = ("0,0,1.7", "-34,3,1.7")  # front and three-quarter
RAISED = 11.0  # [mm] that these look higher than at the landmarks: foreheads wrinkle
FAR_VIEWS = ("0,0,1.1", "-34,3,1.1")  # of a head that turns
COLUMNS = (4, 5, 3)  # from the best to the worst, where all leave as few cells of a row empty
SETTLED = 1.5  # [s] after which a pose stands still
SEEN_BITS = 0xFE  # of a colour; the last bit is noise that would cost a quarter of the bytes


class Studio:
    """An offscreen surface in which a face poses; a context manager."""

    def __init__(self, scene: Scene, size: tuple[int, int]) -> None:
        self.scene = scene
        self.surface = render.open_offscreen(size, samples=4)
        renderer = render.Renderer(self.surface)
        texture, wrinkling = texture_of(scene, renderer), wrinkling_of(scene, renderer)
        self.pipeline = Pipeline(scene, renderer, {"kahler": None}, texture, wrinkling)
        self.near, self.far = (
            [camera_for(scene, view) for view in views] for views in (VIEWS, FAR_VIEWS)
        )
        for camera in self.near:
            camera.target += np.array([0.0, RAISED, 0.0])

    def __enter__(self) -> Studio:
        return self

    def __exit__(self, *_: object) -> None:
        self.surface.close()

    def portrait(self, pose: Mapping[str, float]) -> Frame:
        """Hold a pose until it stands still; all views of it, side by side."""
        self.scene.reset()
        self.scene.pose(pose)
        self.scene.step(SETTLED)
        is_turned = not np.allclose(self.scene.bone_transforms()["cranium"], np.eye(4))
        cameras = self.far if is_turned else self.near
        return np.concatenate([self._seen_by(camera) for camera in cameras], axis=1)

    def _seen_by(self, camera: render.OrbitCamera) -> Frame:
        self.surface.begin()
        width, height = self.surface.size
        self.pipeline.draw(camera, render.Style(), [(0, 0, width, height)])
        self.surface.end()
        return self.surface.read()


def rows_of(names: Sequence[str]) -> list[str]:
    """The names without the sides of pairs: one side looks like half of the whole."""
    known = set(names)
    return [
        name
        for name in names
        if not name.endswith(("_left", "_right")) or name.rpartition("_")[0] not in known
    ]


def columns_for(count: int) -> int:
    """How many columns leave the fewest cells of the last row empty."""
    return min(count, min(COLUMNS, key=lambda columns: -count % columns))


def cells(studio: Studio, names: Sequence[str]) -> Iterator[tuple[str, Frame]]:
    """A labelled portrait of each control at full value."""
    for name in names:
        action = studio.scene.actions.get(name, "").partition(":")[0]
        title = name.removeprefix("viseme_")
        label = f"{title}  {action}" if name[:2] == "AU" else title.replace("_", " ")
        yield label, studio.portrait({name: 1.0})


def save(target: Path, sheet: Frame) -> None:
    """Write a sheet as a small PNG file."""
    with written_aside(target) as part:
        Image.fromarray(sheet & SEEN_BITS).save(part, format="PNG", optimize=True)


def main(arguments: Sequence[str]) -> None:
    """Draw the sheets into the folder given."""
    parser = argparse.ArgumentParser(
        prog="python -m risorius.app.sheet", description=(__doc__ or "").splitlines()[0]
    )
    parser.add_argument("folder", nargs="?", type=Path, default=FOLDER)
    parser.add_argument("--width", type=pixels, default=CELL[0], help="of one view [pixels]")
    parser.add_argument("--only", nargs="+", metavar="NAME", help="these controls, in sheet.png")
    given = parser.parse_args(arguments)
    scene = FaceScene()
    groups = {file: rows_of(scene.groups.get(title, ())) for title, file in TITLES.items()}
    if given.only:
        groups = {"sheet": given.only}
    for file in groups:
        check_picture(given.folder / f"{file}.png")
    size = given.width, given.width * CELL[1] // CELL[0]
    with Studio(scene, size) as studio:
        for file, names in groups.items():
            portraits = list(cells(studio, names))
            sheet = contact_sheet(
                portraits, columns=columns_for(len(portraits)), cell_width=len(VIEWS) * size[0]
            )
            save(given.folder / f"{file}.png", sheet)


if __name__ == "__main__":
    run_alone(main)
