"""Make the head of another person from the built-in head: same triangles, texture and muscles.

    person = make_person(sample_identity(7))

The skin is the mean person, displaced by weighted modes (space.py). Then the eyeballs are placed,
and the lids are laid on them.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np
import scipy

from ...geometry.arrays import Floats32, Floats64, Integers32
from ...geometry.intersections import self_intersections
from ...geometry.normals import cross_products, vertex_normals
from ...geometry.steps import smoothstep
from ..data_files import Image
from ..errors import AssetError
from ..fitting.head import FittedHead
from ..fitting.mouth_walls import FittedSkin, opened_jaws
from ..fitting.organs import EYE_LANDMARK_RANGES, lids_on_eyes, place_parts
from ..fitting.warp import Similarity, ThinPlateSpline
from ..loading import load
from ..model import Eye, Head
from ..norms import measures_of
from .ears import with_ears
from .necks import below_jaw, evened_neck
from .shirts import NECK_AXIS, with_wide_band
from .smiles import smiling
from .sockets import without_ridges
from .space import Identity, Sex, person_space, scores_of


@dataclass(frozen=True)
class Person(FittedHead):
    """A head with the triangles of the built-in head. It adds these fields to a fitted head:

    - mandible_weight, jaw_axis, anatomy: as in `Head`.
    - mirror: as in the built-in head, although the left and the right half may differ.
    - identity: weights of the modes, and features.
    - in_tone: makes the albedo (H, W, 3) for another skin tone, ITA [deg].
    - stubble: its density in a small map of the texture, 0 to 1; None: no stubble.
    """

    mandible_weight: Floats64
    jaw_axis: Floats64 = field(kw_only=True)
    anatomy: Mapping[str, int]
    mirror: Integers32
    identity: Identity
    in_tone: Callable[[float], Image] | None = field(default=None, kw_only=True)
    stubble: Floats32 | None = field(default=None, kw_only=True)

    def fade(self) -> None:
        """Do nothing: a shirt covers the lower edge of a person's neck."""

    @property
    def measures(self) -> dict[str, float]:
        """The measures of the person: code -> length [mm]."""
        return measures_of(self.vertices, self.anatomy)

    @property
    def scores(self) -> dict[str, float]:
        """Deviations of the measures from the mean of the person's sex: code -> z-score."""
        return scores_of(self.measures, self.identity.sex)


def make_person(identity: Identity) -> Person:
    """Make the head of an identity; the same identity always gives the same head.

    If triangles of the skin would turn over or intersect, the weights are scaled down. The person's
    `identity` has the scaled weights.
    """
    factors = (1.0, 0.85, 0.7, 0.5, 0.25, 0.0)  # factors on the weights, tried in this order
    for factor in factors[:-1]:
        with contextlib.suppress(AssetError):
            return _make_head(identity if factor == 1.0 else identity.scaled(factor))
    return _make_head(identity.scaled(factors[-1]))


class _Form(NamedTuple):
    """The form of a person.

    vertices: the skin [mm], (V, 3), read only. eyes: the eyeballs. chin: the menton [mm], (3,).
    """

    vertices: Floats64
    eyes: tuple[Eye, ...]
    chin: Floats64


def _form_of(known: Head, identity: Identity) -> _Form:
    """Shape the skin of an identity; raises AssetError if it turns over or intersects itself."""
    space = person_space()
    beside = known.vertices[:, :1]
    middle_width = 20.0  # [mm] beside the midline, over which the unevenness changes its sign
    askew = space.moved(np.array(identity.unevenness)) * beside / np.hypot(beside, middle_width)
    bent = space.mean + space.moved(np.array(identity.weights)) + askew
    eyes = tuple(_eye(known, eye, bent) for eye in known.eyes)
    bent = without_ridges(_resting_face(known, bent, eyes, identity))
    lid_fractions = (1.0, 1.0, 1.0, 0.6, 0.25)  # how far each ring around the eye is moved onto it
    vertices = lids_on_eyes(known, bent, eyes, lid_fractions)
    chin = vertices[known.anatomy["menton"]]
    vertices = with_ears(evened_neck(vertices), identity.ears)
    vertices = _on_neck(vertices, chin, identity.sex)
    normals = cross_products(vertices, known.faces)
    cosines = (normals * cross_products(known.vertices, known.faces)).sum(axis=1)
    if (cosines <= 0.0).any() or len(self_intersections(vertices, known.faces)):
        raise AssetError(
            "these weights make no face: a triangle of skin is turned over, or intersects another"
        )
    vertices.flags.writeable = False
    return _Form(vertices, eyes, chin)


def _make_head(identity: Identity) -> Person:
    """Make the head of an identity; if its skin turns over or intersects, raises AssetError."""
    known = load("head")
    vertices, eyes, chin = _form_of(known, identity)
    named = _named_vertices(known)
    spread = np.var(vertices[named], axis=0).sum()
    usual_spread = np.var(known.vertices[named], axis=0).sum()
    larger = float(np.sqrt(spread / usual_spread))
    give = 0.2  # smoothing of the warp that organs follow
    warp = ThinPlateSpline(known.vertices[named], vertices[named], give)
    normals = vertex_normals(vertices, known.faces)
    landmarks = vertices[known.landmarks]
    skin = FittedSkin(vertices, normals, known.faces, landmarks, known.mandible_weight)
    jaw_axis = warp.points(known.jaw_axis)
    jaws = opened_jaws(jaw_axis, known.rig)
    parts = []
    for part in place_parts(known, skin, warp, eyes, jaws, kept_bone="neck"):
        if part.bone == "neck":
            moved = _on_neck(part.vertices.astype(float), chin, identity.sex)
            part = replace(part, vertices=moved.astype(np.float32))
            part = with_wide_band(part, vertices[known.faces])
        parts.append(part)
    return Person(
        vertices=vertices,
        faces=known.faces,
        landmarks=known.landmarks,
        bone_depth=larger * known.bone_depth,
        eyes=eyes,
        parts=tuple(parts),
        uv=known.uv,
        face_uv=known.face_uv,
        albedo=known.albedo,
        segments=known.segments,
        wrinkles=replace(known.wrinkles, resting=_resting_furrows(known, identity)),
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
    """Narrow women's necks: move points (n, 3) of skin or shirt below the jaw toward the axis.

    chin: the menton [mm], (3,).
    """
    below = below_jaw(points, chin)[:, None]
    # Necks measure 330 mm around in women and 398 mm in men (Gordon and others 2014, ANSUR II).
    narrowing = 0.17
    # [mm] below the jaw over which narrowing begins. It gives 322 to 338 mm around the larynx;
    # within 30 mm, necks of women would have a corner behind the jaw.
    fade_height = 60.0
    narrower = narrowing * (sex is Sex.WOMAN) * smoothstep(below, 0.0, fade_height)
    return np.asarray(points - narrower * [1.0, 0.0, 1.0] * (points - NECK_AXIS))


def _resting_face(
    known: Head, vertices: Floats64, eyes: tuple[Eye, ...], identity: Identity
) -> Floats64:
    """Move lids, corners of the mouth and brows to an identity's rest; returns vertices (V, 3)."""
    x = vertices.copy()
    lower_lid_height = -0.96  # above the pupil, in radii of the iris
    row_weights = (1.0, 1.0, 1.0, 0.7, 0.25)  # weights of the rings around the eye in this motion
    for eye in eyes:
        upper = 1.0 - identity.covered / eye.iris_radius
        for lid, height in (("superius", upper), ("inferius", lower_lid_height)):
            middle = vertices[known.anatomy[f"palpebrale_{lid}_{eye.name}"]]
            moved = eye.centre[1] + height * eye.iris_radius - middle[1]
            for row, weight in enumerate(row_weights):
                ring = known.rings[f"eye_{row}_{eye.name}"]
                inner, outer = vertices[ring[[0, len(ring) // 2]]]
                along = (vertices[ring, 0] - inner[0]) / (outer[0] - inner[0])
                between_corners = inner[1] + along * (outer[1] - inner[1])
                is_above = vertices[ring, 1] > between_corners
                open_ = np.sqrt(np.clip(1.0 - (2.0 * along - 1.0) ** 2, 0.0, 1.0))
                x[ring, 1] += weight * moved * open_ * (is_above == (lid == "superius"))
    # Brows move tangentially to the forehead; touching lips move together.
    normals = vertex_normals(vertices, known.faces)
    up = np.array([0.0, 1.0, 0.0])
    corners = vertices[known.landmarks[[48, 54]], 1].mean()
    middle = vertices[known.landmarks[[62, 66]], 1].mean()
    most_turn = 1.8  # [mm]; greatest motion of the corners of the mouth
    turned = np.clip(identity.corners - corners + middle, -most_turn, most_turn)
    corner_radius = 9.0  # [mm] within which skin follows the corners of the mouth
    brow_radius = 11.0  # [mm] within which skin follows the brows
    for points, displacement, wide in (
        (known.landmarks[48:55:6], turned * up, corner_radius),
        (known.landmarks[17:27], identity.brows * (up - normals[:, 1:2] * normals), brow_radius),
    ):
        away = scipy.spatial.cKDTree(vertices[points]).query(vertices)[0]
        x += np.exp(-((away / wide) ** 2))[:, None] * displacement
    return x


def _resting_furrows(known: Head, identity: Identity) -> Floats32:
    """Return the strength of furrows at rest, 0 to 1, (V,); between the brows it is low."""
    past = float(np.clip((identity.age - 30.0) / 45.0, 0.0, 1.0))
    off = known.vertices - known.vertices[known.anatomy["glabella"]]
    # [mm] around the glabella in x, y and z, where furrows of age would look like a frown.
    frown_radii = np.array([15.0, 18.0, 30.0])
    frowned = np.exp(-((off / frown_radii) ** 2).sum(axis=1))
    most_resting = {Sex.WOMAN: 0.45, Sex.MAN: 0.5}
    shown = most_resting[identity.sex] * identity.furrows * past * past * (1.0 - frowned)
    return np.asarray(np.minimum(shown * _own_places(known, identity), 1.0), np.float32)


def _own_places(known: Head, identity: Identity) -> Floats64:
    """Draw depths of furrows at vertices, relative to most people of the same age, (V,).

    The factor varies in random waves over the face, equally on both halves. This is assumed.
    """
    phases = np.array([identity.age, identity.covered]).view(np.uint32)
    random = np.random.default_rng(phases)
    wave_count = 5
    length = 60.0  # [mm]; mean wavelength
    wave_vectors = random.normal(0.0, 2.0 * np.pi / length, (3, wave_count)) / np.sqrt(3.0)
    begins = random.uniform(0.0, 2.0 * np.pi, wave_count)
    halves = np.abs(known.vertices * [1.0, 0.0, 0.0]) + known.vertices * [0.0, 1.0, 1.0]
    waves = np.cos(halves @ wave_vectors + begins).sum(axis=1) / np.sqrt(0.5 * wave_count)
    return np.asarray(np.clip(1.0 + 0.55 * waves, 0.15, 1.5))


def _named_vertices(known: Head) -> Integers32:
    """Return the vertices that organs follow: landmarks, anatomy, rings of lips and lids."""
    rows = [row for name, row in known.rings.items() if name.startswith(("mouth_", "eye_1"))]
    return np.unique(np.concatenate([known.landmarks, list(known.anatomy.values()), *rows]))


def _eye(known: Head, eye: Eye, vertices: Floats64) -> Eye:
    """Place an eyeball behind its lids; its size varies less than the opening of the lids."""
    corners = known.landmarks[EYE_LANDMARK_RANGES[eye.name]][[0, 3]]
    known_width = np.linalg.norm(np.diff(known.vertices[corners], axis=0))
    width = np.linalg.norm(np.diff(vertices[corners], axis=0))
    scale = float(np.sqrt(width / known_width))
    lids = known.rings[f"eye_1_{eye.name}"]
    behind = eye.centre - known.vertices[lids].mean(axis=0)
    centre = vertices[lids].mean(axis=0) + scale * behind
    return Eye(eye.name, centre, scale * eye.radius, scale * eye.iris_radius)
