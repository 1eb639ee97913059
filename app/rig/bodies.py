"""Bodies: the meshes of an avatar, with vertices for any pose."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from tqdm import tqdm

from risorius.geometry.arrays import Floats32, Floats64, Integers32
from risorius.geometry.normals import vertex_normals

from ..scenes import FaceScene
from ..stopping import cleaned_up_if_stopped
from ..tally import tally
from .poses import CRANIUM_BONE, FacePose, moved_part, rest_in, settings_of

EYE_BONES = ("eye_left", "eye_right")  # names of bones
LEAST_SHAPE_MOTION = 0.01  # [mm]; a shape leaves out smaller, invisible motion of a vertex


class Body(Protocol):
    """A mesh of an avatar.

    name: unique within the avatar.
    rest: vertices at rest [mm], (V, 3).
    faces: vertex indices, (F, 3).
    """

    @property
    def name(self) -> str: ...
    @property
    def rest(self) -> Floats64: ...
    @property
    def faces(self) -> Integers32: ...

    def at(self, pose: FacePose) -> Floats64:
        """Return the vertices in a pose, relative to the body's node [mm], (V, 3)."""
        ...

    def normals_at(self, points: Floats64) -> Floats64:
        """Return unit normals (V, 3) for the vertex positions `points` (V, 3)."""
        ...


@dataclass(frozen=True)
class SkinBody:
    """The simulated skin of a scene."""

    rest: Floats64
    faces: Integers32
    name: str = "skin"

    def at(self, pose: FacePose) -> Floats64:
        return pose.skin

    def normals_at(self, points: Floats64) -> Floats64:
        return vertex_normals(points, self.faces)


@dataclass(frozen=True)
class PartBody:
    """A part of a scene, such as an eyeball, teeth or hair.

    bone: name of the part's node: the cranium, or the bone that moves the whole part.
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

    def at(self, pose: FacePose) -> Floats64:
        if self.bone != CRANIUM_BONE:
            return pose.parts[self.name].astype(np.float64)
        return moved_part(self.part, pose)

    def normals_at(self, points: Floats64) -> Floats64:
        return vertex_normals(points, self.faces)


def bodies_of_parts(
    scene: FaceScene, *, eyes_are_nodes: bool, wanted: Callable[[Any], bool] = lambda _: True
) -> list[PartBody]:
    """Return those parts of a scene, at rest, for which `wanted` is true.

    Parts on the mandible belong to the node of the cranium, and shapes move them.
    """
    scene.reset()
    found = []
    for part in scene.exported_parts:
        if wanted(part):
            is_node = part.bone == "neck" or (part.bone in EYE_BONES and eyes_are_nodes)
            bone = part.bone if is_node else CRANIUM_BONE
            found.append(PartBody(part, np.array(part.vertices, np.float64), bone))
    return found


@dataclass(frozen=True)
class Shaped:
    """A body with K named shapes; K is 0 for a body without motion.

    normals: unit normals at rest, (V, 3).
    targets: displacements of vertices by each shape [mm], (K, V, 3), float32.
    bends: changes of unit normals by each shape, (K, V, 3), float32.
    """

    body: Body
    normals: Floats64
    targets: Floats32
    bends: Floats32


def moving(bodies: Iterable[Body], poses: Mapping[str, tuple[FacePose, FacePose]]) -> list[Shaped]:
    """Give bodies a shape for each pair of a pose and its reference pose."""
    return [_shaped(body, poses) for body in bodies]


def _shaped(body: Body, poses: Mapping[str, tuple[FacePose, FacePose]]) -> Shaped:
    normals = body.normals_at(body.rest)
    shape = (len(poses), *body.rest.shape)
    targets = np.zeros(shape, np.float32)
    bends = np.zeros(shape, np.float32)
    for number, (pose, base) in enumerate(poses.values()):
        moved = body.at(pose)
        before = body.at(base)
        change = moved - before
        change[np.linalg.norm(change, axis=1) < LEAST_SHAPE_MOTION] = 0.0
        if not change.any():
            continue
        targets[number] = change
        bends[number] = bent_normals(body, moved, before)
    if not targets.any():
        targets = np.zeros((0, *body.rest.shape), np.float32)
        bends = targets
    return Shaped(body, normals, targets, bends)


def bent_normals(body: Body, moved: Floats64, before: Floats64) -> Floats64:
    """Return changes of unit normals (V, 3) between the positions `before` and `moved` (V, 3)."""
    bent = body.normals_at(moved) - body.normals_at(before)
    bent[np.linalg.norm(bent, axis=1) < 0.005] = 0.0  # 0.3 degrees
    return bent


def poses_of(
    scene: FaceScene, names: Sequence[str], *, progress: bool
) -> Iterator[tuple[str, tuple[FacePose, FacePose]]]:
    """Yield the name of each shape, its pose at 1 and its reference pose."""
    bases: dict[tuple[str, ...], FacePose] = {}
    bar = tqdm(names, "Shapes", unit="shape", disable=not progress or None, leave=False)
    with cleaned_up_if_stopped(bar.close):
        for name in bar:
            values, base = settings_of(scene, name)
            tally.frames += 1  # the window reads this as progress
            key = tuple(base)
            if key not in bases:
                bases[key] = rest_in(scene, base)
            yield name, (rest_in(scene, values), bases[key])
