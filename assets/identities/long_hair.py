"""Long hair, which hangs beside the face or is tied behind the head.

Long hair is drawn like short hair (hair.py): as layers over one surface of parallel strands, from
the inside out. Hanging strands run over the head from a parting. Tied hair is wound into a knot,
or hangs as a tail; either begins where the strands on the scalp meet.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import scipy

from ...geometry.arrays import Floats64
from ...geometry.directions import unit_vectors
from ...geometry.normals import vertex_normals
from ...geometry.steps import smoothstep
from ..model import Part
from ..topology import grid_faces
from . import hair as short
from .hair import HAIR_NAME, Cut, Fall, Scalp, from_within
from .locks import FALLING_HAIR, INNER_TIPS, MEAN_PLACE, TIP_GROWTH, WOUND_HAIR, locks_on
from .single_hairs import locks_along

# Horizontal angles [rad]: from straight ahead to the hair, and from there to its full volume.
HAIR_EDGE_ANGLE, ROUNDING_ANGLE = np.radians([62.0, 50.0])
THINNING_LENGTH = 14.0  # [mm] over which the tips of cut hair thin out
FULL_DENSITY = 2.0  # density at which all layers are full
HAIR_HEIGHT = 9.0  # [mm] that hair stands off the head
LAYER_SLIDE = 1.3  # [mm] that layers move along lying strands, for each millimetre outward
# Tails hang clear of the back.
DOWN_AXIS, RIGHT_AXIS = np.array([(0.0, -1.0, -0.12), (1.0, 0.0, 0.0)])
Even = Floats64 | float  # a single number holds for every point


def falling_hair(
    cut: Fall, scalp: Scalp, head: Any, colour: Floats64, length: float
) -> tuple[Part, ...]:
    """Make the parts that are drawn as long loose hair, the inner side first.

    head: has vertices (V, 3) [mm] and anatomy (names -> vertex indices). colour: sRGB, (3,).
    length: factor on the distance from the ears to the tips.
    """
    vertices = head.vertices
    at = head.anatomy
    ear = 0.5 * (vertices[at["tragion_left"]] + vertices[at["tragion_right"]])
    middle = np.array([0.0, ear[1] + 29.0, ear[2] - 8.0])  # centre of the head, above the ears [mm]
    strand_count = 51
    around = np.linspace(-1.0, 1.0, strand_count)  # from the face's right side around the back
    share = 1.0 - np.abs(around)
    side = np.sign(around)
    crown = vertices[at["vertex"]] + [0.4 * cut.parting, 0.0, -30.0] - middle
    front = vertices[at["trichion"]] + [cut.parting, 0.0, -4.0] - middle
    angle = HAIR_EDGE_ANGLE + (np.pi - HAIR_EDGE_ANGLE) * share**1.3
    level = np.stack([side * np.sin(angle), 0.0 * angle, np.cos(angle)], axis=-1)
    sample_count = 14  # along the part of a strand on the head; one fewer along the free part
    over = np.linspace(0.0, 1.0, sample_count)
    drop = np.linspace(0.0, 1.0, sample_count)[1:]
    roots = unit_vectors(front + (share**0.8)[:, None] * (crown - front))
    level_of_widest = np.array([0.0, -0.1, 0.0])  # strands leave the head a little below its centre
    directions = _between_ways(roots, unit_vectors(level + level_of_widest), over)
    across = 88.0 * side * (np.pi - angle)
    # Beside the face the outer surface of the hair curves inward to its inner surface.
    beside = np.clip((angle - HAIR_EDGE_ANGLE) / ROUNDING_ANGLE, 0.0005, 1.0)
    layered_rise = 16.0  # [mm] that tips rise in front
    ends = ear[1] - cut.below * length + layered_rise * (1.0 - beside) ** 3 + _tip_heights(across)
    rise = np.clip(over / 0.35, 0.0, 1.0)  # 0 at the root, 1 where the volume is full
    risen = 0.1 + 0.9 * np.sin(0.5 * np.pi * rise)
    thick = HAIR_HEIGHT * risen * np.sin(0.5 * np.pi * beside)[:, None]
    solid = np.vstack([scalp.points, vertices[vertices[:, 1] > ear[1] - 53.0]]) - middle
    # [mm] off the skin: little at roots, so no light passes; more over foreheads, which may bulge.
    clearance = np.where(over > 0.0, 5.0 + 3.0 * (1.0 - beside[:, None]) ** 2, 2.5)
    far = _skin_reach(directions, solid) + clearance + _lock_thickness(across, over) * thick
    places = middle + far[..., None] * directions
    start = places[:, -1:]
    wide = np.linalg.norm((start - middle)[..., [0, 2]], axis=-1)
    height = start[..., 1] + drop * (ends[:, None] - start[..., 1])
    lobe_depth = 42.0  # [mm] below the tragus; strands that curve in above it would meet the lobe
    curved, thinned = _curved_tips(height, ears_end=ear[1] - lobe_depth, ends=ends)
    fall = middle + (wide * curved - thinned * thick[:, -1:])[..., None] * level[:, None]
    fall[..., 1] = height
    thick = np.hstack([thick, thick[:, -1:] * (1.0 - thinned)])
    sharp = np.concatenate([places, fall], axis=1)
    bending_steps = 1.3  # standard deviation of the smoothing along strands, in samples
    bent = scipy.ndimage.gaussian_filter1d(sharp, bending_steps, axis=1, mode="nearest")
    bent[:, 0] = sharp[:, 0]  # roots stay
    along = _arc_lengths(bent)
    on_head = along[:, sample_count - 1 : sample_count]  # length of the part on the head [mm]
    loose = smoothstep(along / on_head, 0.7, 1.1)  # edges over the forehead would throw shadows
    off = 88.0 * (angle - HAIR_EDGE_ANGLE)[:, None] - _edge_offsets(along, side) * loose
    dense = _densities(along, off, loose)
    tones = _lock_lightness(across) * colour
    slide = _slide_of(along)
    hair = _layered_part(HAIR_NAME, bent, across[:, None], thick, dense, tones, slide, loose)
    return (*_with_tips(hair, bent.shape[1]), locks_along(hair, across, along))


def _densities(along: Floats64, off: Floats64, loose: Floats64) -> Floats64:
    """Return the density of loose hair, (n, m); it may be above FULL_DENSITY.

    along: lengths from the roots [mm], (n, m). off: distances behind the edge beside the face [mm],
    (n, m). loose: as in `_layered_part`.
    """
    # Hair becomes dense within 2 mm of the parting and 4 to 7 mm of the face. Over longer
    # distances, the strands in front would look like bars over the skin.
    before_tips = (along[:, -1:] - along) / THINNING_LENGTH
    beside_face = np.minimum(0.1 + off / (2.4 + 1.6 * loose), before_tips)
    return np.minimum(0.5 + along / 1.4, beside_face)


def _edge_offsets(along: Floats64, side: Floats64) -> Floats64:
    """Return how far the edge of loose hair lies behind its foremost places beside the face [mm].

    along: lengths from the roots [mm], (n, m). side: -1, 0 or 1 for strands on the right, in the
    middle and on the left, (n,). Returns offsets, (n, m).
    """
    most = 5.0  # [mm]
    wavelength = 94.0  # [mm]
    turn = 2.0 * np.pi * along / wavelength + side[:, None]
    return np.asarray(0.5 * most * (1.0 + np.sin(turn)))


def _lock_heights(across: Floats64) -> Floats64:
    """Return how far wide locks stand out at strands, about -1 to 1; across: strands [mm], (n,)."""
    wide = np.sin(0.16 * across + 1.5)
    narrow = 0.7 * np.sin(0.37 * across) + 0.5 * np.sin(0.61 * across)
    return np.asarray((wide + narrow) / 2.2)


def _lock_thickness(across: Floats64, over: Floats64) -> Floats64:
    """Return factors on the thickness of hair with locks, (n, m).

    across: as in `_lock_heights`. over: fractions of the part of a strand on the head, (m,).
    """
    # Depth of grooves, as a fraction of the thickness. Deep ones beside the parting would look like
    # the ruffle of a bonnet.
    depth = 0.15 + 0.35 * smoothstep(over, 0.3, 1.0)
    locks = _lock_heights(across)
    return np.asarray(1.2 + depth * (locks - locks.max())[:, None])


def _lock_lightness(across: Floats64) -> Floats64:
    """Return factors on the colour of locks, (n, 1, 1); across: as in `_lock_heights`.

    They do not follow the heights of locks, or dark grooves would look like folds of cloth.
    """
    difference = 0.13  # from the mean lightness
    return np.asarray(1.0 + difference * np.roll(_lock_heights(across), 1)[:, None, None])


def _tip_heights(across: Floats64) -> Floats64:
    """Return heights of uneven tips above their mean [mm], (n,); across: strands [mm], (n,)."""
    depth = 3.0  # [mm]; waves are as wide as many strands, because narrow ones are teeth
    uneven = 0.6 * np.sin(0.11 * across) + 0.4 * np.sin(0.047 * across + 1.0)
    return np.asarray(depth * uneven)


def _with_tips(hair: Part, sample_count: int) -> tuple[Part, ...]:
    """Return hair, its inside, and locks at the tips of both.

    sample_count: number of vertices along each strand.
    """
    inside = from_within(hair, hair.faces)
    # Locks that face away from the eye are not drawn, so these are lit like the outer side. They
    # are darker, because no lamp reaches the inner side of tips.
    lit = replace(inside, normals=-inside.normals, colours=0.65 * inside.colours)
    is_last = (hair.faces % sample_count >= sample_count - 2).all(axis=1)
    inner = replace(lit, name=lit.name + "_tips", faces=lit.faces[is_last])
    outer = replace(hair, name=hair.name + "_tips", faces=hair.faces[is_last])
    return inside, hair, locks_on(inner, INNER_TIPS), locks_on(outer, TIP_GROWTH)


def _slide_of(along: Floats64) -> Floats64:
    """Return `slide` of `_layered_part`, (n, m); along: lengths from the roots [mm], (n, m).

    Hair rises at its parting, and shines where it lies flat. If it lay flat at the parting, the two
    halves would meet there in a hard edge, one side bright and the other dark.
    """
    rising_length = 40.0  # [mm]
    return np.asarray(LAYER_SLIDE * smoothstep(along, 0.0, rising_length))


def _curved_tips(height: Floats64, *, ears_end: float, ends: Floats64) -> tuple[Floats64, Floats64]:
    """Curve strands inward below the ears, and thin them toward their tips.

    height: height of each point [mm], (n, m). ears_end: height below which strands curve [mm].
    ends: heights of the tips [mm], (n,). Returns factors on the distance from the head's axis, and
    the fractions of the volume that are lost, both (n, m).
    """
    tip_thinning = 0.7  # fraction of the volume that is lost at tips
    tip_curving = 0.27  # fraction of the distance from the axis that is lost at tips
    low = np.clip((ears_end - height) / np.maximum(ears_end - ends, 1.0)[:, None], 0.0, 1.0)
    return 1.0 - tip_curving * low**1.6, tip_thinning * low**2


def _skin_reach(directions: Floats64, solid: Floats64) -> Floats64:
    """Return distances of the skin from the head's centre [mm], (n, m), as a soft maximum.

    directions: unit directions, (n, m, 3). solid: points of the skin relative to the centre [mm],
    (k, 3).
    """
    far = np.linalg.norm(solid, axis=1)
    sharpness = 120.0  # exponent of the weights; with more, fewer directions count
    weights = directions.reshape(-1, 3) @ (solid / far[:, None]).T
    weights -= 1.0  # in place: there are a million
    weights *= sharpness
    np.exp(weights, out=weights)
    power = 24.0  # of the power mean over distances: high, so that the farthest point counts most
    sums = weights @ np.column_stack([far**power, np.ones(len(far))])
    mean = (sums[:, 0] / sums[:, 1]).reshape(directions.shape[:2])
    return np.asarray(mean ** (1.0 / power))


def _between_ways(start: Floats64, end: Floats64, fractions: Floats64) -> Floats64:
    """Interpolate between unit vectors along great circles (slerp).

    start, end: pairs of unit vectors, (n, 3), neither equal nor opposite. fractions: fractions of
    the angle between them, (m,). Returns unit vectors, (n, m, 3).
    Source: Shoemake 1985, "Animating rotation with quaternion curves".
    """
    angle = np.arccos((start * end).sum(axis=1))[:, None]
    parts = np.sin((1.0 - fractions) * angle), np.sin(fractions * angle)
    before, after = (part / np.sin(angle) for part in parts)
    return np.asarray(before[..., None] * start[:, None] + after[..., None] * end[:, None])


def tied_hair(cut: Cut, scalp: Scalp, colour: Floats64, length: float) -> tuple[Part, ...]:
    """Make the parts that are drawn as tied hair: a knot or a tail.

    colour: sRGB, (3,). length: factor on the lengths of the cut.
    """
    points = scalp.points
    out = -unit_vectors(np.array([cut.whorl]))[0]
    directions = unit_vectors(points - 0.5 * (points.min(axis=0) + points.max(axis=0)))
    root = points[np.argmax(directions @ out)]
    place_count = 40
    t = np.linspace(0.0, 1.0, place_count)[:, None]
    if cut.tail:
        far = length * cut.tail * t
        root_depth = 12.0  # [mm] below the scalp, where a tail begins
        free_distance = 75.0  # [mm] from the beginning of a tail to its full width
        tie_distance = 28.0  # [mm] from the beginning of a tail to its tie
        free = smoothstep(far, tie_distance, free_distance)
        directions = _falling_ways(far, out, cut.aside, root_depth, free_distance)
        line = root - root_depth * out + np.cumsum(directions * far[1], axis=0)
        tied_width = 0.45  # thickness at the tie, as a fraction of the full thickness
        thick = tied_width + (1.0 - tied_width) * free
        root_width = 1.0  # thickness on the scalp, as a fraction of the full thickness
        thick += (root_width - tied_width) * (1.0 - smoothstep(far, 0.0, tie_distance))
        thick *= 1.0 - 0.55 * t**2 - 0.4 * t**8
        shade = np.exp(-(((far - tie_distance) / 5.0) ** 2))
        tail_hem = 28.0  # [mm] over which tips thin out
        dense = np.minimum(far / root_depth, (far[-1] - far) / tail_hem)
        # Number of locks, width of a lock [mm], depth of the grooves between locks as a fraction
        # of the radius, and turns of the locks around the axis.
        tail = (6, 24.0, 0.04, 0.1)
        count, wide, deep, turns = tail
    else:  # a ball, sampled from its rim on the scalp to its outer pole
        rise = -1.0 + (0.498 * np.pi + 1.0) * t
        thick = np.cos(rise)
        directions = out[None]
        free = np.ones_like(t)
        knot_height = 0.8  # fraction of half the knot's width
        dimple_depth = 0.12  # fraction of half the knot's width
        height = knot_height * (np.sin(rise) + 0.5) - dimple_depth * np.exp(-((3.0 * thick) ** 2))
        line = root + cut.knot * height * out
        shade = smoothstep(rise, -0.3, -1.0)
        dense = FULL_DENSITY + 0.0 * t
        knot = (3, 13.0, 0.1, 1.8)
        count, wide, deep, turns = knot
    strand_count = 42
    place = np.linspace(0.0, 2.0 * np.pi, strand_count)[:, None, None]
    groove = free * (0.5 + 0.5 * np.cos(count * place)) ** 3
    turn = np.pi + place + 2.0 * np.pi * turns * t  # begins on the side of the head
    upward = unit_vectors(np.cross(RIGHT_AXIS, directions))
    ring = np.cos(turn) * upward + np.sin(turn) * np.cross(directions, upward)
    places = line + cut.knot * thick * (1.0 - deep * groove) * ring
    places[-1] = places[0]  # to the bit, or light shines through the seam
    lost_light = 0.5  # fraction of light that is lost below a knot and at a tail's tie
    light = 1.0 - np.maximum(3.0 * deep * groove, lost_light * shade)
    across = count * wide * place[..., 0] / (2.0 * np.pi)
    shaded = light * colour
    tied = _layered_part(HAIR_NAME + "_tied", places, across, HAIR_HEIGHT, dense[:, 0], shaded)
    on_scalp = short.hair_of(cut, scalp, colour, length)
    locks = locks_on(tied, FALLING_HAIR if cut.tail else WOUND_HAIR)
    return (*on_scalp, from_within(tied, tied.faces), tied, locks)


def _falling_ways(
    far: Floats64, out: Floats64, aside: float, first: float, last: float
) -> Floats64:
    """Return directions along a tail, (n, 3), which bend from outward to downward.

    far: distances along the tail [mm], (n, 1). out: outward unit vector, (3,). aside: see `Cut`.
    first, last: distances between which the tail bends [mm].
    """
    bent = smoothstep(far, first, last)
    straight_distances = 95.0, 190.0  # [mm] between which the sideways fall ends
    sideways = aside * (1.0 - smoothstep(far, *straight_distances))
    return unit_vectors((1.0 - bent) * out + bent * (DOWN_AXIS - sideways * RIGHT_AXIS))


def _layered_part(
    name: str,
    places: Floats64,
    across: Floats64,
    thick: Even,
    dense: Even,
    colour: Floats64,
    slide: Even = LAYER_SLIDE,
    loose: Even = 0.0,
) -> Part:
    """Make a part of n parallel strands with m points each, which is drawn in layers.

    places: points of the outermost layer, from root to tip [mm], (n, m, 3).
    across: coordinate across the strands [mm], (n, m).
    thick: thickness of all layers together [mm], (n, m).
    dense: density, 0 to FULL_DENSITY, (n, m).
    colour: sRGB, (n, m, 3).
    slide: distance that layers move along strands for each millimetre outward, (n, m).
    loose: 0 for hair that is combed smooth, to 1 for hair that hangs loose, (n, m).
    """
    shape = places.shape
    points = places.reshape(-1, 3)
    number = np.arange(places.size // 3).reshape(shape[:2])
    out = unit_vectors(points - points.mean(axis=0))
    outward_share = 0.01  # keeps normals defined where strands meet and triangles have no area
    normals = vertex_normals(points, grid_faces(number)).reshape(shape)
    if np.array_equal(places[0], places[-1]):  # around a tail or a knot
        # Both sides of the seam have one normal, so layers have no gaps there.
        seam = unit_vectors(normals[0] + normals[-1])
        normals[0] = seam
        normals[-1] = seam
    normals = unit_vectors(normals.reshape(-1, 3) + outward_share * out)
    ahead = unit_vectors(np.gradient(places, axis=1).reshape(-1, 3))
    layer_share = 0.4  # fraction of the thickness between the first and the last layer
    along = short.LENGTHWISE_FACTOR * _arc_lengths(places)
    columns = across, along, layer_share * thick, np.minimum(dense, FULL_DENSITY), slide, loose
    rows = np.stack([np.broadcast_to(each, shape[:2]) for each in columns], axis=-1)
    across, along, thick, dense, slide, loose = np.split(rows.reshape(-1, 6), 6, axis=1)
    way = thick * (normals + slide * ahead)
    return Part(
        name=name,
        vertices=(points - (1.0 - MEAN_PLACE) * thick * normals).astype(np.float32),
        normals=normals.astype(np.float32),
        faces=grid_faces(number),
        colours=np.broadcast_to(colour, shape).reshape(-1, 3).astype(np.float32),
        bone="cranium",
        shine=short.SLEEK_GLOSS,
        striation=np.hstack([across, along, way, dense, -loose]).astype(np.float32),
    )


def _arc_lengths(places: Floats64) -> Floats64:
    """Return arc lengths of points of strands from the roots [mm], (n, m, 3) -> (n, m)."""
    steps = np.linalg.norm(np.diff(places, axis=1, prepend=places[:, :1]), axis=2)
    return np.asarray(steps.cumsum(axis=1))
