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
from risorius.assets.identities import HAIR
from risorius.assets.skull import build_skull
from risorius.assets.throat import build_throat

from ..scenes import Scene
from .muscle_bands import Muscles

SOLIDS = ("muscles", "skull")
SIDES = {"both": 0.0, "left": 1.0, "right": -1.0}  # the subject's, whose skin is translucent
OPACITY = 0.25  # of the skin unless told
SOFT = ("oral_cavity", "gums")  # parts that line the mouth, by how their names begin


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
        self._throat: list[Any] = []
        self._muscles: Muscles | None = None
        self._followed = np.empty(0)  # what they were shaped by
        self._halves: dict[tuple[float, str], Any] = {}  # of parts, by the side that is opened
        self.parts: list[Any] = []  # what is drawn under the skin
        self._solid_count = 0  # how many of them, the first, no skin leaves bare

    def follow(self, dissection: Dissection) -> None:
        """Take what is asked for as it is now, and the head's parts that do not hide it."""
        scene, wanted = self._scene, dissection.solids
        if not dissection.is_on(scene):
            return
        names = ["cranium", "mandible", "spine"] * ("skull" in wanted) + ["nose"] * (
            "muscles" in wanted
        )
        missing = [name for name in names if name not in self._skull]
        self._skull |= build_skull(scene.head, scene.simulation.pivots(), missing)
        if "muscles" in wanted:
            self._follow_muscles()
        self._throat = self._throat or build_throat(scene.head, scene.simulation.pivots())
        solid = self._throat + [self._skull[name] for name in names]
        solid += [self._muscles] * ("muscles" in wanted)
        stay = [part for part in scene.parts if not part.name.startswith((*SOFT, HAIR))]
        self.parts = solid + stay + self._soft(dissection)
        self._solid_count = len(solid)

    def _soft(self, dissection: Dissection) -> list[Any]:
        """What lines the mouth; where there are bones alone, only on the side that is whole."""
        parts = [part for part in self._scene.parts if part.name.startswith(SOFT)]
        side = SIDES[dissection.side]
        if "muscles" in dissection.solids or not side:
            return parts * ("muscles" in dissection.solids)
        for part in parts:
            if (side, part.name) not in self._halves:
                aside = part.vertices[part.faces, 0].mean(axis=1) - self._middle[0]
                self._halves[side, part.name] = replace(part, faces=part.faces[side * aside < 0.0])
        return [self._halves[side, part.name] for part in parts]

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

    @property
    def _middle(self) -> Any:
        """Where the midline is at rest, shape (3,)."""
        return self._scene.rest_positions[self._scene.head.landmarks[27]]

    def _cut(self, dissection: Dissection) -> tuple[float, float, float, float] | None:
        """The plane in front of which the skin is whole; None: there is none."""
        side = SIDES[dissection.side]
        if not side:
            return None
        bone = self._scene.bone_transforms()["cranium"]
        at = bone[:3, :3] @ self._middle + bone[:3, 3]
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
            hair = [
                part for part in self._scene.parts if getattr(part, "name", "").startswith(HAIR)
            ]
            if hair and style.shadows:
                renderer.cast_shadows(hair, bones, camera, style, stream=stream, **where)
            renderer.draw_mesh(stream, camera, style, **skin, **where)
            # After the mesh: the skin throws its shadow on eyes and teeth.
            renderer.draw_parts(self._scene.parts, bones, camera, style, **where)
            return
        if style.shadows:
            solid = [part for part in self.parts if not getattr(part, "hair", 0.0)]
            renderer.cast_shadows(solid, bones, camera, style, **where)
        cut, count = self._cut(dissection), self._solid_count
        hairs = [part for part in self.parts if getattr(part, "hair", 0.0)]
        others = [part for part in self.parts[count:] if not getattr(part, "hair", 0.0)]
        renderer.draw_parts(self.parts[:count], bones, camera, style, cut=cut, **where)
        renderer.draw_parts(others, bones, camera, style, **where)
        over = replace(style, opacity=dissection.opacity)
        renderer.draw_mesh(stream, camera, over, cut=cut, **skin, **where)
        renderer.draw_parts(hairs, bones, camera, style, **where)  # they blend with what is there
