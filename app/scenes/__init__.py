"""Scenes to animate: the built-in head with its muscles, or the paper's plane (Fig. 9).

A scene has a triangle mesh whose topology never changes, and moves its vertices as time passes. It
is independent of refinement and drawing. `build_scene` makes a scene by its name. Read drawable.py
(a visible mesh) first, then scene.py (a mesh that controls move), then each kind of scene.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

from risorius import assets, sim
from risorius.assets.coarse import COARSE_NAME, coarse_head
from risorius.assets.fitting import FittedHead, fit_head
from risorius.assets.identities import person_called, person_in_words

from ..control_names.limits import Limits
from ..errors import UserError
from .drawable import NO_IMAGES, Drawable, Framing, SkinImages
from .face import BUILT_IN, OWN_HEAD, FaceScene
from .face_under_skin import Face
from .plane import PlaneScene
from .scene import Scene

__all__ = [
    "BUILT_IN",
    "COARSE_NAME",
    "NO_IMAGES",
    "OWN_HEAD",
    "SCENES",
    "Drawable",
    "Face",
    "FaceScene",
    "Framing",
    "PlaneScene",
    "Scene",
    "SkinImages",
    "build_face",
    "build_scene",
    "called_head",
    "controls_of",
    "fit_users_head",
    "head_in_words",
]

HEAD_LOG = logging.getLogger("risorius.heads")  # reports changes of a user's head


@dataclass(frozen=True)
class ControlTable:
    """The controls of a scene: their headings, limits and effects."""

    groups: Mapping[str, tuple[str, ...]]
    limits: Limits
    actions: Mapping[str, str]


def controls_of(scene: str) -> ControlTable:
    """Return the controls of the scene with this name, without building and compiling it."""
    if scene == PlaneScene.name:
        return ControlTable(PlaneScene.groups, PlaneScene.limits, PlaneScene.actions)
    controls = sim.controls_of(assets.load("head"))
    return ControlTable(controls.groups, Limits(controls.limits), controls.actions)


SCENES: dict[str, Callable[[], Scene]] = {
    "face": FaceScene,
    "plane": PlaneScene,
}


def build_scene(name: str, head: FittedHead | None = None) -> Scene:
    """Build the scene called `name`; raises UserError if `head` is given for a headless scene."""
    if head is None:
        return SCENES[name]()
    if name != "face":
        raise UserError(f"--head needs the scene face; the scene is '{name}'")
    return build_face(head)


def build_face(head: FittedHead | None = None) -> FaceScene:
    """Build a face, by default of the built-in head; raises UserError if it cannot be simulated."""
    try:
        return FaceScene(head)
    except ValueError as error:
        raise UserError(f"this head cannot be simulated: {error}") from None


def fit_users_head(head: Path, landmarks: Path | None) -> FittedHead:
    """Fit the user's own head. landmarks: None for a known topology."""
    fitted = fit_head(head, landmarks)
    for note in fitted.notes:
        HEAD_LOG.warning("risorius: %s: %s", head, note)
    return fitted


def called_head(who: int | str) -> FittedHead:
    """Return a person, given by number or name, or the coarse head."""
    return coarse_head() if who == COARSE_NAME else person_called(who)


def head_in_words(who: int | str) -> str:
    """Describe a head, given by its number or name, for lists."""
    return "Coarse head" if who == COARSE_NAME else person_in_words(who)
