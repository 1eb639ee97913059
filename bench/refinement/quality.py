"""How near a refined mesh comes to the true surface, and to its picture, for what it spends.

A coarse face moves with a dense one (subjects.py), and is refined by all methods (methods.py):

    distance   from every dense vertex the nearest point of the refined mesh is found, exactly;
               root of the mean square
    angle      between the normals there, the median: where lips or lids touch, the nearest point
               of a few per cent lies on the other one and looks the other way, whatever the mesh
               is like, and they would rule a mean
    picture    grey levels and outline beside pictures of the dense mesh (pictures.py)
    jump       how far the surface goes in a frame while the expression comes (flicker.py)
"""

from __future__ import annotations

from collections.abc import Callable, Container, Iterable, Sequence
from dataclasses import dataclass, fields, replace

import numpy as np

from risorius.geometry.closest import closest_points
from risorius.geometry.normals import vertex_normals

from ..subjects import Points, PosePair, Subject
from .flicker import largest_jump
from .methods import SCHEMES, Key, Method, methods_for
from .pictures import Mesh, Pictures

BUDGETS = (2.0,)
"""Triangles of a refined mesh over those of the coarse one, that is compared."""


@dataclass(frozen=True)
class Score:
    """Errors of one mesh in one expression."""

    key: Key
    expression: str
    triangles: float
    distance: float
    """Root of the mean squared distance [mm]."""
    angle: float
    """Median of the angle between normals [degrees]."""
    picture: float
    """Root mean square of grey levels, 0..255."""
    outline: float
    """Pixels that one mesh covers and the other does not."""
    jump: float
    """Largest motion of the surface in a frame over that of the input; NaN: nothing is decided."""


MEASURES = tuple(each.name for each in fields(Score))[2:]


def measure(
    subject: Subject,
    *,
    schemes: Iterable[str] = tuple(SCHEMES),
    budgets: Iterable[float] = BUDGETS,
    expressions: Container[str] | None = None,
    progress: Callable[[str], object] = lambda _: None,
) -> list[Score]:
    """Score all methods in all expressions of `subject` (or in those named).

    `progress`: called with the name of each expression before it is measured.
    """
    scores = []
    with Pictures(subject) as pictures:
        methods = methods_for(subject, schemes, tuple(budgets), pictures.view)
        for name in subject.poses:
            if expressions is not None and name not in expressions:
                continue
            title = name if subject.group in subject.name else f"{subject.name}, {name}"
            progress(title)
            frames = subject.frames(name)
            for method in methods:
                score = _score(subject, name, method, pictures, frames)
                scores.append(replace(score, expression=title))
    return scores


def means(scores: Iterable[Score]) -> dict[Key, Score]:
    """The mean over expressions for each method; of `jump` the largest."""
    groups: dict[Key, list[Score]] = {}
    for score in scores:
        groups.setdefault(score.key, []).append(score)

    def joined(group: list[Score], what: str) -> float:
        """One measure of all expressions."""
        values = np.array([getattr(score, what) for score in group])
        return float(values.max() if what == "jump" else values.mean())

    return {
        key: Score(key, "mean", *(joined(group, what) for what in MEASURES))
        for key, group in groups.items()
    }


def _score(
    subject: Subject, expression: str, method: Method, pictures: Pictures, frames: Sequence[Points]
) -> Score:
    pose = subject.poses[expression]
    mesh = method.make(pose.coarse)
    distance, angle = _nearness(mesh, pose, subject)
    seen = pictures.error(expression, mesh)
    count = len(mesh[2])
    jump = float("nan")
    if method.refiner is not None:  # last: it overwrites the mesh
        jump = largest_jump(method.refiner, subject.coarse_faces, frames, pictures.view)
    return Score(method.key, expression, count, distance, angle, seen.rms, seen.outline, jump)


def _nearness(mesh: Mesh, pose: PosePair, subject: Subject) -> tuple[float, float]:
    """Distance [mm] and angle [degrees] of the dense pose from a mesh."""
    positions, mesh_normals, triangles = mesh[:3]
    found = closest_points(pose.dense, positions, triangles)
    near = found.interpolate(mesh_normals)
    length = np.maximum(np.linalg.norm(near, axis=1), 1e-300)
    normals = vertex_normals(pose.dense, subject.dense_faces)
    cosine = np.einsum("ni,ni->n", near, normals) / length
    angles = np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0)))
    return float(np.sqrt(np.mean(found.distances**2))), float(np.median(angles))
