"""Structures under translucent skin: the user's choice, and the parts that it makes visible.

`AnatomyView` has the choice. `DrawnAnatomy` makes muscles, skull and throat of one face at their
first use. `Dissection` has these, the face's own parts, and the opacity of the skin.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np

from risorius import render
from risorius.assets.fitting.skull import build_skull, neck_sections
from risorius.assets.identities import GLASSES_NAME, HAIR_NAME, MASK_NAME
from risorius.geometry.transforms import moved_points

from ..scenes import Drawable, Face
from ..scenes.bent_part import BentPart, HeadPart, at_rest
from ..scenes.openings import opening_before
from .muscle_bands import Muscles

STRUCTURES = ("muscles", "skull")
SIDE_SIGNS = {"both": 0.0, "left": 1.0, "right": -1.0}  # the subject's side with translucent skin
SKIN_OPACITY = 0.25  # default opacity of the skin
SOFT_PARTS = ("oral_cavity", "gums")  # beginnings of names of parts that line the mouth
OUTER_HAIR = (HAIR_NAME, HAIR_NAME + "_tied")
CUT_LOCKS = 15.0  # [mm]; distance from the cut of a dissection to the locks of hair that are drawn


@dataclass(frozen=True)
class AnatomyView:
    """The structures to show under the skin, the opacity of the skin, and whether to show hair."""

    structures: tuple[str, ...] = ()
    opacity: float = SKIN_OPACITY
    side: str = "both"
    has_hair: bool = True


SKIN_ALONE = AnatomyView()


class Dissection(NamedTuple):
    """The visible parts of a scene besides its skin, including parts seen through the skin."""

    parts: tuple[render.PlacedPart, ...]
    opacity: float = 1.0
    """Opacity of the skin."""
    cut: render.CutPlane | None = None
    """In front of this plane, skin is opaque."""


class DrawnAnatomy:
    """Makes muscles and skull of a face; other scenes have no structures."""

    def __init__(self, scene: Drawable) -> None:
        self._scene = scene
        self._skull: dict[str, Any] = {}
        self._necks: list[Any] | None = None  # None before their first use
        self._muscles: Muscles | None = None
        self._followed = np.empty(0)  # state of the face at the muscles' last change
        self._halves: dict[tuple[float, str], BentPart] = {}  # halves of parts, by the opened side

    def dissect(self, view: AnatomyView, *, has_hair: bool = True) -> Dissection:
        """Return the chosen structures in their current shape, and parts that do not hide them.

        Without structures, only hair, glasses and a mask cast shadows. Light passes through
        translucent skin, so all solid parts cast shadows there.
        """
        has_hair = has_hair and view.has_hair
        scene = self._scene
        face = scene.face
        bones = scene.bone_transforms()
        place = render.PlacedPart.on_bone
        if face is None or not view.structures or view.opacity >= 1.0:
            parts = [
                part for part in scene.parts if has_hair or not part.name.startswith(HAIR_NAME)
            ]
            openings = self._openings()
            placed = []
            for each in parts:
                is_outside = each.name in (*OUTER_HAIR, GLASSES_NAME, MASK_NAME)
                opening = openings.get(opening_before(each.name, each.bone))
                placed.append(place(each, bones, throws_shadow=is_outside, opening=opening))
            return Dissection(tuple(placed))
        structures = [
            place(part, bones, lies_beneath=True, throws_shadow=True)
            for part in self._structures(face, view)
        ]
        stay = [part for part in scene.parts if not part.name.startswith((*SOFT_PARTS, HAIR_NAME))]
        openings = self._openings() if SIDE_SIGNS[view.side] else {}
        others = [
            place(half, bones, throws_shadow=not part.strand_radius, opening=opening)
            for part in (*stay, *self._mouth_linings(view))
            for half, opening in self._with_openings(face, view, part, openings)
        ]
        hair = self._hair_on_opaque_side(face, view) if has_hair else []
        parts_of_hair = [place(part, bones) for part in hair]
        return Dissection(
            (*structures, *others, *parts_of_hair), view.opacity, _cutting_plane(face, view)
        )

    def _structures(self, face: Face, view: AnatomyView) -> list[Any]:
        """Return the chosen structures among throat, bones and muscles."""
        names = ["throat"]
        if "skull" in view.structures:
            names += ["cranium", "mandible", "spine"]
        if "muscles" in view.structures:
            names.append("nose")
        self._skull = self._skull or build_skull(
            face.simulated_head, face.simulation.bones.pivots()
        )
        if self._necks is None:
            self._necks = neck_sections(face.head)
        muscles = [self._muscles_now(face)] if "muscles" in view.structures else []
        return [*self._necks, *(self._skull[name] for name in names), *muscles]

    def _muscles_now(self, face: Face) -> Muscles:
        """Return the muscles; shape them again only if the face has moved."""
        bones = face.bone_transforms()
        sums = face.simulation.controls.sums
        now = np.concatenate([face.simulation.positions, *bones.values()], axis=None)
        now = np.append(now, list(sums.values()))
        if self._muscles is None:
            self._muscles = Muscles.from_face(face)
        elif not np.array_equal(now, self._followed):
            self._muscles.follow(face)
        self._followed = now
        return self._muscles

    def _mouth_linings(self, view: AnatomyView) -> list[HeadPart]:
        """Return the parts that line the mouth, if they can be seen."""
        is_seen = "muscles" in view.structures or SIDE_SIGNS[view.side]
        return [part for part in self._scene.parts if is_seen and part.name.startswith(SOFT_PARTS)]

    def _hair_on_opaque_side(self, face: Face, view: AnatomyView) -> list[BentPart]:
        """Return the hair on the opaque side; none if both sides are translucent."""
        side = SIDE_SIGNS[view.side]
        parts = [part for part in self._scene.parts if side and part.name.startswith(HAIR_NAME)]
        return [self._half(face, part, side) for part in parts]

    def _half(self, face: Face, part: HeadPart, side: float) -> BentPart:
        """Return the half of a part that is not on `side`, in its current shape."""
        if (side, part.name) not in self._halves:
            aside = part.vertices[part.faces, 0].mean(axis=1) - _midline_point(face)[0]
            # Locks near the cut would float above the skull of the other side.
            is_lock = part.name.startswith(HAIR_NAME) and part.strand_radius > 0.0
            least = CUT_LOCKS if is_lock else 0.0
            half = replace(at_rest(part), faces=part.faces[side * aside < -least])
            self._halves[side, part.name] = BentPart(half)
        self._halves[side, part.name].copy_shape(part)
        return self._halves[side, part.name]

    def _openings(self) -> dict[str, render.Opening]:
        """Return the current openings of the skin by name."""
        rims = self._scene.rims(render.Opening.RIM_POINTS)
        return {name: render.Opening(*rim) for name, rim in rims.items()}

    def _with_openings(
        self, face: Face, view: AnatomyView, part: HeadPart, openings: Mapping[str, render.Opening]
    ) -> list[tuple[HeadPart, render.Opening | None]]:
        """Return a part, or its two halves on opaque and translucent sides, with their openings.

        An opening limits the light on a part. If only bones are shown, parts that line the mouth
        are left out on the translucent side.
        """
        opening = openings.get(opening_before(part.name, part.bone))
        if opening is None:
            return [(part, None)]
        side = SIDE_SIGNS[view.side]
        lit = self._half(face, part, side), opening
        halves: list[tuple[HeadPart, render.Opening | None]] = [lit]
        if "muscles" in view.structures or not part.name.startswith(SOFT_PARTS):
            halves.append((self._half(face, part, -side), None))
        return [half for half in halves if len(half[0].faces)]


def _midline_point(face: Face) -> Any:
    """Return a point of the midline at rest, shape (3,)."""
    return face.rest_positions[face.head.landmarks[27]]


def _cutting_plane(face: Face, view: AnatomyView) -> render.CutPlane | None:
    """Return the plane in front of which skin is opaque; None if both sides are translucent."""
    side = SIDE_SIGNS[view.side]
    if not side:
        return None
    bone = face.bone_transforms()["cranium"]
    at = moved_points(bone, _midline_point(face))
    normal = bone[:3, :3] @ (-side, 0.0, 0.0)
    return (*normal, -float(normal @ at))
