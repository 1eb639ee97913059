"""What can be animated: the built-in head with its muscles, or the paper's plane (Fig. 9).

A scene owns a triangle mesh whose topology never changes, moves its vertices as time passes, and
knows nothing of refinement or drawing. `build_scene` makes one by its name.
"""

from __future__ import annotations

import logging
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
import numpy.typing as npt

from risorius import assets, sim
from risorius.assets.fitting import FittedHead, fit_head
from risorius.assets.identities import Person, built_in_hair, recoloured
from risorius.geometry.read_only import read_only

from ..control_names import parted
from ..control_names.limits import ControlValues, Limits
from ..errors import UserError
from .mouth import MouthWalls, Tongue, shaded_mouth
from .surface_attachment import SurfaceAttachment

BUILT_IN = "built-in"  # what heads are called: that which comes along, and a user's
OWN = "own"
CHIN = 8  # landmark, and [mm] below it that a portrait shows
NECK = 32.0
LOG = logging.getLogger("risorius.heads")  # changes of a user's head
LONGEST_STEP = 1.0 / 60.0  # [s] the simulation is fed at least at this rate, whatever the film's


class Scene:
    """Anything that moves the vertices of one triangle mesh."""

    name: str
    faces: npt.NDArray[np.int32]
    rest_positions: npt.NDArray[np.float64]
    positions: npt.NDArray[np.float64]  # the vertices now [mm], (V, 3); read only for others
    extent: npt.NDArray[np.float64]  # points that a camera must see to see it all [mm], (n, 3)
    framed: npt.NDArray[np.float64]  # points that fill the frame of a camera [mm], (n, 3)
    focus: npt.NDArray[np.float64]  # where a camera close by looks [mm], shape (3,)
    groups: Mapping[str, tuple[str, ...]]  # all controls, by the heading that a panel shows
    limits: Limits  # of the controls
    values: ControlValues  # what each control is set to
    actions: Mapping[str, str] = MappingProxyType({})  # what controls do, where that is known
    called: str = ""  # whose head it is, if it is one
    expressions: tuple[str, ...] = ()  # whole faces, without those of a side
    uv: npt.NDArray[np.float32] | None = None  # texture coordinates (U, 2)
    face_uv: npt.NDArray[np.int32] | None = None  # which of them each corner has (F, 3)
    albedo: npt.NDArray[np.uint8] | None = None  # the texture (H, W, 3), sRGB
    wrinkles: assets.Wrinkles | None = None  # where skin wrinkles
    fade: tuple[float, float, float, float] | None = None  # see render.Skin
    in_tone: Callable[[float], npt.NDArray[np.uint8]] | None = None  # the texture by ITA [deg]
    ambient_occlusion: npt.NDArray[np.uint8] | None = None  # over the texture (H, W), or all open
    fine_shape: assets.FineShape | None = None  # what its triangles do not hold of the skin

    @property
    def parts(self) -> tuple[Any, ...]:
        """What moves with bones or the skin, as it is now: eyes, teeth, lashes, ..."""
        return ()

    def pose(self, channels: Mapping[str, float]) -> None:
        """Set controls, each cut off at its limits; all others become 0.

        Raises UserError on a name that is no control.
        """
        self.take(self.limits.pose(channels))

    def take(self, values: ControlValues) -> None:
        """Set all controls."""
        self.values = values

    def step(self, seconds: float) -> None:
        """Let time pass."""
        raise NotImplementedError

    def reset(self) -> None:
        """Back to rest, at once."""
        self.values = self.limits.pose({})

    def bone_transforms(self) -> Mapping[str, npt.NDArray[np.float64]]:
        """Where the rigid parts are now: a (4, 4) matrix for each bone."""
        return {}

    def moved_by(self, name: str) -> Mapping[str, float]:
        """The lowest controls that a control moves: itself, or the sums of a layer's control.

        And how far each of them goes where the control is at its most, without a sign.
        """
        return {name: 1.0}


class FaceScene(Scene):
    """A head, moved by muscles, jaw and gaze through the spring simulation."""

    name = "face"

    def __init__(
        self,
        head: assets.Head | FittedHead | None = None,
        simulation: sim.Simulation | None = None,
    ) -> None:
        """Simulate `head`, by default the built-in one; simulation: of it, if there is one."""
        head = assets.load("head") if head is None else head
        self.head = head
        self.simulation = simulation = simulation or sim.create(head)
        self.faces = simulation.faces
        self.rest_positions = simulation.rest_positions
        self.positions = simulation.positions
        controls = simulation.controls
        self.groups = controls.groups
        self.limits = Limits(controls.limits)
        self.actions = controls.actions
        expressions = controls.layers.get("Expressions", ())
        self.expressions = tuple(
            name for name in expressions if parted(name)[0] not in {*expressions} - {name}
        )
        self._parts = tuple(
            part if part.roots is None else SurfaceAttachment(part, self.rest_positions, self.faces)
            for part in shaded_mouth(head.parts)
        )
        self.uv = head.uv
        self.face_uv = head.face_uv
        self.albedo = head.albedo
        self.wrinkles = head.wrinkles
        self.fine_shape = head.fine_shape
        self.ambient_occlusion = head.ambient_occlusion
        if is_known := isinstance(head, assets.Head):
            self._parts = (*self._parts, *built_in_hair(head))
        person = head if isinstance(head, Person) else None
        if isinstance(head, FittedHead) and person is None:  # others have a shirt
            self.fade = head.fade()
        self.called = BUILT_IN if is_known else (person and person.called) or OWN
        self.in_tone = recoloured if is_known else None if person is None else person.in_tone
        self.landmarks = head.landmarks
        landmarks = head.vertices[head.landmarks]
        self.focus = read_only(0.5 * (landmarks.min(axis=0) + landmarks.max(axis=0)))
        self._are_bent = False  # parts, as the face is now
        hair = [part.vertices for part in self._parts if part.striation is not None]
        self.extent = read_only(np.vstack([self.rest_positions, *hair]))
        lowest = float(landmarks[CHIN, 1]) - NECK  # skin below may lie beyond the frame
        self.framed = read_only(self.extent[self.extent[:, 1] > lowest])
        self._moved_by: dict[str, dict[str, float]] = {}
        self.values = self.limits.pose(controls.values)

    def clone(self) -> FaceScene:
        """The same head once more, at rest, which moves by itself; that takes no time."""
        simulation = self.simulation.clone()
        simulation.reset()
        return FaceScene(self.head, simulation)

    def take(self, values: ControlValues) -> None:
        super().take(values)
        self.simulation.controls.take(values.numbers)

    def step(self, seconds: float) -> None:
        count = max(1, math.ceil(seconds / LONGEST_STEP - 1e-9))
        for _ in range(count):
            self.simulation.step(seconds / count)
        self._are_bent = False

    def reset(self) -> None:
        super().reset()
        self.simulation.reset()
        self._are_bent = False

    @property
    def parts(self) -> tuple[Any, ...]:
        """Bent when they are asked for: a picture may show several steps at once."""
        if not self._are_bent:
            self._are_bent = True
            tongue = self.simulation.anatomy.tongue()
            bones = self.bone_transforms()
            for part in self._parts:
                if isinstance(part, SurfaceAttachment):
                    part.follow(self.positions, bones[part.bone])
                elif isinstance(part, Tongue) and tongue is not None:
                    part.bend(tongue)
                elif isinstance(part, MouthWalls):
                    to_cranium = np.linalg.inv(bones["cranium"])
                    part.stretch(self.simulation.bones.jaw, to_cranium @ bones["mandible"])
        return self._parts

    def bone_transforms(self) -> Mapping[str, npt.NDArray[np.float64]]:
        return self.simulation.bones.transforms()

    def moved_by(self, name: str) -> Mapping[str, float]:
        """The lowest controls that a control at its most moves, and how far."""
        controls = self.simulation.controls
        if name not in self._moved_by:
            at_most = self.limits.pose({name: self.limits[name][1]})
            sums = controls.sums_of(at_most.numbers).tolist()
            shares = zip(controls.lowest, sums, strict=True)
            self._moved_by[name] = {each: abs(share) for each, share in shares if share}
        return self._moved_by[name]


class PlaneScene(Scene):
    """The paper's plane: 154 triangles under a strong travelling sine (Fig. 9 and Table 1).

    The wave runs along the diagonals of the cells, so that every edge bends: across one along the
    plane a third of the edges would stay straight and never be split. `amplitude` 1 lifts the
    crests by HEIGHT; `phase` moves the wave along by that many wavelengths.
    """

    name = "plane"
    WAVES = 1.5  # wavelengths in a length of the plane (chosen by eye, with HEIGHT)
    HEIGHT = 0.2  # crest above the middle, in lengths of the plane

    groups = MappingProxyType({"Wave": ("amplitude", "phase")})
    limits = Limits({"amplitude": (0.0, 1.0), "phase": (0.0, 100.0)})

    def __init__(self) -> None:
        plane = assets.load("plane")
        self.faces = plane.faces
        self.rest_positions = plane.vertices
        self.focus = read_only(plane.vertices.mean(axis=0))
        self.values = self.limits.pose({})
        self._length = float(np.ptp(plane.vertices, axis=0).max())
        self.extent = self.framed = plane.vertices
        self._positions = plane.vertices.copy()
        self.positions = read_only(self._positions)

    def step(self, seconds: float) -> None:
        self._positions[:] = self.waved(self.rest_positions)[0]

    def waved(
        self, points: npt.NDArray[np.float64]
    ) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
        """Where points of the flat plane z = 0 lie now, and the wave's normals there, (n, 3)."""
        height = self.values["amplitude"] * self.HEIGHT * self._length
        frequency = 2.0 * np.pi * self.WAVES / self._length
        along = points.sum(axis=1) / np.sqrt(2.0)
        angle = frequency * along - 2.0 * np.pi * self.values["phase"]
        moved = points.copy()
        normals = np.ones_like(points)
        moved[:, 2] += height * np.sin(angle)
        normals[:, :2] = -np.sqrt(0.5) * height * frequency * np.cos(angle)[:, None]
        return moved, normals / np.linalg.norm(normals, axis=1, keepdims=True)

    def reset(self) -> None:
        super().reset()
        self._positions[:] = self.rest_positions


@dataclass(frozen=True)
class ControlTable:
    """The controls of a scene: their headings, limits and effects."""

    groups: Mapping[str, tuple[str, ...]]
    limits: Limits
    actions: Mapping[str, str]


def controls_of(scene: str) -> ControlTable:
    """The controls of the scene of this name, which is not built: nothing is compiled."""
    if scene == PlaneScene.name:
        return ControlTable(PlaneScene.groups, PlaneScene.limits, PlaneScene.actions)
    controls = sim.controls_of(assets.load("head"))
    return ControlTable(controls.groups, Limits(controls.limits), controls.actions)


SCENES: dict[str, Callable[[], Scene]] = {
    "face": FaceScene,
    "plane": PlaneScene,
}


def build_scene(name: str, head: FittedHead | None = None) -> Scene:
    """The scene called `name`, with a head of the user's; UserError where it has none."""
    if head is None:
        return SCENES[name]()
    if name != "face":
        raise UserError(f"--head goes with the scene face, not with '{name}'")
    try:
        return FaceScene(head)
    except ValueError as error:
        raise UserError(f"this head cannot be simulated: {error}") from None


def own_head(head: Path, landmarks: Path) -> FittedHead:
    """The user's own head, fitted."""
    fitted = fit_head(head, landmarks)
    for note in fitted.notes:
        LOG.warning("risorius: %s: %s", head, note)
    return fitted
