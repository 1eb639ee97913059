"""Hair that stands off the head: short, shells over the scalp (render/shaders/shells.glsl).

part = hair_of("short", head.vertices, head.faces, behind, colour)

One surface tells the renderer where hair grows, how dense it is, and how far and which way each
strand goes; it moves with the skin. Strands run away from a whorl: one at the crown combs hair
forward and down, one in front brushes it back, one at a temple sweeps it aside.
After Lengyel, Praun, Finkelstein, Hoppe 2001, "Real-time fur over arbitrary surfaces".
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import NamedTuple

import numpy as np
from scipy.ndimage import map_coordinates

from risorius.geometry.normals import vertex_normals

from ..model import FloatArray, IndexArray, Part, SingleArray
from ..smooth import Points, Values, smooth_step, unit
from ..topology import grid_faces, quarter

HAIR = "hair"  # the name of the part
SHINE, DULL = 0.13, 0.6  # and how much of it curls have not
BALD = 40.0  # [mm] behind which the hairline lies where the top is bald
LEVELS = 2  # how often triangles of the scalp are cut into four
BULGE = 0.75  # of what the planes of an edge's ends would make of it
MEAN = 0.6  # of the strands' way, where the part's own vertices lie
LOOSE, LOOSE_STEPS, LOOSE_LENGTH, THIN = 260, 5, 22.0, 0.045  # single hairs; [mm] length, radius
RISE, STRAY, DROOP = (0.05, 0.4), 0.2, 0.2  # how far off, aside and down, of their length
CLEAR, SUNK = 0.7, 0.3  # [mm] over the skin, and down for each from 4 before the hairline on
FLAT = 0.0, 45.0  # [mm] behind the hairline hair lies flat, and stands as its cut says
PAINTED, HEM = 1.0, 20.0  # [mm] behind the hairline only hairs on the skin; until hair is dense


@dataclass(frozen=True)
class Cut:
    """How hair is cut and combed; all numbers of `CUTS` are chosen by eye.

    whorl: the way from the middle of the head to where strands begin (x left, y up, z ahead).
    sides, top: how long strands are [mm], on both sides and behind, and on top of the head.
    lift: the sine of the angle at which they stand off the head.
    behind: how far behind the hairline they are as long as that [mm].
    curl: how far strands are no lines but curls, 0 to 1.
    """

    whorl: tuple[float, float, float]
    sides: float
    top: float
    lift: float
    behind: float = 25.0
    curl: float = 0.0


@dataclass(frozen=True)
class Fall:
    """How hair falls that is long enough to, beside the face; chosen by eye, all in [mm].

    parting: from the middle of the face, to the subject's left, to where it parts.
    below: how far below the ears it ends. slant: how much higher it does so in front than at the
    sides, and lower behind. layered: how much higher beside the face. wave: how far its
    waves swing. tucked: the side where it lies behind the ear, 1 the subject's left; 0: none.
    """

    parting: float
    below: float
    slant: float = 0.0
    layered: float = 8.0
    wave: float = 0.6
    tucked: float = 0.0


OWN_CUT = Cut((0.1, 0.75, -0.6), 6.0, 21.0, 0.5, behind=50.0)  # of the built-in head
CUTS: Mapping[str, Cut | Fall] = MappingProxyType(
    {
        "cropped": Cut((0.1, 0.75, -0.6), 2.5, 4.5, 0.6, behind=20.0),
        "parted": Fall(26.0, 77.0, slant=-8.0),
        "tucked": Fall(24.0, 93.0, slant=8.0, tucked=1.0),
        "centred": Fall(0.0, 123.0, slant=12.0, layered=30.0),
        "wavy": Fall(-6.0, 105.0, slant=10.0, layered=24.0, wave=4.5),
        "aside": Fall(-22.0, 97.0, slant=6.0, layered=36.0, wave=1.6),
        "tied": Cut((0.0, 0.3, 0.95), 16.0, 18.0, 0.14, behind=9.0),
        "short": OWN_CUT,
        "fringed": Cut((0.35, 0.75, -0.4), 16.0, 24.0, 0.24, behind=34.0),
        "swept": Cut((0.85, 0.1, 0.55), 9.0, 28.0, 0.35, behind=18.0),
        "brushed": Cut((0.15, 0.4, 0.9), 9.0, 28.0, 0.35, behind=18.0),
        "curly": Cut((0.1, 0.75, -0.6), 9.0, 20.0, 0.8, behind=18.0, curl=1.0),
    }
)


@dataclass(frozen=True)
class Hairline:
    """Where hair begins, beside the built-in head's: how far behind [mm].

    front, temples: in the middle, and more at the corners of the forehead.
    crown: how bald the top is, 0 to 1.
    """

    front: float = 0.0
    temples: float = 0.0
    crown: float = 0.0

    def shift(self, size: int) -> SingleArray:
        """How far it lies behind the built-in head's [mm], (size, size)."""
        across, up = np.linspace(-0.5, 0.5, size), np.linspace(1.0, 0.0, size)[:, None]
        row = self.front * np.exp(-((across / 0.17) ** 4))
        row += self.temples * np.exp(-(((np.abs(across) - 0.12) / 0.05) ** 2))
        ahead = 1.0 - smooth_step(0.74, 0.82, up)
        top = np.exp(-((across / 0.14) ** 2) - ((up - 0.78) / 0.15) ** 2)
        return (row * ahead + self.crown * BALD * top).astype(np.float32)


def drawn_hairline(is_man: bool, years: float, random: np.random.Generator) -> Hairline:
    """The hairline of somebody of a sex and age.

    It is straight, round, or like an M as often as among 456 persons (women 43, 39, 18 %, men 46,
    11, 43 %); men's lies 4.5 mm higher (Kashiyama and others 2021, "Hairline morphology", Plast.
    Reconstr. Surg. Glob. Open 9:e3765). Its recession is chosen.
    """
    kind, _, share, bald = random.uniform(0.0, 1.0, 4)
    front = float(np.clip(random.normal(0.0, 3.0), -6.0, 6.0))
    straight, round_ = (0.46, 0.57) if is_man else (0.43, 0.82)
    temples = 0.0 if kind < straight else -5.0 if kind < round_ else 6.0 + 6.0 * share
    late = max(years - 25.0, 0.0) / 50.0
    receded = 22.0 * late * share**0.7 if is_man else 3.0 * late
    return Hairline(
        front=(0.5 if is_man else -2.0) + front + 0.6 * receded,
        temples=temples + (receded if is_man else 0.0),
        crown=float(is_man and bald < 0.5 * late),
    )


class Scalp(NamedTuple):
    """Where hair grows: vertices (n, 3) [mm], unit normals, faces, and mm behind the hairline."""

    points: Points
    normals: Points
    faces: IndexArray
    behind: Values


def hair_of(cut: Cut, scalp: Scalp, colour: FloatArray, length: float) -> tuple[Part, ...]:
    """The parts drawn as hair; colour: sRGB, shape (3,); length: beside that of the cut."""
    points, normals, faces, behind = scalp
    middle = 0.5 * (points.min(axis=0) + points.max(axis=0))
    whorl = unit(np.array([cut.whorl]))[0]
    beside = unit(np.cross([[0.0, 0.3, 1.0]], whorl))[0]
    out = points - middle
    angle = np.arctan2(out @ np.cross(whorl, beside), out @ beside)
    faces = faces[(behind[faces] > PAINTED).any(axis=1)]
    # Where angles begin anew strands do not cross from one side to the other.
    crosses = np.ptp(angle[faces], axis=1) > np.pi
    again, number = np.unique(faces[crosses], return_inverse=True)
    faces[crosses] = len(points) + number.reshape(-1, 3)
    angle = np.concatenate([angle, angle[again] + 2.0 * np.pi * (angle[again] < 0.0)])
    used, number = np.unique(faces, return_inverse=True)
    faces, angle = number.reshape(-1, 3).astype(np.int32), angle[used]
    rows = np.concatenate([np.arange(len(points)), again])[used]
    points, normals, behind, out = points[rows], normals[rows], behind[rows], unit(out[rows])
    away = np.arccos(np.clip(out @ whorl, -1.0, 1.0))
    radius = np.linalg.norm(points - middle, axis=1).mean()
    comb = unit(np.cross(np.cross(whorl, out), normals))
    long = cut.sides + (cut.top - cut.sides) * smooth_step(0.1, 0.7, normals[:, 1])
    long = length * long * smooth_step(0.0, cut.behind, behind)
    lift = cut.lift * smooth_step(*FLAT, behind)[:, None]
    way = long[:, None] * (lift * normals + np.sqrt(1.0 - lift**2) * comb)
    off = CLEAR * smooth_step(-2.0, 8.0, behind) + SUNK * np.minimum(behind + 4.0, 0.0)
    points = points + off[:, None] * normals
    curled = 1.0 + 2.0 * cut.curl, 1.0 - 0.45 * cut.curl  # soon another strand, and wider
    uneven = 2.0 * np.sin(0.22 * radius * angle) + 1.5 * np.sin(0.57 * radius * angle + 1.0)
    dense = np.minimum((behind - PAINTED + uneven) / HEM, 2.0)
    striation = np.column_stack([curled[1] * radius * angle, curled[0] * radius * away, way, dense])
    hair = Part(
        name=HAIR,
        vertices=(points + MEAN * way).astype(np.float32),
        normals=normals.astype(np.float32),
        faces=faces,
        colours=np.tile(colour, (len(points), 1)).astype(np.float32),
        bone="cranium",
        shine=SHINE * (1.0 - DULL * cut.curl),
        striation=striation.astype(np.float32),
    )
    return loose_hairs([hair], min(0.5 * length * cut.top, LOOSE_LENGTH)), hair


def loose_hairs(hair: Sequence[Part], length: float) -> Part:
    """Single hairs, `length` [mm] long, that stand off the smooth outline of parts."""
    random, t = np.random.default_rng(0), np.linspace(0.0, 1.0, LOOSE_STEPS)[:, None, None]
    names = "vertices", "normals", "colours", "striation"
    rows = [np.hstack([getattr(part, each) for each in names])[part.faces] for part in hair]
    corners = np.concatenate(rows).astype(np.float64)
    corners = random.choice(corners[corners[:, :, 14].min(axis=1) > 0.5], LOOSE)
    found = np.einsum("nij,ni->nj", corners, random.dirichlet((1.0, 1.0, 1.0), LOOSE))
    root, normal, colour, _, way, _ = np.split(found, [3, 6, 9, 11, 14], axis=1)
    normal = unit(normal)
    across = unit(np.cross(normal, way))
    off, aside = random.uniform(*RISE, (LOOSE, 1)), random.normal(0.0, STRAY, (LOOSE, 1))
    along = length * (np.cross(across, normal) + off * normal + aside * across)
    bent = length * DROOP * (normal + np.array([0.0, 1.0, 0.0]))
    turn = np.radians([0.0, 120.0, 240.0])[:, None]
    ring = np.cos(turn) * normal[:, None] + np.sin(turn) * across[:, None]
    places = root[:, None, None] + t * along[:, None, None] - t * t * bent[:, None, None]
    places = places + THIN * ring[:, None]
    numbers = np.arange(places.size // 3).reshape(places.shape[:3])
    return replace(
        hair[0],
        name=HAIR + "_loose",
        vertices=places.reshape(-1, 3).astype(np.float32),
        normals=np.broadcast_to(ring[:, None], places.shape).reshape(-1, 3).astype(np.float32),
        faces=np.concatenate([grid_faces(each, closed=True) for each in numbers]),
        colours=np.repeat(colour, LOOSE_STEPS * 3, axis=0).astype(np.float32),
        strand_radius=THIN,
        striation=None,
    )


def scalp_of(vertices: Points, faces: IndexArray, uv: Points, behind: SingleArray) -> Scalp:
    """The scalp of a head, finer than its mesh and round between its corners.

    uv: of vertices, shape (V, 2). behind: how far texels lie behind the hairline [mm], (H, W).
    Source: Boubekeur, Alexa 2008, "Phong tessellation".
    """
    height, width = behind.shape

    def far(places: Points) -> Values:
        """How far places on the texture lie behind the hairline [mm]."""
        at = [(1.0 - places[:, 1]) * height - 0.5, places[:, 0] * width - 0.5]
        return np.asarray(map_coordinates(behind, at, order=1, mode="nearest"), np.float64)

    used, number = np.unique(faces[(far(uv) > 0.0)[faces].any(axis=1)], return_inverse=True)
    faces, normals = number.reshape(-1, 3).astype(np.int32), vertex_normals(vertices, faces)[used]
    points, uv = vertices[used], uv[used]
    for _ in range(LEVELS):
        cut = quarter(faces, len(points))
        faces, ends = cut.faces, points[cut.edges]
        middle = ends.mean(axis=1, keepdims=True)
        # Where skin is hollow its triangles, which may be seen, lie over it.
        above = ((middle - ends) * normals[cut.edges]).sum(axis=2, keepdims=True)
        bulge = -BULGE * (np.minimum(above, 0.0) * normals[cut.edges]).mean(axis=1)
        points = np.vstack([points, middle[:, 0] + bulge])
        normals = np.vstack([normals, unit(normals[cut.edges].mean(axis=1))])
        uv = np.vstack([uv, uv[cut.edges].mean(axis=1)])
    return Scalp(points, normals, faces, far(uv))
