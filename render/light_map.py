"""Light of an environment map: a key light that throws shadows, and smooth light from all around.

The brightest place of the map becomes the key light, with its excess over its surroundings. All
other light is stored as spherical harmonics up to the second order, nine numbers for each colour,
which represent the light on a matte surface to a few per cent. The light moves with the camera,
like the lamps of lights.py: the middle of the map lies behind the head, its left and right ends
behind the viewer.

Source: Ramamoorthi, Hanrahan 2001, "An efficient representation for irradiance environment maps",
for the nine numbers. The choice of a key is ours.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
import numpy.typing as npt

from ..geometry.arrays import Floats64
from .style import Light, MapBackground


@dataclass(frozen=True, eq=False)
class LightMap:
    """An environment map: linear light in any unit, shape (H, W, 3), W = 2 H.

    Row 0 is above. Columns run from behind the viewer over the left to behind the head, in the
    middle of the map, and over the right back to behind the viewer.
    """

    radiance: Floats64

    def light(self, turn: float = 0.0) -> Light:
        """Return the exposed light of the map, turned to the viewer's right by an angle [deg]."""
        return self.exposed(turn)[0]

    def exposed(self, turn: float) -> tuple[Light, float]:
        """Return the result of `light`, and the exposure factor on the radiance."""
        rows, columns = self.radiance.shape[:2]
        every = max(rows // 32, 1)  # steps of 6 degrees are fine enough for light
        radiance = self.radiance[: rows // every * every, : columns // every * every]
        blocks = radiance.reshape(rows // every, every, columns // every, every, 3)
        radiance = blocks.mean(axis=(1, 3))
        away = directions(radiance.shape[0], radiance.shape[1], turn).reshape(-1, 3)
        solid = np.repeat(_solid_angles(radiance.shape[0], radiance.shape[1]), radiance.shape[1])
        radiance = radiance.reshape(-1, 3)
        to_key, excess = _key_of(radiance, away, solid)
        key = solid @ excess / np.pi
        factors = [0.25, *[0.5] * 3, *[15 / 16] * 3, 5 / 64, 15 / 64]
        moments = (_harmonics(away) * solid[:, None]).T @ (radiance - excess) / np.pi
        around = np.array(factors)[:, None] * moments
        front = np.maximum(away[:, 2], 0.0) * solid
        lit = _harmonics(away) @ around + np.maximum(away @ to_key, 0.0)[:, None] * key
        usual_light = 0.72  # mean of the studio over surfaces that face the viewer
        scale = usual_light / max(float(front @ _luminance(lit) / front.sum()), 1e-9)
        return (
            Light(
                to_key=_three(to_key),
                to_fill=(0.0, 0.0, 1.0),
                key=_three(scale * key),
                fill=(0.0, 0.0, 0.0),
                rim=(0.0, 0.0, 0.0),
                around=tuple(_three(row) for row in scale * around),
            ),
            scale,
        )

    def background(self, turn: float = 0.0, exposure: float | None = None) -> MapBackground:
        """Return the background of a scene lit by this map: out of focus, with the same exposure.

        turn: as in `light`. exposure: the factor from `exposed`; None: it is computed again.
        """
        if exposure is None:
            exposure = self.exposed(turn)[1]
        rows, columns = self.radiance.shape[:2]
        out_of_focus = 3.0 * rows / 180.0  # 3 degrees, in texels
        up = np.subtract.outer(np.arange(rows), np.arange(rows))
        around = np.subtract.outer(np.arange(columns), np.arange(columns))
        around = (around + columns // 2) % columns - columns // 2  # the ends of a row meet
        softened = np.tensordot(_gaussian(up, out_of_focus), self.radiance, 1)
        softened = _gaussian(around, out_of_focus) @ softened
        return MapBackground(exposure * softened, turn)


def directions(rows: int, columns: int, turn: float = 0.0) -> Floats64:
    """Directions of the texels of a map, x right, y up, z to the viewer: unit vectors (H, W, 3)."""
    elevation = np.pi * (0.5 - (np.arange(rows) + 0.5) / rows)[:, None]
    azimuth = 2.0 * np.pi * ((np.arange(columns) + 0.5) / columns - 0.5) + np.radians(turn)
    across = np.cos(elevation)
    up = np.sin(elevation) + 0.0 * azimuth
    return np.stack([across * np.sin(azimuth), up, -across * np.cos(azimuth)], axis=-1)


def _solid_angles(rows: int, columns: int) -> Floats64:
    """Solid angle of a texel in each row, shape (H,)."""
    edges = np.sin(np.linspace(0.5 * np.pi, -0.5 * np.pi, rows + 1))
    return np.asarray(-np.diff(edges) * 2.0 * np.pi / columns)


def _key_of(radiance: Floats64, away: Floats64, solid: Floats64) -> tuple[Floats64, Floats64]:
    """The direction of the key (3,), and its part of the light of each texel (n, 3).

    Light from in front of the face is preferred: a sun behind the head stays in the smooth light.
    """
    lightness = _luminance(radiance) * solid
    tried = away[::7]  # a sample of all texels: the cost grows with the square
    square = np.maximum(tried @ away.T, 0.0) ** 2
    eighth = (square**2) ** 2
    # The 40th power of the cosine is a lobe of some 15 degrees; repeated squares are faster than a
    # power.
    gathered = (eighth**2) ** 2 * eighth @ lightness
    middle = tried[np.argmax(gathered * (0.6 + 0.4 * tried[:, 2]))]
    cosine = away @ middle
    is_near = cosine > np.cos(np.radians(32.0))
    is_beside = ~is_near & (cosine > np.cos(np.radians(50.0)))
    level = solid[is_beside] @ radiance[is_beside] / solid[is_beside].sum()
    excess = np.maximum(radiance - level, 0.0) * is_near[:, None]
    toward = (_luminance(excess) * solid) @ away
    length = np.linalg.norm(toward)
    return (toward / length if length > 0.0 else middle), excess


def _harmonics(normals: Floats64) -> Floats64:
    """Return the polynomials of lighting.glsl at normals (n, 3), shape (n, 9)."""
    x, y, z = normals.T
    second = [x * y, y * z, x * z, 3.0 * z * z - 1.0, x * x - y * y]
    return np.stack([np.ones_like(x), y, z, x, *second], axis=-1)


def _luminance(light: Floats64) -> Floats64:
    return np.asarray(light @ [0.2126, 0.7152, 0.0722])


def _three(values: Floats64) -> tuple[float, float, float]:
    red, green, blue = values.round(5).tolist()
    return red, green, blue


def _clouds() -> Floats64:
    """An overcast sky (CIE 1955: three times as bright above as at the horizon), and a sun."""
    away = directions(64, 128)
    height = away[..., 1]
    sky = (1.0 + 2.0 * np.maximum(height, 0.0)) / 3.0
    glow = _spot(away, azimuth=140.0, elevation=48.0, width=24.0)
    clouds = sky[..., None] * [0.95, 1.0, 1.08] + glow[..., None] * [3.2, 3.05, 2.8]
    return np.where(height[..., None] > 0.0, clouds, [0.17, 0.16, 0.14])


def _room() -> Floats64:
    """A room with a window at the viewer's left, a lamp at the right, and light walls."""
    away = directions(64, 128)
    height = away[..., 1:2]
    walls = np.where(height > 0.6, [0.24, 0.23, 0.21], [0.17, 0.155, 0.135])
    walls = np.where(height < -0.35, [0.09, 0.07, 0.055], walls)
    window = _pane(away, (-150.0, -105.0), (-12.0, 42.0))
    bars = _pane(away, (-129.0, -126.0), (-12.0, 42.0)) + _pane(away, (-150, -105), (14.0, 17.0))
    lamp = _spot(away, azimuth=62.0, elevation=8.0, width=9.0)
    light = walls + (window * (bars == 0.0))[..., None] * [5.6, 6.1, 6.9]
    return np.asarray(light + lamp[..., None] * [5.5, 3.4, 1.7])


def _street() -> Floats64:
    """A street at evening: a blue sky, a lamp above, windows of shops, two signs."""
    away = directions(64, 128)
    height = away[..., 1:2]
    sky = np.array([0.07, 0.10, 0.19]) + 0.10 * np.exp(-5.0 * np.abs(height)) * [1.6, 0.9, 0.6]
    light = np.where(height > 0.0, sky, [0.05, 0.045, 0.045])
    for first, last in ((-178.0, -150.0), (-140.0, -112.0), (20.0, 44.0), (140.0, 160.0)):
        light = light + _pane(away, (first, last), (-8.0, 16.0))[..., None] * [1.9, 1.3, 0.75]
    light = light + _pane(away, (-75.0, -50.0), (4.0, 22.0))[..., None] * [0.35, 0.7, 2.4]
    light = light + _pane(away, (92.0, 118.0), (-2.0, 20.0))[..., None] * [2.4, 0.3, 0.9]
    lamp = _spot(away, azimuth=132.0, elevation=42.0, width=7.0)
    lights_behind = _spot(away, azimuth=-12.0, elevation=6.0, width=1.6)
    lights_behind += _spot(away, azimuth=9.0, elevation=4.0, width=1.3)
    light = light + lights_behind[..., None] * [2.6, 1.7, 0.9]
    return np.asarray(light + lamp[..., None] * [24.0, 18.5, 12.5])


def _gaussian(distances: npt.NDArray[np.int64], deviation: float) -> Floats64:
    """Weights of texels at these distances from each texel, shape (n, n), rows of sum 1."""
    weights = np.exp(-0.5 * (distances / deviation) ** 2)
    return np.asarray(weights / weights.sum(axis=1, keepdims=True))


def _spot(away: Floats64, *, azimuth: float, elevation: float, width: float) -> Floats64:
    """A Gaussian on a map, 1 at its place, with `width` as its deviation [deg], (H, W)."""
    across = np.radians(azimuth)
    up = np.radians(elevation)
    middle = [np.cos(up) * np.sin(across), np.sin(up), -np.cos(up) * np.cos(across)]
    angle = np.degrees(np.arccos(np.clip(away @ middle, -1.0, 1.0)))
    return np.asarray(np.exp(-0.5 * (angle / width) ** 2))


def _pane(
    away: Floats64, azimuths: tuple[float, float], elevations: tuple[float, float]
) -> Floats64:
    """1 between these angles [deg], 0 outside, shape (H, W)."""
    azimuth = np.degrees(np.arctan2(away[..., 0], -away[..., 2]))
    elevation = np.degrees(np.arcsin(away[..., 1]))
    across = (azimuth >= azimuths[0]) & (azimuth <= azimuths[1])
    return np.asarray(across & (elevation >= elevations[0]) & (elevation <= elevations[1]), float)


LIGHT_MAPS: Mapping[str, LightMap] = MappingProxyType(
    {"clouds": LightMap(_clouds()), "room": LightMap(_room()), "street": LightMap(_street())}
)
"""The maps that this module computes, by name."""
