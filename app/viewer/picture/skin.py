"""The skin under the mouse: its place, its muscle, and a finger that pulls it.

Muscles and jaw bring the skin as near to the mouse as they can (sim.Pull), so it keeps its place
after its release. Skin that is pulled without muscles hangs on springs, and swings back.
"""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from risorius import render, sim
from risorius.geometry.arrays import Flags, Floats64
from risorius.geometry.closest import closest_points
from risorius.geometry.mesh_graph import path_lengths
from risorius.geometry.rays import PARALLEL_VOLUME, crossings

from ...control_names import ONE_MOTION_BASES, SIGNED_CONTROLS, plain_name, split_side, twin_of
from ..messages import Message
from ..session.session import Session
from ..settings import Settings


@dataclass(frozen=True)
class Ray:
    """A ray from the camera through one pixel."""

    origin: Floats64
    direction: Floats64

    @classmethod
    def through(
        cls, camera: render.OrbitCamera, viewport: render.Rectangle, place: tuple[float, float]
    ) -> Ray:
        """Return the ray through `place` [pixels from the lower left corner of the surface]."""
        left, bottom, width, height = viewport
        to_clip = np.asarray(camera.view_matrix() @ camera.projection_matrix(width / height))
        x = 2.0 * (place[0] - left) / width - 1.0
        y = 2.0 * (place[1] - bottom) / height - 1.0
        ends = np.array([[x, y, -1.0, 1.0], [x, y, 1.0, 1.0]]) @ np.linalg.inv(to_clip)
        near, far = ends[:, :3] / ends[:, 3:]
        return cls(near, (far - near) / np.linalg.norm(far - near))

    def at_depth_of(self, point: Floats64, axis: Floats64) -> Floats64:
        """Intersect the ray with the plane through `point` normal to `axis` (the line of sight)."""
        along = float((point - self.origin) @ axis) / float(self.direction @ axis)
        met: Floats64 = self.origin + along * self.direction
        return met


def skin_under(ray: Ray, positions: Floats64, faces: npt.NDArray[Any]) -> Floats64 | None:
    """Return the nearest point where the ray meets the mesh from outside, or None.

    Only triangles are tested whose bounding rectangle across the ray contains the ray.
    """
    axes = np.linalg.svd(ray.direction[None])[2][1:]  # two directions across the ray
    # Rounding errors must not let a ray pass between the two triangles of an edge.
    rounding = 1e-9  # in barycentric coordinates, and in [mm]
    for aside in ((positions - ray.origin) @ axis for axis in axes):
        corners = aside[faces]
        faces = faces[(corners.min(axis=1) < rounding) & (corners.max(axis=1) > -rounding)]
    volume, u, v, distance = crossings(ray.origin, ray.direction, positions[faces])
    inside = (u >= -rounding) & (v >= -rounding) & (u + v <= 1.0 + rounding)
    hit = (volume > PARALLEL_VOLUME) & inside & (distance > 0.0)
    if not hit.any():
        return None
    point: Floats64 = ray.origin + distance[hit].min() * ray.direction
    return point


@dataclass(frozen=True, eq=False)
class HoveredMuscle:
    """The muscle under the mouse.

    shares: motion of each simulated vertex by the muscle, relative to the vertex that moves most,
    (V,).
    """

    name: str
    simulation: sim.Simulation
    shares: Floats64

    @classmethod
    def of(cls, simulation: sim.Simulation, name: str) -> HoveredMuscle:
        """Measure the motion that a muscle alone gives to a face at rest."""
        distances = np.linalg.norm(sim.motion_of(simulation, name), axis=1)
        least_motion = 1e-9  # for a muscle that moves nothing
        return cls(name, simulation, distances / max(distances.max(), least_motion))


def muscle_at(simulation: sim.Simulation, point: Floats64) -> str | None:
    """Return the muscle at a point (3,) of the skin, or None."""
    return simulation.anatomy.muscle_at(point, 14.0)  # [mm] from a fibre at most


class MuscleFinder:
    """Finds muscles under the mouse, and measures each muscle of a face once."""

    def __init__(self) -> None:
        self._simulation: sim.Simulation | None = None
        self._known: dict[str, HoveredMuscle] = {}  # muscles of this simulation, by name

    def at(self, simulation: sim.Simulation, point: Floats64) -> HoveredMuscle | None:
        """Return the muscle at a point (3,) of the skin, or None."""
        if simulation is not self._simulation:
            self._simulation = simulation
            self._known = {}
        name = muscle_at(simulation, point)
        if name is None:
            return None
        if name not in self._known:
            self._known[name] = HoveredMuscle.of(simulation, name)
        return self._known[name]


class SkinDrag:
    """Drags the skin by the mouse, like a finger on it."""

    def __init__(
        self, session: Session, settings: Settings, point: Floats64, sight: Floats64, poses: bool
    ) -> None:
        """sight: direction from the camera to the point. poses: whether muscles move the skin."""
        self._session = session
        self._sight = sight
        self.point = point
        self._simulation: sim.Simulation = session.scene.simulation  # type: ignore[attr-defined]
        positions = self._simulation.positions
        distance = np.linalg.norm(positions - point, axis=1)
        finger_radius = 16.0  # [mm]
        is_under = _touched(self._simulation, point, sight, distance < finger_radius)
        self._vertices = np.flatnonzero(is_under)
        if not len(self._vertices):
            self._vertices = distance.argmin(keepdims=True)
        self._from = positions[self._vertices].copy()
        near = np.minimum(distance[self._vertices] / finger_radius, 1.0)
        self._firmness = np.maximum((1.0 - near**2) ** 2, 0.02 if near.max() < 1.0 else 1.0)
        self.offset = np.zeros(3)
        self._solved = np.zeros(3)
        self._due = 0.0
        self._line: Message = None  # message about the last solution
        poses = poses and not session.live_override.is_on  # a live face sets the pose itself
        rest = self._simulation.rest_positions[self._vertices]
        is_aside = abs(rest[:, 0].mean() - session.scene.framing.focus[0]) > finger_radius
        self._candidates = (
            _candidates(session, linked=settings.is_linked, is_aside=is_aside) if poses else []
        )
        self._own: dict[str, float] = {}  # values of solved controls before the drag
        self._pull: sim.Pull | None = None  # made at the first motion, so that a click is fast

    def drag_to(self, point: Floats64) -> Message:
        """Drag the skin to a point, or toward it if it is too far; called once in each frame."""
        self.offset = offset = point - self.point
        if not self._candidates:
            length = float(np.linalg.norm(offset))
            most_drag_distance = 45.0  # [mm]: a longer drag would turn the skin inside out
            shortened = most_drag_distance * np.tanh(length / most_drag_distance)
            offset = offset * (shortened / max(length, 1e-9))
            self._simulation.touch.drag(self._vertices, self._from + offset, self._firmness)
            return None
        # Solving for a dense head takes long, so at most half of the time is used for it.
        begin = time.perf_counter()
        if begin < self._due or np.array_equal(offset, self._solved):
            return self._line
        self._line = self._solve()
        self._due = 2.0 * time.perf_counter() - begin
        return self._line

    def muscle(self) -> str | None:
        """Return the muscle at the dragged point, or None."""
        return muscle_at(self._simulation, self.point)

    def release(self) -> Message:
        """End the drag: muscles hold the skin, or it swings back; return a message."""
        self.drop()
        if self._pull is None:
            return None
        if not np.array_equal(self.offset, self._solved):
            self._line = self._solve()
        self._session.note()
        return self._line

    def drop(self) -> None:
        """Release the skin."""
        self._simulation.touch.end_drag()

    def _solve(self) -> Message:
        """Set the solved controls, restore those no longer solved, and return a message."""
        if self._pull is None:
            finger = self._vertices, self._firmness
            self._pull = sim.Pull(self._simulation, *finger, self._candidates, self._sight)
            self._at_rest = self._pull.targets
        pull = self._pull
        self._solved = self.offset
        pull.targets = self._at_rest + self.offset
        pull.solve()
        solved = {name: value for names, value in pull.changes.items() for name in names}
        present = self._session.values  # a script may move other controls while it is recorded
        self._own = {name: present[name] for name in solved} | self._own
        for name, value in {**self._own, **solved}.items():
            if value != present[name]:
                self._session.set(name, value)
        if not solved:
            return "No muscle moves the skin this way; with Ctrl it is pulled without muscles"
        moved = (f"{plain_name(*names)} {value:.2f}" for names, value in pull.changes.items())
        return f"{', '.join(moved).capitalize()}; {pull.remaining:.1f} mm short of the mouse"


def _touched(simulation: sim.Simulation, point: Floats64, sight: Floats64, near: Flags) -> Flags:
    """Flag the vertices near a point that a finger along `sight` touches, shape (V,).

    A short path over skin that faces the viewer joins them to the point, so a finger on one lip or
    lid does not touch the other one.
    """
    longest = 24.0  # [mm] along edges
    positions = simulation.positions
    faces = simulation.faces[near[simulation.faces].any(axis=1)]
    sides = np.diff(positions[faces], axis=1)
    faces = faces[np.cross(sides[:, 0], sides[:, 1]) @ sight < 0.0]
    if not len(faces):
        return near
    corners = closest_points(point[None], positions, faces).corners[0]
    paths = path_lengths(simulation.rest_positions, faces, corners).min(axis=0)
    return np.asarray(near & (paths < longest))


def _candidates(session: Session, *, linked: bool, is_aside: bool) -> list[tuple[str, ...]]:
    """Return the controls that a drag may move; controls in one tuple move together.

    If sides are linked, a drag beside the middle (`is_aside`) moves both sides alike, so controls
    that move the face to one side are left out.
    """
    found = list[tuple[str, ...]]()
    values = session.values
    lowest = session.scene.simulation.controls.lowest  # type: ignore[attr-defined]
    # Prefixes of controls that a drag never moves.
    unpulled_prefixes = ("gaze_", "head_", "tongue_", "lips_closed")
    for name in lowest:
        twin = twin_of(name)
        is_whole = f"{name}_left" in lowest
        if is_whole or name.startswith(unpulled_prefixes):
            continue
        if (
            linked
            and is_aside
            and (name in SIGNED_CONTROLS or split_side(name)[0] in ONE_MOTION_BASES)
        ):
            continue
        is_pair = linked and twin != name and values[name] == values[twin]
        if not is_pair or split_side(name)[0] in ONE_MOTION_BASES:
            found.append((name,))
        elif name < twin:
            found.append((name, twin))
    return found
