"""What lies under the skin, drawn through it: muscles and skull, as solids.

`Dissection` says what is asked for; `Solids` has the parts of one face, made when they are first
asked for, and draws them, the face's own parts, and the skin over them.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from risorius import render
from risorius.assets.skull import build_skull

from .muscle_bands import Muscles
from .scenes import Scene

SOLIDS = ("muscles", "skull")
SIDES = {"both": 0.0, "left": 1.0, "right": -1.0}  # the subject's, whose skin is translucent
OPACITY = 0.25  # of the skin unless told
SOFT = ("oral_cavity", "gums")  # parts that hide muscles and skull, by how their names begin


@dataclass(frozen=True)
class Dissection:
    """What is shown under the skin, and how much of the skin."""

    solids: tuple[str, ...] = ()
    opacity: float = OPACITY
    side: str = "both"

    def is_on(self, scene: Scene) -> bool:
        """Whether anything is seen under the skin of this scene."""
        return bool(self.solids) and self.opacity < 1.0 and hasattr(scene, "simulation")


class Solids:
    """Muscles and skull of a face; of other scenes there is the skin alone."""

    def __init__(self, scene: Any) -> None:
        self._scene = scene
        self._skull: dict[str, Any] = {}
        self._muscles: Muscles | None = None
        self._followed = np.empty(0)  # what they were shaped by
        self.parts: list[Any] = []  # what is drawn under the skin

    def follow(self, dissection: Dissection) -> None:
        """Take what is asked for as it is now, and the head's parts that do not hide it."""
        scene, wanted = self._scene, dissection.solids
        if not dissection.is_on(scene):
            return
        names = ["cranium", "mandible"] * ("skull" in wanted) + ["nose"] * ("muscles" in wanted)
        missing = [name for name in names if name not in self._skull]
        self._skull |= build_skull(scene.head, scene.simulation.pivots(), missing)
        if "muscles" in wanted:
            self._follow_muscles()
        stay = [part for part in scene.parts if not part.name.startswith(SOFT)]
        shown = [self._skull[name] for name in names]
        self.parts = stay + shown + [self._muscles] * ("muscles" in wanted)

    def _follow_muscles(self) -> None:
        """Shape the muscles, unless nothing has moved: a camera that turns is no reason."""
        scene = self._scene
        bones, sums = scene.bone_transforms(), scene.simulation.sums
        now = np.concatenate([scene.positions, *bones.values()], axis=None)
        now = np.append(now, list(sums.values()))
        if self._muscles is None:
            self._muscles = Muscles.of(scene)
        elif not np.array_equal(now, self._followed):
            self._muscles.follow(scene)
        self._followed = now

    def _cut(self, dissection: Dissection) -> tuple[float, float, float, float] | None:
        """The plane in front of which the skin is whole; None: there is none."""
        side = SIDES[dissection.side]
        if not side:
            return None
        bone = self._scene.bone_transforms()["cranium"]
        at = bone[:3, :3] @ self._scene.rest_positions[self._scene.head.landmarks[27]] + bone[:3, 3]
        normal = bone[:3, :3] @ (-side, 0.0, 0.0)
        return (*normal, -float(normal @ at))

    def draw(
        self,
        renderer: render.Renderer,
        stream: render.Stream,
        camera: render.OrbitCamera,
        style: render.Style,
        dissection: Dissection,
        *,
        where: Mapping[str, Any],
        skin: Mapping[str, Any],
    ) -> None:
        """Draw what `follow` took, lit as if there were no skin, and the skin over it.

        Where nothing is asked for, the skin and the scene's parts.
        where: viewport and clip; skin: what else `Renderer.draw_mesh` is told.
        """
        bones = self._scene.bone_transforms()
        if not dissection.is_on(self._scene):
            renderer.draw_mesh(stream, camera, style, **skin, **where)
            # After the mesh: the skin throws its shadow on eyes and teeth.
            renderer.draw_parts(self._scene.parts, bones, camera, style, **where)
            return
        if style.shadows:
            solid = [part for part in self.parts if not getattr(part, "hair", 0.0)]
            renderer.cast_shadows(solid, bones, camera, style, **where)
        renderer.draw_parts(self.parts, bones, camera, style, **where)
        over = replace(style, opacity=dissection.opacity)
        renderer.draw_mesh(stream, camera, over, cut=self._cut(dissection), **skin, **where)
