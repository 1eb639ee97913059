"""A head of another person, made from the built-in one: same triangles, texture and muscles.

    person = make_person(sample_identity(7))

The shape is bent until the measures are the asked ones; then eyeballs are placed, and lids are laid
on them.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import lru_cache

import numpy as np

from risorius.geometry.normals import cross_products, vertex_normals

from ..around import STRIP, direction_coordinates, neck_relief
from ..data_files import Image
from ..errors import AssetError
from ..fitting.head import FittedHead
from ..fitting.organs import EYE_LANDMARKS, FittedSkin, place_parts
from ..fitting.warp import Similarity
from ..loading import load
from ..model import Eye, FloatArray, Head, IndexArray
from .shaping import Field, Shaper, lids_on_eyes, measures_of
from .traits import SHAPES, Identity, Sex

NEARER = (1.0, 0.85, 0.7, 0.5, 0.0)  # shares of the deviations, tried in turn
MOST_RESTING = 0.65
NECK_OF_WOMEN = 0.85  # of the relief of the neck, which they have not
LID_SHARES = (1.0, 1.0, 1.0, 0.6, 0.25)  # how far rows around the eye are laid on it


@dataclass(frozen=True)
class Person(FittedHead):
    """A head with the triangles of the built-in one; beside what a fitted head has:

    mandible_weight, jaw_axis, anatomy, mirror: as of `Head`. `mirror` is that of the built-in head
        where left and right differ, too.
    ambient_occlusion: how open the skin is to light from all around, that of the built-in head but
        for what hair takes away.
    identity: what it was made from.
    called: its number or name, "" for none.
    in_tone: makes the texture in another tone, from the angle of `recoloured` [deg].
    """

    mandible_weight: FloatArray
    jaw_axis: FloatArray
    anatomy: Mapping[str, int]
    mirror: IndexArray
    ambient_occlusion: Image
    identity: Identity
    called: str = field(default="", kw_only=True)
    in_tone: Callable[[float], Image] | None = field(default=None, kw_only=True)

    @property
    def measures(self) -> dict[str, float]:
        """Its measures, code -> [mm]."""
        return measures_of(self.vertices, self.anatomy)


@lru_cache(maxsize=1)
def _template() -> tuple[Head, Shaper, dict[str | int, int]]:
    """The built-in head, its shaper, and the vertex of each point that a shape moves."""
    head = load("head")
    places = {
        point: int(head.landmarks[point] if isinstance(point, int) else head.anatomy[point])
        for pushes in SHAPES.values()
        for point, _ in pushes
    }
    return head, Shaper(head, list(places.values())), places


def make_person(identity: Identity) -> Person:
    """The head of an identity; the same numbers give the same head.

    Where its measures contradict each other, as in one of some hundreds, all of it is brought
    nearer to the mean, until they do not; the person's `identity` says what was made.
    """
    for share in NEARER[:-1]:
        with contextlib.suppress(AssetError):
            return _made(identity if share == 1.0 else identity.scaled(share))
    return _made(identity.scaled(NEARER[-1]))


def _made(identity: Identity) -> Person:
    """The head of an identity; AssetError where there is none, or its skin would be turned."""
    known, shaper, _ = _template()
    field = shaper.fit(identity.measures, _moves(identity.shapes), _moves(identity.unevenness))
    bent = field.points(known.vertices)
    eyes = tuple(_eye(known, eye, field, bent) for eye in known.eyes)
    vertices = lids_on_eyes(known, bent, eyes, LID_SHARES)
    normals = vertex_normals(vertices, known.faces)
    if identity.sex is Sex.WOMAN:
        vertices = vertices - (NECK_OF_WOMEN * _neck(known))[:, None] * normals
    turned = cross_products(vertices, known.faces) * cross_products(known.vertices, known.faces)
    if (turned.sum(axis=1) <= 0.0).any():
        raise AssetError("no head has these measures without turning a triangle")
    vertices.flags.writeable = False
    normals = vertex_normals(vertices, known.faces)
    skin = FittedSkin(vertices, normals, vertices[known.landmarks], known.mandible_weight)
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
        wrinkles=replace(known.wrinkles, resting=_resting(identity.age)),
        rig=known.rig,
        layers=known.layers,
        to_millimetres=Similarity(1.0, np.eye(3), np.zeros(3)),
        file_vertices=np.arange(len(vertices), dtype=np.int32),
        mandible_weight=known.mandible_weight,
        jaw_axis=field.points(known.jaw_axis),
        anatomy=known.anatomy,
        mirror=known.mirror,
        ambient_occlusion=known.ambient_occlusion,
        identity=identity,
    )


def _resting(years: float) -> float:
    """How far furrows show in a face at rest, 0 to 1."""
    past = float(np.clip((years - 30.0) / 45.0, 0.0, 1.0))
    return MOST_RESTING * past * past


def _neck(known: Head) -> FloatArray:
    """How far muscles and larynx stand out of the neck [mm], shape (V,)."""
    return np.asarray(neck_relief(*direction_coordinates(known.vertices), strip=STRIP))


def _moves(shapes: Mapping[str, float]) -> dict[int, FloatArray]:
    """How far vertices go [mm] for deviations of shapes."""
    moves: dict[int, FloatArray] = {}
    places = _template()[2]
    for name, score in shapes.items():
        for point, way in SHAPES[name]:
            vertex = places[point]
            moves[vertex] = moves.get(vertex, np.zeros(3)) + score * np.array(way)
    return {vertex: way for vertex, way in moves.items() if np.linalg.norm(way) > 1e-9}


def _eye(known: Head, eye: Eye, field: Field, vertices: FloatArray) -> Eye:
    """An eyeball in its new place; eyeballs differ less than their openings."""
    corners = known.landmarks[EYE_LANDMARKS[eye.name]][[0, 3]]
    before, now = (np.linalg.norm(np.diff(x[corners], axis=0)) for x in (known.vertices, vertices))
    scale = float(np.sqrt(now / before))
    centre = field.points(eye.centre[None])[0]
    return Eye(eye.name, centre, scale * eye.radius, scale * eye.iris_radius)
