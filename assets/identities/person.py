"""A head of another person, made from the built-in one: same triangles, texture and muscles.

    person = make_person(sample_identity(7))

The shape is bent until the measures are the asked ones; then eyeballs are placed, and lids are laid
on them.
"""

from __future__ import annotations

import contextlib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from ..files import Image
from ..fitting.head import FittedHead
from ..fitting.organs import EYE_LANDMARKS, FittedSkin, place_parts
from ..fitting.warp import Similarity
from ..loading import load
from ..model import Eye, FloatArray, Head, IndexArray
from ..topology import cross_products, vertex_normals
from .shaping import Field, Shaper, lids_on_eyes, measures_of
from .traits import SHAPES, UNEVEN, Identity

NEARER = (1.0, 0.85, 0.7, 0.5, 0.0)  # shares of the deviations, tried in turn
LID_SHARES = (1.0, 1.0, 1.0, 0.6, 0.25)  # how far rows around the eye are laid on it


@dataclass(frozen=True)
class Person(FittedHead):
    """A head with the triangles of the built-in one; beside what a fitted head has:

    mandible_weight, jaw_axis, anatomy, mirror: as of `Head`. `mirror` is that of the built-in head
        where left and right differ, too.
    openness: how open the skin is to light from all around, that of the built-in head.
    identity: what it was made from.
    """

    mandible_weight: FloatArray
    jaw_axis: FloatArray
    anatomy: Mapping[str, int]
    mirror: IndexArray
    openness: Image
    identity: Identity

    @property
    def measures(self) -> dict[str, float]:
        """Its measures, code -> [mm]."""
        return measures_of(self.vertices, self.anatomy)


@lru_cache(maxsize=1)
def _template() -> tuple[Head, Shaper]:
    head = load("head")
    points = [name for shape in SHAPES.values() for name, _ in shape.pushes]
    return head, Shaper(head, [_vertex(head, name) for name in (*points, *UNEVEN)])


def _vertex(head: Head, point: str | int) -> int:
    return int(head.landmarks[point]) if isinstance(point, int) else head.anatomy[point]


def make_person(identity: Identity) -> Person:
    """The head of an identity; the same numbers give the same head.

    Where its measures contradict each other, as one in 700 does, all of it is brought nearer to the
    mean, until they do not; the person's `identity` says what was made.
    """
    for share in NEARER[:-1]:
        nearer = identity.scaled(share)
        with contextlib.suppress(ValueError):
            return _made(nearer)
    return _made(identity.scaled(NEARER[-1]))


def _made(identity: Identity) -> Person:
    """The head of an identity; ValueError where there is none, or its skin would be turned."""
    known, shaper = _template()
    pushes: dict[int, FloatArray] = {}
    for name, score in identity.shapes.items():
        for point, way in SHAPES[name].pushes:
            vertex = _vertex(known, point)
            pushes[vertex] = pushes.get(vertex, np.zeros(3)) + score * np.array(way)
    pushed = [(vertex, way) for vertex, way in pushes.items() if np.linalg.norm(way) > 1e-9]
    uneven = [
        (_vertex(known, point), np.array(way))
        for point, way in zip(UNEVEN, identity.unevenness or (), strict=False)
    ]
    field = shaper.fit(identity.measures, pushed, uneven)
    vertices, eyes = _with_eyes(known, field)
    turned = cross_products(vertices, known.faces) * cross_products(known.vertices, known.faces)
    if (turned.sum(axis=1) <= 0.0).any():
        raise ValueError("no head has these measures without turning a triangle")
    return _assembled(known, field, vertices, eyes, identity)


def _with_eyes(known: Head, field: Field) -> tuple[FloatArray, tuple[Eye, ...]]:
    """Where the skin comes to lie, and eyeballs in it."""
    vertices = field.points(known.vertices)
    centres = field.points(np.array([eye.centre for eye in known.eyes]))
    eyes = []
    for eye, centre in zip(known.eyes, centres, strict=True):
        corners = known.landmarks[EYE_LANDMARKS[eye.name]][[0, 3]]
        before, now = (
            np.linalg.norm(np.diff(x[corners], axis=0)) for x in (known.vertices, vertices)
        )
        scale = float(np.sqrt(now / before))  # eyeballs differ less than their openings
        eyes.append(Eye(eye.name, centre, scale * eye.radius, scale * eye.iris_radius))
    return lids_on_eyes(known, vertices, eyes, LID_SHARES), tuple(eyes)


def _assembled(
    known: Head, field: Field, vertices: FloatArray, eyes: tuple[Eye, ...], identity: Identity
) -> Person:
    normals = vertex_normals(vertices, known.faces)
    skin = FittedSkin(vertices, normals, vertices[known.landmarks], known.mandible_weight)
    for array in (vertices, normals):
        array.flags.writeable = False
    return Person(
        vertices=vertices,
        faces=known.faces,
        landmarks=known.landmarks,
        bone_depth=field.scale * known.bone_depth,
        eyes=eyes,
        parts=place_parts(known, skin, field, eyes),
        uv=known.uv,
        face_uv=known.face_uv,
        albedo=known.albedo,
        segments=known.segments,
        wrinkles=known.wrinkles,
        rig=known.rig,
        layers=known.layers,
        to_millimetres=Similarity(1.0, np.eye(3), np.zeros(3)),
        file_vertices=np.arange(len(vertices), dtype=np.int32),
        mandible_weight=known.mandible_weight,
        jaw_axis=field.points(known.jaw_axis),
        anatomy=known.anatomy,
        mirror=known.mirror,
        openness=known.openness,
        identity=identity,
    )
