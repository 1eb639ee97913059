"""Bodies: the meshes of an avatar, which give their vertices in a pose."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from tqdm import tqdm

from risorius.geometry.arrays import Floats32, Floats64, Integers32
from risorius.geometry.normals import vertex_normals

from ..motion import tally
from ..scenes import FaceScene
from ..stopping import cleaned_up_if_stopped
from .poses import CRANIUM, Pose, moved_part, rest_in, settings_of

EYES = ("eye_left", "eye_right")  # names of bones
LEAST = 0.01  # [mm], invisible: vertices of a shape that move less stand still


class Body(Protocol):
    """A mesh of an avatar.

    name: unique within it. rest: its vertices [mm], shape (V, 3). faces: shape (F, 3).
    """

    @property
    def name(self) -> str: ...
    @property
    def rest(self) -> Floats64: ...
    @property
    def faces(self) -> Integers32: ...

    def at(self, pose: Pose) -> Floats64:
        """Its vertices in a pose, relative to the node that it hangs on, (V, 3)."""
        ...

    def normals_at(self, points: Floats64) -> Floats64:
        """Unit normals for vertices at `points`, shape (V, 3) each."""
        ...


@dataclass(frozen=True)
class Skin:
    """The simulated skin of a scene."""

    rest: Floats64
    faces: Integers32
    name: str = "skin"

    def at(self, pose: Pose) -> Floats64:
        return pose.skin

    def normals_at(self, points: Floats64) -> Floats64:
        return vertex_normals(points, self.faces)


@dataclass(frozen=True)
class PartBody:
    """A part of a scene: an eyeball, teeth, hair.

    bone: name of the node that it hangs on: the cranium, or the part's own bone, which moves it as
    a whole.
    """

    part: Any
    rest: Floats64
    bone: str

    @property
    def name(self) -> str:
        return str(self.part.name)

    @property
    def faces(self) -> Integers32:
        return np.asarray(self.part.faces, np.int32)

    def at(self, pose: Pose) -> Floats64:
        if self.bone != CRANIUM:
            return pose.parts[self.name].astype(np.float64)
        return moved_part(self.part, pose)

    def normals_at(self, points: Floats64) -> Floats64:
        return vertex_normals(points, self.faces)


def bodies_of_parts(
    scene: FaceScene, *, eyes_are_nodes: bool, wanted: Callable[[Any], bool] = lambda _: True
) -> list[PartBody]:
    """The parts of a scene at rest; those of the mandible hang on the cranium, and shapes move
    them.
    """
    scene.reset()
    found = []
    for part in scene.parts:
        if wanted(part):
            is_node = part.bone == "neck" or (part.bone in EYES and eyes_are_nodes)
            bone = part.bone if is_node else CRANIUM
            found.append(PartBody(part, np.array(part.vertices, np.float64), bone))
    return found


@dataclass(frozen=True)
class Shaped:
    """A body with its named shapes.

    targets, bends: changes of vertices [mm] and of unit normals by each shape, (K, V, 3) float32; K
    is 0 for a body without motion.
    """

    body: Body
    normals: Floats64
    targets: Floats32
    bends: Floats32


def moving(bodies: Iterable[Body], poses: Mapping[str, tuple[Pose, Pose]]) -> list[Shaped]:
    """Bodies with a shape for each pair of a pose and its reference pose."""
    return [_shaped(body, poses) for body in bodies]


def _shaped(body: Body, poses: Mapping[str, tuple[Pose, Pose]]) -> Shaped:
    normals = body.normals_at(body.rest)
    shape = (len(poses), *body.rest.shape)
    targets = np.zeros(shape, np.float32)
    bends = np.zeros(shape, np.float32)
    for number, (pose, base) in enumerate(poses.values()):
        moved = body.at(pose)
        before = body.at(base)
        change = moved - before
        change[np.linalg.norm(change, axis=1) < LEAST] = 0.0
        if not change.any():
            continue
        targets[number] = change
        bends[number] = bent_normals(body, moved, before)
    if not targets.any():
        targets = np.zeros((0, *body.rest.shape), np.float32)
        bends = targets
    return Shaped(body, normals, targets, bends)


def bent_normals(body: Body, moved: Floats64, before: Floats64) -> Floats64:
    """Changes of unit normals between two places of the vertices, shape (V, 3)."""
    bent = body.normals_at(moved) - body.normals_at(before)
    bent[np.linalg.norm(bent, axis=1) < 0.005] = 0.0  # a third of a degree
    return bent


def poses_of(
    scene: FaceScene, names: Sequence[str], *, progress: bool
) -> Iterator[tuple[str, tuple[Pose, Pose]]]:
    """The pose of each shape at 1, and its reference pose, with a progress bar."""
    bases: dict[tuple[str, ...], Pose] = {}
    bar = tqdm(names, "Shapes", unit="shape", disable=not progress or None, leave=False)
    with cleaned_up_if_stopped(bar.close):
        for name in bar:
            values, base = settings_of(scene, name)
            tally.frames += 1  # a window shows this as progress
            key = tuple(base)
            if key not in bases:
                bases[key] = rest_in(scene, base)
            yield name, (rest_in(scene, values), bases[key])
