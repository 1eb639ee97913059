"""Poses by name, each with a small picture: those of a scene, and a user's own in a folder.

A pose of the user's is a script of one pose, as `Save pose ...` of the window writes it.
"""

from __future__ import annotations

import contextlib
from collections.abc import Mapping
from functools import cached_property
from pathlib import Path

from risorius import render

from ..capture import Capture, CaptureOptions
from ..controls.vocabulary import title_of
from ..errors import UserError
from ..files import Image
from ..scenes import FaceScene, Scene
from ..script import is_pose, load_script, pose_script, save_script

SIZE = (150, 150)  # [pixels] of a picture
VIEW = "0,0,1.7"  # the camera
SETTLED = 1.0  # [s] after which a pose stands still
LAYERS = ("Expressions", "Visemes")
OWN = "Pose"  # what the user's own are called, with a number

Values = Mapping[str, float]


class Poses:
    """The poses of one scene; without a folder there are none of the user's own."""

    def __init__(self, scene: Scene, folder: Path | None) -> None:
        self.scene, self._folder = scene, folder
        self.own: dict[str, Values] = {}
        self.read()

    @cached_property
    def built_in(self) -> dict[str, Values]:
        """The scene's expressions and visemes at their most, by their names."""
        scene = self.scene
        names = [name for layer in LAYERS for name in scene.groups.get(layer, ())]
        return {
            _title(name): {name: 1.0} for name in names if not name.endswith(("_left", "_right"))
        }

    def read(self) -> None:
        """Look into the folder; files that are no poses of this scene are passed by."""
        self.own = {}
        for path in sorted(self._folder.glob("*.toml")) if self._folder is not None else ():
            with contextlib.suppress(UserError):
                script = load_script(path)
                script.check(self.scene.limits)
                if is_pose(script) and script.scene == self.scene.name:
                    self.own[path.stem] = script.at(0.0)

    def save(self, values: Values) -> str:
        """Keep a pose in the folder; a line that says where. UserError where that cannot be."""
        if self._folder is None:
            raise UserError("poses are kept beside the settings, and this window has none")
        taken = {path.stem for path in self._folder.glob("*.toml")}
        name = next(f"{OWN} {n}" for n in range(1, len(taken) + 2) if f"{OWN} {n}" not in taken)
        self._folder.mkdir(parents=True, exist_ok=True)
        script = pose_script(values, title=name, scene=self.scene.name)
        save_script(self._folder / f"{name}.toml", script)
        self.read()
        return f"{name} is kept in {self._folder}"

    @cached_property
    def _capture(self) -> Capture:
        """The same head once more, which is posed where nobody sees it."""
        assert isinstance(self.scene, FaceScene)
        return Capture(self.scene.twin(), CaptureOptions(size=SIZE, camera=VIEW))

    def picture(self, values: Values) -> Image:
        """The face as it comes to rest in a pose, shape (H, W, 3).

        Another context of OpenGL than the caller's is current afterwards. UserError where there is
        no second one.
        """
        try:
            capture = self._capture
        except render.GLError as error:
            raise UserError(f"no pictures of poses: {error}") from None
        capture.surface.make_current()
        capture.scene.reset()
        capture.scene.pose(values)
        capture.scene.step(SETTLED)
        return capture.draw_image()

    def close(self) -> None:
        """Give back what pictures were drawn with."""
        if "_capture" in vars(self):
            self._capture.surface.make_current()
            self._capture.surface.close()
            del self._capture


def _title(name: str) -> str:
    """What is read on a picture: of a viseme the sound."""
    code, plain = title_of(name)
    return code or plain
