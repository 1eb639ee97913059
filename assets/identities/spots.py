"""Draw moles, freckles and age spots of persons: more melanin in small ellipses of the skin.

On light skin most adults have a few moles in the face, and some have freckles on nose and cheeks,
which fade with age. Age spots follow from about 45 years on. On dark skin, many people past 30 have
small dark papules on cheeks and temples (Grimes and others 1983, "Dermatosis papulosa nigra",
Cutis 32:385-392). All numbers are chosen by eye.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np

from ...geometry.arrays import Flags, Floats32, Floats64
from ...geometry.colour import to_linear, to_screen
from ...geometry.steps import smoothstep
from ..data_files import Image

MELANIN = np.array([0.52, 0.95, 1.27])  # absorbed light; browner than the melanin of even skin
FACE_SCALE = 350.0  # [mm] on the face of one unit of the texture
# Ellipses in the right or left half of the texture, with the middle at u = 0: middle, half axes.
WHOLE_FACE = (0.0, 0.40, 0.27, 0.30)
FEATURES = (
    (0.112, 0.463, 0.045, 0.030),  # eye
    (0.0, 0.265, 0.085, 0.050),  # lips
    (0.025, 0.338, 0.025, 0.018),  # nostril
)


class Spot(NamedTuple):
    """One dark ellipse on the skin.

    u, v: its middle in the texture. radius: [mm]; stretch: the shorter half axis, relative to it.
    turn: angle of the longer axis [rad]. melanin: added amount. softness: width of the edge,
    relative to the radius.
    """

    u: float
    v: float
    radius: float
    stretch: float
    turn: float
    melanin: float
    softness: float


def drawn_spots(age: float, angle: float, random: np.random.Generator) -> tuple[Spot, ...]:
    """Choose random spots for an age [years] and a skin tone, ITA [deg]."""
    light = float(np.clip((angle + 10.0) / 50.0, 0.0, 1.0))
    fair = float(np.clip((angle - 35.0) / 25.0, 0.0, 1.0))
    freckled, papules = random.random(2) < [0.5 * fair * (1.2 - 0.01 * age), 0.35]
    mole_count = random.poisson(0.8 + 2.2 * light)
    freckle_count = int(random.integers(100, 450)) if freckled else 0
    late_count = random.poisson(0.15 * max(age - 45.0, 0.0) * light)
    papule_count = random.poisson(4.0 + 0.3 * max(age - 30.0, 0.0)) if papules else 0
    if angle > -10.0 or age < 30.0:
        papule_count = 0
    return (
        *_spots(mole_count, _anywhere, (0.5, 1.8), (0.7, 1.8), 0.4, random),
        *_spots(freckle_count, _on_nose_and_cheeks, (0.3, 0.85), (0.1, 0.4), 0.8, random),
        *_spots(late_count, _beside_eyes, (1.0, 3.2), (0.10, 0.28), 0.7, random),
        *_spots(papule_count, _beside_eyes, (0.4, 0.9), (0.5, 1.1), 0.4, random),
    )


def _spots(
    count: int,
    placed: Callable[[int, np.random.Generator], Floats64],
    radii: tuple[float, float],
    amounts: tuple[float, float],
    softness: float,
    random: np.random.Generator,
) -> Iterator[Spot]:
    """Make about `count` spots at `placed(count, random)`, (count, 2); small ones are many."""
    places = placed(count, random)
    size, shape, turn, amount = random.random((4, count))
    chosen = np.flatnonzero(_is_bare_skin(places))
    radius = radii[0] + (radii[1] - radii[0]) * size**2
    melanin = amounts[0] + (amounts[1] - amounts[0]) * amount
    stretch = 0.65 + 0.35 * shape
    for n in chosen:
        u, v = places[n].tolist()
        yield Spot(u, v, radius[n], stretch[n], np.pi * turn[n], melanin[n], softness)


def _anywhere(count: int, random: np.random.Generator) -> Floats64:
    """Choose places in the whole face, (count, 2)."""
    u, v, wide, high = WHOLE_FACE
    return np.asarray([0.5 + u, v] + random.uniform(-1.0, 1.0, (count, 2)) * [wide, high])


def _on_nose_and_cheeks(count: int, random: np.random.Generator) -> Floats64:
    """Choose places of freckles, (count, 2): most on nose and cheeks, some on the forehead."""
    middles = np.array([[0.5, 0.42], [0.38, 0.40], [0.62, 0.40], [0.5, 0.60]])
    spreads = np.array([[0.03, 0.04], [0.06, 0.04], [0.06, 0.04], [0.10, 0.04]])
    group = random.choice(len(middles), count, p=[0.2, 0.33, 0.33, 0.14])
    return np.asarray(middles[group] + spreads[group] * random.normal(size=(count, 2)))


def _beside_eyes(count: int, random: np.random.Generator) -> Floats64:
    """Choose places on temples and upper cheeks, (count, 2)."""
    side = random.choice([-1.0, 1.0], count)
    aside, up = random.normal(size=(2, count))
    return np.column_stack([0.5 + side * (0.19 + 0.04 * aside), 0.45 + 0.07 * up])


def _is_bare_skin(places: Floats64) -> Flags:
    """Flag places of the texture, (n, 2), that are on the face, and not on eyes or lips."""
    from_middle = np.abs(places[:, :1] - 0.5)
    points = np.hstack([from_middle, places[:, 1:]])
    is_free = _is_in(points, WHOLE_FACE)
    for feature in FEATURES:
        is_free &= ~_is_in(points, feature)
    return is_free


def _is_in(points: Floats64, ellipse: tuple[float, float, float, float]) -> Flags:
    """Flag points (n, 2) in an ellipse: its middle and its half axes."""
    scaled = (points - ellipse[:2]) / ellipse[2:]
    return np.asarray((scaled**2).sum(axis=1) < 1.0)


def add_spots(picture: Image, spots: tuple[Spot, ...]) -> None:
    """Darken the spots in a picture of the skin, sRGB, (H, W, 3), uint8, of any size."""
    size = len(picture)
    melanin = np.zeros((size, size), np.float32)
    for spot in spots:
        _add_spot(melanin, spot)
    faintest = 0.004  # [amount of melanin] that changes no byte
    texels = np.nonzero(melanin > faintest)
    absorbed = melanin[texels][:, None] * MELANIN
    light = to_linear(picture[texels] / 255.0) * np.exp(-absorbed)
    picture[texels] = np.rint(255.0 * to_screen(light))


def _add_spot(melanin: Floats32, spot: Spot) -> None:
    """Add a spot to a map of melanin, (size, size)."""
    size = len(melanin)
    texel = FACE_SCALE / size  # [mm]
    # A spot smaller than a texel fills it, and is fainter.
    radius = np.hypot(spot.radius, 0.6 * texel)
    amount = spot.melanin * (spot.radius / radius) ** 2
    reach = radius * (1.0 + spot.softness) / texel
    column = spot.u * size
    row = (1.0 - spot.v) * size
    first_row = int(max(row - reach, 0))
    first_column = int(max(column - reach, 0))
    window = melanin[
        first_row : int(row + reach) + 2,
        first_column : int(column + reach) + 2,
    ]
    down = (first_row + 0.5 - row + np.arange(window.shape[0])[:, None]) * texel
    right = (first_column + 0.5 - column + np.arange(window.shape[1])) * texel
    along = right * np.cos(spot.turn) + down * np.sin(spot.turn)
    across = (down * np.cos(spot.turn) - right * np.sin(spot.turn)) / spot.stretch
    distance = np.hypot(along, across) / radius
    window += amount * smoothstep(-distance, -1.0 - spot.softness, spot.softness - 1.0)
