"""Heads, values and times for the simulation; a name with a star is of what is accepted."""

from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import numpy as np

from risorius import assets
from risorius.sim import Simulation

HEAD = assets.load("head")
V = len(HEAD.vertices)
POINTS = HEAD.vertices[:2]


def head(**changes: Any) -> Any:
    """The built-in head, changed."""
    names = (
        "vertices",
        "faces",
        "landmarks",
        "rig",
        "layers",
        "mandible_weight",
        "jaw_axis",
        "eyes",
    )
    return SimpleNamespace(**{**{name: getattr(HEAD, name) for name in names}, **changes})


def bare(**changes: Any) -> Any:
    """A triangle, changed."""
    return SimpleNamespace(**{"vertices": np.eye(3), "faces": np.array([[0, 1, 2]]), **changes})


def rig(**changes: Any) -> Any:
    """The built-in head with another rig."""
    return head(rig={**HEAD.rig, **changes})


HEADS: dict[str, Callable[[], Any]] = {
    "None": lambda: None,
    "a word": lambda: "head",
    "no faces": lambda: SimpleNamespace(vertices=np.eye(3)),
    "vertices: None": lambda: bare(vertices=None),
    "vertices: a word": lambda: bare(vertices="here"),
    "vertices: none": lambda: bare(vertices=np.zeros((0, 3))),
    "vertices: flat": lambda: bare(vertices=np.zeros(9)),
    "vertices: two columns": lambda: bare(vertices=np.eye(3)[:, :2]),
    "vertices: NaN": lambda: bare(vertices=np.eye(3) * np.nan),
    "vertices: ragged": lambda: bare(vertices=[[0.0], [0.0, 1.0]]),
    "vertices: complex": lambda: bare(vertices=np.eye(3) * 1j),
    "vertices: 1e300": lambda: bare(vertices=np.eye(3) * 1e300),
    "vertices: of the head, 1e200": lambda: head(vertices=HEAD.vertices * 1e200),
    "vertices: of the head, at one place": lambda: head(vertices=HEAD.vertices * 0.0),
    "faces: None": lambda: bare(faces=None),
    "faces: floats": lambda: bare(faces=np.array([[0.0, 1.0, 2.0]])),
    "faces: beyond": lambda: bare(faces=np.array([[0, 1, 3]])),
    "faces: negative": lambda: bare(faces=np.array([[0, 1, -1]])),
    "faces: ragged": lambda: bare(faces=[[0, 1, 2], [0, 1]]),
    "faces: quads": lambda: bare(faces=np.array([[0, 1, 2, 0]])),
    "faces: huge": lambda: bare(faces=np.array([[0, 1, 2**40]])),
    "landmarks: too few": lambda: head(landmarks=HEAD.landmarks[:67]),
    "landmarks: floats": lambda: head(landmarks=HEAD.landmarks * 1.0),
    "landmarks: beyond": lambda: head(landmarks=HEAD.landmarks + V),
    "landmarks: negative": lambda: head(landmarks=HEAD.landmarks - V),
    "landmarks: all the same": lambda: head(landmarks=HEAD.landmarks * 0),
    "landmarks: a word": lambda: head(landmarks="68"),
    "rig: a list": lambda: head(rig=[1]),
    "rig: a word": lambda: head(rig="rig"),
    "rig: unknown key": lambda: rig(muscel={}),
    "rig: other format": lambda: rig(format=99),
    "rig: muscles are a list": lambda: rig(muscle=[1]),
    "rig: a muscle is a number": lambda: rig(muscle={"brow": 1}),
    "rig: an empty muscle": lambda: rig(muscle={"brow": {}}),
    "rig: a number for a name": lambda: rig(muscle={1: {}}),
    "rig: tissue is a word": lambda: rig(tissue="soft"),
    "rig: tissue NaN": lambda: rig(tissue={"heaviness": float("nan")}),
    "layers: a number": lambda: head(layers=3),
    "mandible_weight: too few": lambda: head(mandible_weight=np.zeros(3)),
    "mandible_weight: NaN": lambda: head(mandible_weight=np.full(V, np.nan)),
    "jaw_axis: one point": lambda: head(jaw_axis=np.zeros(3)),
    "jaw_axis: a word": lambda: head(jaw_axis="x"),
    "eyes: numbers": lambda: head(eyes=(1, 2)),
    "eyes: other name": lambda: head(eyes=(SimpleNamespace(name="top", centre=0, radius=1),)),
    "*a triangle": bare,
    "*no triangles": lambda: bare(faces=np.zeros((0, 3), int)),
    "*all at one place": lambda: bare(vertices=np.zeros((3, 3))),
    "*the same corner": lambda: bare(faces=np.array([[0, 0, 0]])),
    "*tiny": lambda: bare(vertices=np.eye(3) * 1e-30),
    "*without rig": lambda: head(rig=None, layers=None),
}

CALLS: dict[str, Callable[[Simulation], object]] = {
    "set: unknown": lambda s: s.set("smile", 1.0),
    "set: no word": lambda s: s.set(3, 1.0),  # type: ignore[arg-type]
    "set: a list": lambda s: s.set(["joy"], 1.0),  # type: ignore[arg-type]
    "set: NaN": lambda s: s.set("joy", float("nan")),
    "set: infinite": lambda s: s.set("joy", float("inf")),
    "set: above": lambda s: s.set("joy", 1.1),
    "set: below": lambda s: s.set("joy", -0.1),
    "set: a word": lambda s: s.set("joy", "much"),  # type: ignore[arg-type]
    "set: None": lambda s: s.set("joy", None),  # type: ignore[arg-type]
    "set: complex": lambda s: s.set("joy", 1j),  # type: ignore[arg-type]
    "set: an array": lambda s: s.set("joy", np.zeros(2)),  # type: ignore[arg-type]
    "set: a huge whole": lambda s: s.set("joy", 10**400),
    "set_all: a list": lambda s: s.set_all(["joy"]),  # type: ignore[arg-type]
    "set_all: one is wrong": lambda s: s.set_all({"joy": 1.0, "smile": 1.0}),
    "pose: a number": lambda s: s.pose(1),  # type: ignore[arg-type]
    "pose: NaN": lambda s: s.pose({"joy": float("nan")}),
    "step: zero": lambda s: s.step(0.0),
    "step: negative": lambda s: s.step(-1.0),
    "step: too long": lambda s: s.step(1.0),
    "step: NaN": lambda s: s.step(float("nan")),
    "step: infinite": lambda s: s.step(float("inf")),
    "step: a word": lambda s: s.step("fast"),  # type: ignore[arg-type]
    "step: None": lambda s: s.step(None),  # type: ignore[arg-type]
    "step: complex": lambda s: s.step(0.01j),  # type: ignore[arg-type]
    "step: an array": lambda s: s.step(np.full(2, 0.01)),  # type: ignore[arg-type]
    "kick: flat": lambda s: s.kick(np.zeros(3)),
    "kick: NaN": lambda s: s.kick(np.full((V, 3), np.nan)),
    "kick: a word": lambda s: s.kick("hard"),
    "kick: None": lambda s: s.kick(None),  # type: ignore[arg-type]
    "kick: complex": lambda s: s.kick(np.full((V, 3), 1j)),
    "kick: ragged": lambda s: s.kick([[0.0], [0.0, 1.0]]),
    "drag: beyond": lambda s: s.drag([0, V], POINTS, [1, 1]),
    "drag: negative": lambda s: s.drag([0, -1], POINTS, [1, 1]),
    "drag: twice": lambda s: s.drag([0, 0], POINTS, [1, 1]),
    "drag: halves": lambda s: s.drag([0.5, 1.5], POINTS, [1, 1]),
    "drag: NaN for a number": lambda s: s.drag([0.0, float("nan")], POINTS, [1, 1]),
    "drag: a number": lambda s: s.drag(0, POINTS, [1, 1]),
    "drag: words": lambda s: s.drag(["nose", "chin"], POINTS, [1, 1]),
    "drag: a huge whole": lambda s: s.drag([0, 10**30], POINTS, [1, 1]),
    "drag: too few targets": lambda s: s.drag([0, 1], POINTS[:1], [1, 1]),
    "drag: targets NaN": lambda s: s.drag([0, 1], POINTS * np.nan, [1, 1]),
    "drag: targets a word": lambda s: s.drag([0, 1], "up", [1, 1]),
    "drag: too firm": lambda s: s.drag([0, 1], POINTS, [1, 2]),
    "drag: firmness NaN": lambda s: s.drag([0, 1], POINTS, [1, float("nan")]),
    "drag: firmness a number": lambda s: s.drag([0, 1], POINTS, 1),
    "*set: a switch": lambda s: s.set("joy", True),
    "*set: of numpy": lambda s: s.set("joy", np.float32(0.5)),  # type: ignore[arg-type]
    "*set: rounding": lambda s: s.set("joy", 1.0 + 1e-7),
    "*set_all: nothing": lambda s: s.set_all({}),
    "*step: the smallest": lambda s: s.step(5e-324),
    "*step: the longest": lambda s: s.step(0.05),
    "*drag: nothing": lambda s: s.drag([], np.zeros((0, 3)), []),
    "*kick: whole numbers": lambda s: s.kick(np.ones((V, 3), int)),
}
