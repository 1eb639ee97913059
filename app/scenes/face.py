"""The face: a head, its simulation and the controls that move it."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from risorius import assets
from risorius.assets.fitting import FittedHead
from risorius.assets.identities import Person, built_in_hair, recoloured, with_lids
from risorius.assets.model import MASK_NAME
from risorius.geometry.arrays import Floats64, Integers32
from risorius.geometry.read_only import read_only

from ..control_names import split_side
from ..control_names.limits import ControlValues, Limits
from .bent_part import FaceNow, FacePart, HeadPart, at_rest
from .drawable import Framing, SkinImages
from .face_under_skin import Face
from .mask import Mask
from .mouth import shaded_mouth
from .openings import Rim, rims_of
from .scene import Scene
from .skin_part import SkinPart

BUILT_IN = "built-in"  # name of the included head
OWN_HEAD = "own"  # name of a user's head
LONGEST_STEP = 1.0 / 60.0  # [s]: longest step of the simulation, at any frame rate


class FaceScene(Scene):
    """A head, moved by muscles, jaw and gaze through the spring simulation."""

    name = "face"
    face: Face

    def __init__(
        self,
        head: assets.Head | FittedHead | None = None,
        face: Face | None = None,
    ) -> None:
        """Simulate `head`, by default the built-in head. face: an existing face of this head."""
        self.head = assets.load("head") if head is None else head
        face = face or Face.from_head(self.head)
        self.simulation = face.simulation
        faces = self.head.faces
        rest = face.rest_positions
        super().__init__(self.name, faces, rest, skin=_images_of(self.head), face=face)
        self.landmarks = self.head.landmarks
        self.called = (
            BUILT_IN if isinstance(self.head, assets.Head) else self.head.called or OWN_HEAD
        )
        self._parts = _parts_of(self.head, rest, faces)
        self._following = [part for part in self._parts if isinstance(part, FacePart)]
        self._are_bent = False  # whether parts have the face's current shape
        self.framing = self._framing()
        controls = self.simulation.controls
        self.groups = controls.groups
        self.limits = Limits(controls.limits)
        self.actions = controls.actions
        whole = controls.layers.get("Expressions", ())
        self.expressions = tuple(
            name for name in whole if split_side(name)[0] not in {*whole} - {name}
        )
        self._moved_by: dict[str, dict[str, float]] = {}
        self.values = self.limits.pose(controls.values)

    def _framing(self) -> Framing:
        """Return points of the head with its hair; a portrait ends below the chin."""
        marks = self.head.vertices[self.landmarks]
        of_hair = [part for part in self._parts if part.striation is not None]
        hair = [part.vertices for part in of_hair if not part.strand_radius]
        extent = read_only(np.vstack([self.rest_positions, *hair]))
        lowest = float(marks[8, 1]) - 32.0  # [mm] below the chin's landmark
        focus = read_only(0.5 * (marks.min(axis=0) + marks.max(axis=0)))
        return Framing(extent, read_only(extent[extent[:, 1] > lowest]), focus)

    def clone(self) -> FaceScene:
        """Return a copy of the face at rest, which moves independently; copying is fast."""
        return FaceScene(self.head, self.face.clone())

    def set_controls(self, values: ControlValues) -> None:
        super().set_controls(values)
        self.simulation.controls.set_array(values.numbers)

    def step(self, seconds: float) -> None:
        count = max(1, math.ceil(seconds / LONGEST_STEP - 1e-9))
        for _ in range(count):
            self.simulation.step(seconds / count)
        self._follow()

    def reset(self) -> None:
        super().reset()
        self.simulation.reset()
        self._follow()

    def _follow(self) -> None:
        """Let skin and parts follow the simulation at their next read."""
        self.face.follow()
        self._are_bent = False

    @property
    def positions(self) -> Floats64:
        return self.face.positions

    @property
    def parts(self) -> tuple[HeadPart, ...]:
        """The parts in their current shape; computed here, because pictures skip some steps."""
        if not self._are_bent:
            self._are_bent = True
            jaw = self.simulation.bones.jaw
            tongue = self.simulation.anatomy.tongue()
            now = FaceNow(self.positions, self.bone_transforms(), jaw, tongue)
            for part in self._following:
                part.follow(now)
        return self._parts

    def rims(self, point_count: int) -> Mapping[str, Rim]:
        return rims_of(self.face.marked, point_count)

    def bone_transforms(self) -> Mapping[str, Floats64]:
        return self.simulation.bones.transforms()

    def moved_by(self, name: str) -> Mapping[str, float]:
        """Return the lowest controls that a control moves at its limit, and their changes."""
        controls = self.simulation.controls
        if name not in self._moved_by:
            at_most = self.limits.pose({name: self.limits[name][1]})
            sums = controls.sums_of(at_most.numbers).tolist()
            amounts = zip(controls.lowest, sums, strict=True)
            self._moved_by[name] = {each: abs(amount) for each, amount in amounts if amount}
        return self._moved_by[name]


def _on_skin(part: HeadPart, rest_positions: Floats64, faces: Integers32) -> HeadPart:
    """Return the part, or for a part on the skin one that follows the skin."""
    if part.name == MASK_NAME:
        return Mask(at_rest(part), rest_positions)
    return part if part.roots is None else SkinPart(at_rest(part), rest_positions, faces)


def _images_of(head: assets.Head | FittedHead) -> SkinImages:
    """Return the images on the skin of a head."""
    is_built_in = isinstance(head, assets.Head)
    person = head if isinstance(head, Person) else None
    in_tone = recoloured if is_built_in else None
    return SkinImages(
        uv=head.uv,
        face_uv=head.face_uv,
        albedo=head.albedo,
        in_tone=person.in_tone if person else in_tone,
        ambient_occlusion=head.ambient_occlusion,
        oil=assets.oil_of(head, person.stubble if person else None),
        fine_shape=head.fine_shape,
        wrinkles=with_lids(head.wrinkles) if is_built_in and head.wrinkles else head.wrinkles,
        fade=head.fade() if isinstance(head, FittedHead) else None,
    )


def _parts_of(
    head: assets.Head | FittedHead,
    rest_positions: Floats64,
    faces: Integers32,
) -> tuple[HeadPart, ...]:
    """Return the parts of a head, some of which can bend, with the built-in head's hair."""
    parts = tuple(_on_skin(part, rest_positions, faces) for part in shaded_mouth(head.parts))
    return (*parts, *built_in_hair(head)) if isinstance(head, assets.Head) else parts
