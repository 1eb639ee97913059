"""Short hair, drawn as shells: copies of the scalp at rising heights (render/shaders/shells.glsl).

One surface over the scalp moves with the skin. Its vertices give the renderer the density of hair,
and the length and direction of strands. Strands run away from a whorl. A whorl at the crown combs
hair forward and down, one in front brushes it back, and one at a temple sweeps it aside.
After Lengyel, Praun, Finkelstein, Hoppe 2001, "Real-time fur over arbitrary surfaces".
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import NamedTuple

import numpy as np
import scipy

from ...geometry.arrays import Flags, Floats32, Floats64, Integers32, Integers64
from ...geometry.closest import closest_points
from ...geometry.directions import unit_vectors
from ...geometry.normals import vertex_normals
from ...geometry.steps import smoothstep
from ..model import Part
from ..topology import quarter
from .locks import MEAN_PLACE, SHORT_HAIR, TIED_HAIR, locks_on, waves

HAIR_NAME = "hair"  # the name of the part
SLEEK_GLOSS = 0.4  # specular strength of hair that is combed smooth
FRAYED_RISES = 0.5, 2.5  # [mm] of tips over roots, where outlines begin to fray, and fray fully
# [mm] behind the hairline, likewise. Before, the inner side of hair closes the wedge below its hem.
FRAYED_DEPTHS = 35.0, 60.0
LENGTHWISE_FACTOR = 0.22  # factor on lengths along long strands, whose pattern changes more slowly


@dataclass(frozen=True)
class Cut:
    """The cut and the combing of hair; all numbers of `HAIR_CUTS` are chosen by eye.

    whorl: direction from the head's centre to the whorl (x left, y up, z forward).
    sides: length of strands on the sides and the back of the head [mm].
    top: length of strands on top of the head [mm].
    lift: sine of the angle between strands and skin.
    behind: distance behind the hairline at which strands reach their full length [mm].
    knot: half the width of the knot or tail into which hair is tied [mm]; 0: hair is not tied.
    tail: length of a hanging tail [mm]; 0: tied hair is wound into a knot.
    aside: distance by which a tail hangs farther to the subject's right, per millimetre down.
    """

    whorl: tuple[float, float, float]
    sides: float
    top: float
    lift: float
    behind: float = 25.0
    knot: float = 0.0
    tail: float = 0.0
    aside: float = 0.0


@dataclass(frozen=True)
class Fall:
    """The shape of long hair that hangs beside the face; chosen by eye.

    parting: distance of the parting from the face's midline [mm], positive to the subject's left.
    below: distance from the ears down to the tips [mm].
    """

    parting: float
    below: float


OWN_CUT = Cut((0.1, 0.75, -0.6), 6.0, 21.0, 0.5, behind=50.0)  # cut of the built-in head
HAIR_CUTS: Mapping[str, Cut | Fall] = MappingProxyType(
    {
        "cropped": Cut((0.1, 0.75, -0.6), 2.5, 4.5, 0.6, behind=20.0),
        "parted": Fall(26.0, 77.0),
        "centred": Fall(0.0, 123.0),
        "aside": Fall(-22.0, 97.0),
        "knotted": Cut((0.62, 0.52, 0.59), 18.0, 32.0, 0.45, behind=45.0, knot=36.0),
        "topknot": Cut((0.0, -0.95, 0.32), 18.0, 26.0, 0.45, behind=45.0, knot=36.0),
        "tailed": Cut(
            (0.38, -0.3, 0.87), 18.0, 32.0, 0.45, behind=45.0, knot=27.0, tail=240.0, aside=0.5
        ),
        "short": OWN_CUT,
        "swept": Cut((0.85, 0.1, 0.55), 9.0, 28.0, 0.35, behind=18.0),
        "brushed": Cut((0.15, 0.4, 0.9), 9.0, 28.0, 0.35, behind=18.0),
    }
)


def is_tied(name: str) -> bool:
    """Whether a cut of `HAIR_CUTS`, given by name, is tied behind the head."""
    cut = HAIR_CUTS[name]
    return isinstance(cut, Cut) and cut.knot > 0.0


class Scalp(NamedTuple):
    """The skin on which hair grows, as a triangle mesh.

    points: vertices [mm], (n, 3).
    normals: unit normals of the vertices, (n, 3).
    faces: vertex indices, (m, 3).
    behind: distances of the vertices behind the hairline [mm], (n,).
    covers: least heights of hair above the vertices [mm], (n,). At this height, coarse triangles
        of concave skin do not hide the hair.
    """

    points: Floats64
    normals: Floats64
    faces: Integers32
    behind: Floats64
    covers: Floats64


def hair_of(cut: Cut, scalp: Scalp, colour: Floats64, length: float) -> tuple[Part, ...]:
    """Make the parts of short hair; colour: sRGB, (3,); length: factor on the cut's lengths."""
    points, normals, faces, behind, covers = scalp
    middle = 0.5 * (points.min(axis=0) + points.max(axis=0))
    whorl = unit_vectors(np.array([cut.whorl]))[0]
    beside = _first_side(cut, whorl)
    out = points - middle
    angle = np.arctan2(out @ np.cross(whorl, beside), out @ beside)
    painted_depth = 1.0  # [mm] behind the hairline, up to which hairs are only painted
    faces, rows, angle = _split_at_seam(faces[(behind[faces] > painted_depth).any(axis=1)], angle)
    points, normals, behind, covers = (each[rows] for each in (points, normals, behind, covers))
    out = unit_vectors(out[rows])
    away = np.arccos(np.clip(out @ whorl, -1.0, 1.0))
    radius = np.linalg.norm(scalp.points - middle, axis=1).mean()
    comb = unit_vectors(np.cross(np.cross(whorl, out), normals))
    if whorl[2] < 0.0:  # a whorl at the crown
        turned, comb = _turned_around_whorl(whorl, out, away, comb)
        angle = angle - turned
    long = length * _lengths(cut, points, normals, behind)
    # Distances behind the hairline [mm]: up to the first hair lies flat, from the second it stands
    # off by the cut's lift.
    flat_depths = 0.0, 24.0 if cut.knot else 45.0
    lift = cut.lift * smoothstep(behind, *flat_depths)[:, None]
    whorl_radius = 30.0  # [mm]; strands within it stand up and do not shine
    aside = smoothstep(radius * away, 0.0, whorl_radius)[:, None]
    way = long[:, None] * (lift * normals + aside * np.sqrt(1.0 - lift**2) * comb)
    way += (covers * smoothstep(behind, 0.0, 25.0))[:, None] * normals
    way = _over_skin(way, points, normals, scalp, long)
    off = _heights_of_roots(cut, behind, points[:, 2] - middle[2], covers)
    points = points + off[:, None] * normals
    uneven = _hem_offsets(radius * angle)
    hem_depth = 20.0  # [mm] over which hair becomes dense
    bare_depth = 5.0  # [mm] behind the hairline, where hair that is tied back begins
    first_depth = bare_depth if cut.knot else painted_depth
    dense = np.minimum((behind - first_depth + uneven) / hem_depth, 2.0)
    along = (LENGTHWISE_FACTOR if cut.knot else 1.0) * radius * away
    rise = (way * normals).sum(axis=1)
    fray = smoothstep(rise, *FRAYED_RISES) * smoothstep(behind, *FRAYED_DEPTHS)
    if cut.knot:
        fray[:] = 0.0
    striation = np.column_stack([radius * angle, along, way, dense, fray])
    # Cropped hair shines little: its tips point outward, so no bright ring surrounds the whorl.
    short_shine = 0.12 * min(cut.top / 20.0, 1.0) ** 2
    hair = Part(
        name=HAIR_NAME,
        vertices=(points + MEAN_PLACE * way).astype(np.float32),
        normals=normals.astype(np.float32),
        faces=faces,
        colours=(_tone_factors(points, radius * away) * colour).astype(np.float32),
        bone="cranium",
        shine=SLEEK_GLOSS if cut.knot else short_shine,
        striation=striation.astype(np.float32),
    )
    # Locks at the front are at least this long; longer cuts are combed over the forehead.
    least = min(2.0 + 0.15 * length * cut.top, 5.5)
    growth = TIED_HAIR if cut.knot else replace(SHORT_HAIR, least=least)
    height = off + MEAN_PLACE * rise
    hangs = _hangs(cut, points - middle, normals, behind, height)
    inside = from_within(_with_dense_hem(hair), faces[hangs[faces].all(axis=1)])
    return inside, hair, locks_on(hair, growth)


def _heights_of_roots(cut: Cut, behind: Floats64, ahead: Floats64, covers: Floats64) -> Floats64:
    """Return heights of the roots of strands over the skin [mm], (n,).

    behind: distances behind the hairline [mm], (n,). ahead: distances in front of the head's centre
    [mm], (n,). covers: as in `Scalp`.
    """
    clearance = 0.5  # [mm]
    sinking = 0.3  # [mm] of depth per mm; the surface dips below the skin 4 mm before the hairline
    off = clearance * smoothstep(behind, -2.0, 8.0) + sinking * np.minimum(behind + 4.0, 0.0)
    if cut.knot:  # else light passes between nape and hair that is seen edge-on
        nape_depth = 20.0  # [mm] behind the head's centre, where hair begins below the skin
        is_nape = ahead < -nape_depth
        off -= 0.8 * smoothstep(behind, 30.0, 10.0) * is_nape
        # Coarse triangles of the hollow nape would hide corners of the hair.
        hollow_depth = 45.0  # [mm] behind the head's centre, behind the grooves at ears
        off += covers * smoothstep(behind, 0.0, 8.0) * smoothstep(-ahead, nape_depth, hollow_depth)
    return np.asarray(off)


def _hangs(
    cut: Cut, off_centre: Floats64, normals: Floats64, behind: Floats64, height: Floats64
) -> Flags:
    """Return where the inner side of hair is drawn, (n,).

    off_centre: places on the skin, relative to the head's centre [mm], (n, 3). normals: unit
    normals there, (n, 3). behind: distances behind the hairline [mm], (n,). height: heights of the
    layers over the skin [mm], (n,).
    """
    if cut.knot:
        # Tied hair also stands off the hollow skin above ears. Where it lies on the skin, no view
        # passes below it; its inner side would show in the groove before ears.
        last_depth, lying_height = 45.0, 2.0  # [mm] behind the head's centre, and over the skin
        return (off_centre[:, 2] > -last_depth) & (height > lying_height)
    # Where normals point up more than this, the inner side shows only at the hem of a bald crown.
    upward_fraction, crown_depth = 0.8, 40.0  # depth behind the hairline [mm]
    hangs_over = off_centre[:, 2] > 0.0  # loose hair hangs over the skin
    return hangs_over & ((normals[:, 1] < upward_fraction) | (behind < crown_depth))


def _with_dense_hem(hair: Part) -> Part:
    """Return hair that is dense up to its hem, under which a view along the skin passes."""
    assert hair.striation is not None
    striation = hair.striation.copy()
    striation[:, 5] = np.minimum(3.0 * striation[:, 5] + 0.8, 2.0)
    frayed = 0.35  # fray from which the inner side would fill the outline; below, it closes gaps
    striation[striation[:, 6] > frayed, 5] = 0.0
    striation[:, 6] = 0.0
    return replace(hair, striation=striation)


def _over_skin(
    way: Floats64, points: Floats64, normals: Floats64, scalp: Scalp, long: Floats64
) -> Floats64:
    """Raise strands that would enter the skin ahead of them: skin is hollow behind ears.

    way: vectors from roots to tips [mm], (n, 3). points: roots on the skin [mm], (n, 3). normals:
    unit normals there, (n, 3). long: lengths of strands [mm], (n,). Returns new vectors, (n, 3).
    """
    clearance = 1.0  # [mm] over the skin
    rising_share = 0.5  # of a strand's length that its tip rises at most, else it stands up
    outline = points + MEAN_PLACE * way
    skin = closest_points(outline, scalp.points, scalp.faces)
    above = ((outline - skin.interpolate(scalp.points)) * normals).sum(axis=1)
    lacking = np.maximum(clearance + skin.interpolate(scalp.covers) - above, 0.0)
    rise = np.minimum(lacking / MEAN_PLACE, rising_share * long)
    return np.asarray(way + rise[:, None] * normals)


def _tone_factors(points: Floats64, away: Floats64) -> Floats64:
    """Return factors on the colour of strands, (n, 1); away: distance from the whorl [mm], (n,)."""
    difference = 0.07  # between the tones of locks and the mean tone
    root_radius = 7.0  # [mm] around a whorl, within which dark roots show
    at_roots = 1.0 - 0.16 * np.exp(-((away / root_radius) ** 2))[:, None]
    return np.asarray(at_roots * (1.0 + difference * waves(points, 0.33, 1.0)))


def _hem_offsets(across: Floats64) -> Floats64:
    """Return how far uneven hems lie in front of their mean [mm]; across: strands [mm], (n,)."""
    fine = 1.0 * np.sin(0.22 * across) + 0.8 * np.sin(0.57 * across + 1.0)
    return np.asarray(fine + 1.5 * np.sin(0.085 * across + 2.0))


def _first_side(cut: Cut, whorl: Floats64) -> Floats64:
    """Return the direction from a whorl at which angles around it are 0, (3,).

    On the opposite side of the whorl the angle jumps, which shows as a line in the strands. For a
    knot behind the head this line runs up from the face, else down one side of the head.
    """
    beside = np.cross([0.0, 0.3, 1.0], whorl)
    highest = 0.8  # knots on top of the head have whorls that point down more than this
    if cut.knot and whorl[1] > -highest:
        beside = np.array([0.0, 1.0, 0.0]) - whorl[1] * whorl
    return np.asarray(unit_vectors(beside[None])[0])


def _turned_around_whorl(
    whorl: Floats64, out: Floats64, away: Floats64, comb: Floats64
) -> tuple[Floats64, Floats64]:
    """Turn strands around a whorl; returns angles [rad], (n,), and turned directions, (n, 3).

    out: unit vectors from the head's centre, (n, 3). away: angles of strands from the whorl [rad],
    (n,). comb: directions of strands without the whorl, (n, 3).
    """
    swirl = 1.6  # [rad] of rotation at the whorl
    swirl_angle = 0.3  # [rad] from the whorl, over which the rotation decays
    turned = swirl * np.exp(-away / swirl_angle)
    around = np.cross(whorl, out) * (turned / swirl_angle)[:, None]
    return turned, unit_vectors(comb - around)


def _lengths(cut: Cut, points: Floats64, normals: Floats64, behind: Floats64) -> Floats64:
    """Return lengths of strands [mm], (n,); they are uneven, as if cut by hand."""
    uneven_fraction = 0.0 if cut.knot else 0.06
    long = cut.sides + (cut.top - cut.sides) * smoothstep(normals[:, 1], 0.1, 0.7)
    long *= smoothstep(behind, 0.0, cut.behind) * (
        1.0 + uneven_fraction * waves(points, 0.21)[:, 0]
    )
    return np.asarray(long)


def _split_at_seam(faces: Integers32, angle: Floats64) -> tuple[Integers32, Integers64, Floats64]:
    """Double the vertices of faces across which the angle jumps from pi to -pi.

    Without this cut, strands would run across the whole head. faces: (F, 3). angle: angle of each
    vertex around the whorl [rad], (V,). Returns the faces (F, 3), the former numbers of their
    vertices (n,), and the angles of these vertices [rad], (n,).
    """
    crosses = np.ptp(angle[faces], axis=1) > np.pi
    doubled, number = np.unique(faces[crosses], return_inverse=True)
    faces = faces.copy()
    faces[crosses] = len(angle) + number.reshape(-1, 3)
    turned = angle[doubled] + 2.0 * np.pi * (angle[doubled] < 0.0)
    used, number = np.unique(faces, return_inverse=True)
    rows = np.concatenate([np.arange(len(angle)), doubled])[used]
    angles = np.concatenate([angle, turned])[used]
    return number.reshape(-1, 3).astype(np.int32), rows, angles


def from_within(hair: Part, faces: Integers32) -> Part:
    """Make the inner side of some faces (F, 3) of hair, which shows below hanging hair and at tips.

    Its triangles are turned around, and its colours are darker.
    """
    used, number = np.unique(faces[:, ::-1], return_inverse=True)
    rows = {n: getattr(hair, n)[used] for n in ("vertices", "normals", "colours", "striation")}
    inner_light = 0.9  # fraction of light that passes between the layers of hair
    rows |= {
        "faces": number.reshape(-1, 3).astype(np.int32),
        "colours": inner_light * rows["colours"],
    }
    return replace(hair, name=HAIR_NAME + "_inside" + hair.name.removeprefix(HAIR_NAME), **rows)


def scalp_of(vertices: Floats64, faces: Integers32, uv: Floats64, behind: Floats32) -> Scalp:
    """Refine the triangles of a head that bear hair, and round them between their corners.

    vertices: [mm], (V, 3). faces: (F, 3). uv: texture coordinates of the vertices, (V, 2).
    behind: distances of texels behind the hairline [mm], (H, W).
    Source: Boubekeur, Alexa 2008, "Phong tessellation".
    """
    height, width = behind.shape

    def behind_hairline(uv: Floats64) -> Floats64:
        """Return distances behind the hairline [mm], (n,), at texture coordinates, (n, 2)."""
        at = [(1.0 - uv[:, 1]) * height - 0.5, uv[:, 0] * width - 0.5]
        sampled = scipy.ndimage.map_coordinates(behind, at, order=1, mode="nearest")
        return np.asarray(sampled, np.float64)

    has_hair = (behind_hairline(uv) > 0.0)[faces].any(axis=1)
    used, number = np.unique(faces[has_hair], return_inverse=True)
    normals = vertex_normals(vertices, faces)[used]
    faces = number.reshape(-1, 3).astype(np.int32)
    points = vertices[used]
    uv = uv[used]
    covers = np.zeros(len(points))
    level_count = 2  # each level cuts every triangle into four
    bulge_fraction = 0.75  # fraction of the distance to the tangent planes at an edge's ends
    for _ in range(level_count):
        cut = quarter(faces, len(points))
        faces = cut.faces
        ends = points[cut.edges]
        middle = ends.mean(axis=1, keepdims=True)
        above = ((middle - ends) * normals[cut.edges]).sum(axis=2, keepdims=True)
        bulge = -bulge_fraction * (above * normals[cut.edges]).mean(axis=1)
        # Where skin is concave, unrefined triangles lie above the refined ones.
        hollow = bulge_fraction * np.maximum(above, 0.0).mean(axis=(1, 2))
        covers = np.concatenate([covers, covers[cut.edges].mean(axis=1) + hollow])
        points = np.vstack([points, middle[:, 0] + bulge])
        normals = np.vstack([normals, unit_vectors(normals[cut.edges].mean(axis=1))])
        uv = np.vstack([uv, uv[cut.edges].mean(axis=1)])
    return Scalp(points, normals, faces, behind_hairline(uv), covers)
