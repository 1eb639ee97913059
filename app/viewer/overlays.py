"""What shows how the face moves: lines over it; muscles and skull are anatomy's."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from risorius import render
from risorius.render import Lines

from ..scenes import FaceScene, Scene
from .colours import edge_strains

# sRGB
POINTED_AT = np.array([1.0, 0.66, 0.10])
MOST_SEEN, LEAST_SEEN = 0.9, 0.2  # opacity of the muscle that does most; share that is seen
SLACK, STRETCHED, SQUEEZED = (
    np.array([0.45, 0.47, 0.50]),
    np.array([0.80, 0.15, 0.12]),
    np.array([0.13, 0.33, 0.75]),
)
MARK = np.array([0.05, 0.55, 0.40])
MARK_SIZE = 1.6  # [mm] half of a landmark's cross
MOST_STRAIN = 0.3  # an edge in its full colour


def spring_lines(scene: Scene, edges: npt.NDArray[np.int32], camera: render.OrbitCamera) -> Lines:
    """The skin's edge springs: stretched red, compressed blue."""
    strain = np.clip(edge_strains(scene, edges) / MOST_STRAIN, -1.0, 1.0)[:, None]
    colours = SLACK + np.maximum(strain, 0.0) * (STRETCHED - SLACK)
    colours += np.maximum(-strain, 0.0) * (SQUEEZED - SLACK)
    return Lines(list(scene.positions[edges]), colours, width=1.3, hidden_opacity=0.08)


def landmark_lines(scene: Any, edges: npt.NDArray[np.int32], camera: render.OrbitCamera) -> Lines:
    """A cross on each of the 68 landmarks, facing the camera."""
    points = scene.positions[scene.head.landmarks]
    arms = MARK_SIZE * np.array([(-axis, axis) for axis in camera.axes()[:2]])
    lines = list((points[:, None, None] + arms).reshape(-1, 2, 3))
    return Lines(lines, np.tile(MARK, (len(lines), 1)), width=2.0, hidden_opacity=0.5)


OverlayMaker = Callable[[Any, npt.NDArray[np.int32], render.OrbitCamera], Lines]
LINES: dict[str, OverlayMaker] = {"springs": spring_lines, "landmarks": landmark_lines}
OVERLAYS = ("muscles", "springs", "skull", "landmarks")  # lines, and STRUCTURES of anatomy


def overlays_of(scene: Scene) -> tuple[str, ...]:
    """The overlays that this scene has the data for: a mesh alone has springs."""
    return OVERLAYS if isinstance(scene, FaceScene) else ("springs",)


def pointed_lines(scene: Scene, shares: Mapping[str, float]) -> list[Lines]:
    """The fibres of muscles, for whoever points at a control: the clearer the more each does.

    shares: name -> how far it goes. One without sides stands for both.
    """
    fibres = scene.simulation.fibres() if isinstance(scene, FaceScene) else {}
    seen: dict[str, float] = {}
    for name, share in shares.items():
        for side in (name, f"{name}_left", f"{name}_right"):
            if side in fibres:
                seen[side] = max(share, seen.get(side, 0.0))
    most, drawn = max(seen.values(), default=1.0), []
    for name, share in seen.items():
        if share >= LEAST_SEEN * most:
            opacity, colours = MOST_SEEN * share / most, np.tile(POINTED_AT, (len(fibres[name]), 1))
            drawn.append(Lines(fibres[name], colours, 2.5, opacity, opacity))
    return drawn
