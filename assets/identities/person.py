"""A head of another person, made from the built-in one: same triangles, texture and muscles.

    person = make_person(sample_identity(7))

The skin is the mean person, moved by the modes with the identity's weights (space.py). Then
eyeballs are placed, and lids are laid on them.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

import numpy as np
import scipy

from risorius.geometry.normals import cross_products, vertex_normals

from ...geometry.arrays import Floats32, Floats64, Integers32
from ..data_files import Image
from ..errors import AssetError
from ..fitting.head import FittedHead
from ..fitting.mouth_walls import FittedSkin, opened_jaws
from ..fitting.organs import EYE_LANDMARKS, lids_on_eyes, place_parts
from ..fitting.warp import Similarity, ThinPlateSpline
from ..intersections import self_intersections
from ..loading import load
from ..model import Eye, Head
from ..norms import measures_of
from ..smooth import smooth_step
from .smiles import smiling
from .space import Identity, Sex, person_space, scores_of


@dataclass(frozen=True)
class Person(FittedHead):
    """A head with the triangles of the built-in one. Besides the fields of a fitted head it has:

    mandible_weight, jaw_axis, anatomy, mirror: as in `Head`. `mirror` is that of the built-in head,
        even if left and right differ.
    identity: its weights and features.
    in_tone: makes the texture in another tone, from the angle of `recoloured` [deg].
    """

    mandible_weight: Floats64
    jaw_axis: Floats64 = field(kw_only=True)
    anatomy: Mapping[str, int]
    mirror: Integers32
    identity: Identity
    in_tone: Callable[[float], Image] | None = field(default=None, kw_only=True)

    def fade(self) -> None:
        """A shirt covers the edge of its neck."""

    @property
    def measures(self) -> dict[str, float]:
        """The measures of the person, code -> [mm]."""
        return measures_of(self.vertices, self.anatomy)

    @property
    def scores(self) -> dict[str, float]:
        """Deviations of the measures from the means of the person's sex, code -> score."""
        return scores_of(self.measures, self.identity.sex)


def make_person(identity: Identity) -> Person:
    """The head of an identity; the same numbers give the same head.

    If its skin would turn over or cut itself, the whole face is brought nearer to the mean; the
    person's `identity` has the used weights.
    """
    shares = (1.0, 0.85, 0.7, 0.5, 0.25, 0.0)  # shares of the weights, tried in turn
    for share in shares[:-1]:
        with contextlib.suppress(AssetError):
            return _made(identity if share == 1.0 else identity.scaled(share))
    return _made(identity.scaled(shares[-1]))


def _made(identity: Identity) -> Person:
    """The head of an identity; raises AssetError if its skin would turn over or cut itself."""
    known = load("head")
    space = person_space()
    beside = known.vertices[:, :1]
    middle_width = 20.0  # [mm] beside the middle, over which an uneven face goes to its own side
    askew = space.moved(np.array(identity.unevenness)) * beside / np.hypot(beside, middle_width)
    bent = space.mean + space.moved(np.array(identity.weights)) + askew
    eyes = tuple(_eye(known, eye, bent) for eye in known.eyes)
    bent = _resting_face(known, bent, eyes, identity)
    lid_shares = (1.0, 1.0, 1.0, 0.6, 0.25)  # shares by which rows around the eye are laid on it
    vertices = lids_on_eyes(known, bent, eyes, lid_shares)
    neck = vertices[known.anatomy["menton"]], identity.sex
    vertices = _on_neck(vertices, *neck)
    turned = cross_products(vertices, known.faces) * cross_products(known.vertices, known.faces)
    if (turned.sum(axis=1) <= 0.0).any() or len(self_intersections(vertices, known.faces)):
        raise AssetError(
            "no person has these weights: a triangle of the skin is turned over, or cuts another"
        )
    vertices.flags.writeable = False
    named = _named(known)
    spread, usual = (np.var(x[named], 0).sum() for x in (vertices, known.vertices))
    larger = float(np.sqrt(spread / usual))
    give = 0.2  # smoothing of the warp that organs in the head follow
    warp = ThinPlateSpline(known.vertices[named], vertices[named], give)
    normals = vertex_normals(vertices, known.faces)
    landmarks = vertices[known.landmarks]
    skin = FittedSkin(vertices, normals, known.faces, landmarks, known.mandible_weight)
    jaw_axis = warp.points(known.jaw_axis)
    jaws = opened_jaws(jaw_axis, known.rig)
    parts = place_parts(known, skin, warp, eyes, jaws, kept_bone="neck")
    return Person(
        vertices=vertices,
        faces=known.faces,
        landmarks=known.landmarks,
        bone_depth=larger * known.bone_depth,
        eyes=eyes,
        parts=tuple(
            replace(part, vertices=_on_neck(part.vertices.astype(float), *neck).astype(np.float32))
            if part.bone == "neck"
            else part
            for part in parts
        ),
        uv=known.uv,
        face_uv=known.face_uv,
        albedo=known.albedo,
        segments=known.segments,
        wrinkles=replace(known.wrinkles, resting=_resting(known, identity)),
        rig=known.rig,
        layers=smiling(known.layers, identity.smile),
        to_millimetres=Similarity(1.0, np.eye(3), np.zeros(3)),
        file_vertices=np.arange(len(vertices), dtype=np.int32),
        mandible_weight=known.mandible_weight,
        jaw_axis=jaw_axis,
        anatomy=known.anatomy,
        mirror=known.mirror,
        ambient_occlusion=known.ambient_occlusion,
        fine_shape=known.fine_shape,
        identity=identity,
    )


def _on_neck(points: Floats64, chin: Floats64, sex: Sex) -> Floats64:
    """Points of a skin or a shirt; those below the jaw are moved to a neck of that sex."""
    jaw_slope = 0.35  # of the jaw's line, rising to the back
    jaw_depth = 20.0  # [mm] where it ends
    below = chin[1] - points[:, 1:2] + jaw_slope * (chin[2] - np.maximum(points[:, 2:], jaw_depth))
    # Share for women's necks: 330 mm around, men's 398 (Gordon and others 2014, ANSUR II).
    narrowing = 0.17
    fade_height = 30.0  # [mm] below the jaw, over which the neck begins
    narrower = narrowing * (sex is Sex.WOMAN) * smooth_step(0.0, fade_height, below)
    neck_axis = np.array([0.0, 0.0, -8.0])  # [mm]
    return np.asarray(points - narrower * [1.0, 0.0, 1.0] * (points - neck_axis))


def _resting_face(
    known: Head, vertices: Floats64, eyes: tuple[Eye, ...], identity: Identity
) -> Floats64:
    """Vertices with the resting lids, corners of the mouth and brows of an identity."""
    x = vertices.copy()
    lower_lid_height = -0.96  # in radii of the iris
    row_shares = (1.0, 1.0, 1.0, 0.7, 0.25)  # shares of rows around the eye in the lid's motion
    for eye in eyes:
        upper = 1.0 - identity.covered / eye.iris_radius
        for lid, height in (("superius", upper), ("inferius", lower_lid_height)):
            middle = vertices[known.anatomy[f"palpebrale_{lid}_{eye.name}"]]
            moved = eye.centre[1] + height * eye.iris_radius - middle[1]
            for row, share in enumerate(row_shares):
                ring = known.rings[f"eye_{row}_{eye.name}"]
                inner, outer = vertices[ring[[0, len(ring) // 2]]]
                along = (vertices[ring, 0] - inner[0]) / (outer[0] - inner[0])
                is_above = vertices[ring, 1] > inner[1] + along * (outer[1] - inner[1])
                open_ = np.sqrt(np.clip(1.0 - (2.0 * along - 1.0) ** 2, 0.0, 1.0))
                x[ring, 1] += share * moved * open_ * (is_above == (lid == "superius"))
    # Brows slide over the forehead; touching lips move in one direction.
    normals = vertex_normals(vertices, known.faces)
    up = np.array([0.0, 1.0, 0.0])
    line = vertices[known.landmarks[[48, 54, 62, 66]], 1]
    most_turn = 1.8  # [mm] that corners of the mouth turn
    turned = np.clip(identity.corners - line[:2].mean() + line[2:].mean(), -most_turn, most_turn)
    corner_radius = 9.0  # [mm] about corners of the mouth: skin there follows them
    brow_radius = 11.0  # [mm] about brows
    for points, way, wide in (
        (known.landmarks[48:55:6], turned * up, corner_radius),
        (known.landmarks[17:27], identity.brows * (up - normals[:, 1:2] * normals), brow_radius),
    ):
        away = scipy.spatial.cKDTree(vertices[points]).query(vertices)[0]
        x += np.exp(-((away / wide) ** 2))[:, None] * way
    return x


def _resting(known: Head, identity: Identity) -> Floats32:
    """How far furrows show in a face at rest, 0 to 1, shape (V,); not between the brows."""
    past = float(np.clip((identity.age - 30.0) / 45.0, 0.0, 1.0))
    off = known.vertices - known.vertices[known.anatomy["glabella"]]
    # [mm] about the glabella, where furrows of age would look like a frown.
    frown_radii = np.array([15.0, 18.0, 30.0])
    frowned = np.exp(-((off / frown_radii) ** 2).sum(axis=1))
    most_resting = {Sex.WOMAN: 0.45, Sex.MAN: 0.5}
    shown = most_resting[identity.sex] * identity.furrows * past * past * (1.0 - frowned)
    return np.asarray(np.minimum(shown * _own_places(known, identity), 1.0), np.float32)


def _own_places(known: Head, identity: Identity) -> Floats64:
    """Depths of furrows at each vertex, relative to most people of that age, shape (V,).

    Chosen: waves over the face, with the person's phases; both halves are alike.
    """
    phases = np.array([identity.age, identity.covered]).view(np.uint32)
    random = np.random.default_rng(phases)
    wave_count = 5
    length = 60.0  # [mm] of a wave on average
    ways = random.normal(0.0, 2.0 * np.pi / length, (3, wave_count)) / np.sqrt(3.0)
    begins = random.uniform(0.0, 2.0 * np.pi, wave_count)
    halves = np.abs(known.vertices * [1.0, 0.0, 0.0]) + known.vertices * [0.0, 1.0, 1.0]
    waves = np.cos(halves @ ways + begins).sum(axis=1) / np.sqrt(0.5 * wave_count)
    return np.asarray(np.clip(1.0 + 0.55 * waves, 0.15, 1.9))


def _named(known: Head) -> Integers32:
    """Vertices that organs in the head follow: landmarks, named points, rows of lips and lids."""
    rows = [row for name, row in known.rings.items() if name.startswith(("mouth_", "eye_1"))]
    return np.unique(np.concatenate([known.landmarks, list(known.anatomy.values()), *rows]))


def _eye(known: Head, eye: Eye, vertices: Floats64) -> Eye:
    """An eyeball behind its lids; eyeballs differ less than their openings."""
    corners = known.landmarks[EYE_LANDMARKS[eye.name]][[0, 3]]
    before, now = (np.linalg.norm(np.diff(x[corners], axis=0)) for x in (known.vertices, vertices))
    scale = float(np.sqrt(now / before))
    lids = known.rings[f"eye_1_{eye.name}"]
    behind = eye.centre - known.vertices[lids].mean(axis=0)
    centre = vertices[lids].mean(axis=0) + scale * behind
    return Eye(eye.name, centre, scale * eye.radius, scale * eye.iris_radius)
