"""Light a scene by an environment map: a key light with shadows, and smooth light from all around.

The key light comes from the brightest region of the map. It has the light by which this region
exceeds its surroundings. All other light is stored as spherical harmonics up to the second order:
nine coefficients per colour, which give the light on a diffuse surface with an error of a few per
cent. The light moves with the camera, like the lamps of lights.py. The centre of the map lies
behind the head, the left and right ends behind the viewer.

Source of the nine coefficients: Ramamoorthi, Hanrahan 2001, "An efficient representation for
irradiance environment maps". The choice of a key light is ours.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from types import MappingProxyType

import numpy as np

from ..geometry.arrays import Floats64, Integers64
from .style import Light, MapBackground

TRIED_STRIDE = 7  # texels from one tried key light to the next: time grows with their square


@dataclass(frozen=True, eq=False)
class LightMap:
    """An environment map: linear light in any unit, (H, W, 3), with W = 2 H.

    Row 0 is the zenith. Columns run from behind the viewer over the viewer's left to behind the
    head, at the centre of the map, and over the right back to behind the viewer.
    """

    radiance: Floats64

    def light(self, turn: float = 0.0) -> Light:
        """Return the exposed light of the map; turn: rotation to the viewer's right [deg]."""
        return self.exposed(turn)[0]

    def exposed(self, turn: float = 0.0) -> tuple[Light, float]:
        """Return the exposed light (see `light`), and the exposure: the factor on the radiance."""
        rows, columns = self._coarse.shape[:2]
        radiance = self._coarse.reshape(-1, 3)
        away = directions(rows, columns, turn).reshape(-1, 3)
        solid = _solid_angles(rows, columns)
        to_key, excess = _key_of(radiance, away, solid, self._gathered)
        key = solid @ excess / np.pi
        factors = [0.25, *[0.5] * 3, *[15 / 16] * 3, 5 / 64, 15 / 64]
        moments = (_harmonics(away) * solid[:, None]).T @ (radiance - excess) / np.pi
        around = np.array(factors)[:, None] * moments
        front = np.maximum(away[:, 2], 0.0) * solid
        lit = _harmonics(away) @ around + np.maximum(away @ to_key, 0.0)[:, None] * key
        usual_light = 0.72  # mean light of the lamp "studio" on surfaces that face the viewer
        scale = usual_light / max(float(front @ _luminance(lit) / front.sum()), 1e-9)
        return (
            Light(
                to_key=_per_colour(to_key),
                to_fill=(0.0, 0.0, 1.0),
                key=_per_colour(scale * key),
                fill=(0.0, 0.0, 0.0),
                rim=(0.0, 0.0, 0.0),
                around=tuple(_per_colour(row) for row in scale * around),
            ),
            scale,
        )

    def background(self, turn: float = 0.0, exposure: float | None = None) -> MapBackground:
        """Return this map, out of focus and exposed, as the background of a scene that it lights.

        - turn: as in `light`.
        - exposure: factor of `exposed`; None: it is computed again.
        """
        if exposure is None:
            exposure = self.exposed(turn)[1]
        return MapBackground(exposure * self._softened, turn)

    @cached_property
    def _coarse(self) -> Floats64:
        """The map at a resolution of 6 degrees, (h, w, 3), which suffices for light."""
        rows, columns = self.radiance.shape[:2]
        every = max(rows // 32, 1)
        radiance = self.radiance[: rows // every * every, : columns // every * every]
        blocks = radiance.reshape(rows // every, every, columns // every, every, 3)
        return np.asarray(blocks.mean(axis=(1, 3)))

    @cached_property
    def _gathered(self) -> Floats64:
        """The light from around each tried texel, (k,); a turn does not change it."""
        rows, columns = self._coarse.shape[:2]
        radiance = self._coarse.reshape(-1, 3)
        away = directions(rows, columns).reshape(-1, 3)
        lightness = _luminance(radiance) * _solid_angles(rows, columns)
        square = np.maximum(away[::TRIED_STRIDE] @ away.T, 0.0) ** 2
        eighth = (square**2) ** 2
        # The 40th power of the cosine is a lobe of about 15 degrees. Repeated squaring is faster
        # than a power.
        return np.asarray((eighth**2) ** 2 * eighth @ lightness)

    @cached_property
    def _softened(self) -> Floats64:
        """The map out of focus, (H, W, 3)."""
        rows, columns = self.radiance.shape[:2]
        out_of_focus = 3.0 * rows / 180.0  # 3 degrees in [texels]
        up = np.subtract.outer(np.arange(rows), np.arange(rows))
        around = np.subtract.outer(np.arange(columns), np.arange(columns))
        around = (around + columns // 2) % columns - columns // 2  # rows are periodic
        softened = np.tensordot(_gaussian(up, out_of_focus), self.radiance, 1)
        return np.asarray(_gaussian(around, out_of_focus) @ softened)


def directions(rows: int, columns: int, turn: float = 0.0) -> Floats64:
    """Return directions of a map's texels: unit vectors (H, W, 3), z to the viewer, y up."""
    elevation = np.pi * (0.5 - (np.arange(rows) + 0.5) / rows)[:, None]
    azimuth = 2.0 * np.pi * ((np.arange(columns) + 0.5) / columns - 0.5) + np.radians(turn)
    across = np.cos(elevation)
    up = np.sin(elevation) + 0.0 * azimuth
    return np.stack([across * np.sin(azimuth), up, -across * np.cos(azimuth)], axis=-1)


def _solid_angles(rows: int, columns: int) -> Floats64:
    """Return the solid angle of each texel [sr], (rows * columns,)."""
    edges = np.sin(np.linspace(0.5 * np.pi, -0.5 * np.pi, rows + 1))
    return np.repeat(-np.diff(edges) * 2.0 * np.pi / columns, columns)


def _key_of(
    radiance: Floats64, away: Floats64, solid: Floats64, gathered: Floats64
) -> tuple[Floats64, Floats64]:
    """Choose the key light: its direction (3,), and its part of each texel's light (n, 3).

    Light from the front is preferred: a sun behind the head is left to the smooth light.

    radiance: light of the texels, (n, 3). away: directions of the texels, (n, 3). solid: solid
    angles of the texels [sr], (n,). gathered: see `LightMap._gathered`.
    """
    tried = away[::TRIED_STRIDE]
    brightest = tried[np.argmax(gathered * (0.6 + 0.4 * tried[:, 2]))]
    cosine = away @ brightest
    is_near = cosine > np.cos(np.radians(32.0))
    is_beside = ~is_near & (cosine > np.cos(np.radians(50.0)))
    level = solid[is_beside] @ radiance[is_beside] / solid[is_beside].sum()
    excess = np.maximum(radiance - level, 0.0) * is_near[:, None]
    toward = (_luminance(excess) * solid) @ away
    length = np.linalg.norm(toward)
    return (toward / length if length > 0.0 else brightest), excess


def _harmonics(normals: Floats64) -> Floats64:
    """Return the nine polynomials of lighting.glsl, (n, 9), at unit normals (n, 3)."""
    x, y, z = normals.T
    second = [x * y, y * z, x * z, 3.0 * z * z - 1.0, x * x - y * y]
    return np.stack([np.ones_like(x), y, z, x, *second], axis=-1)


def _luminance(light: Floats64) -> Floats64:
    return np.asarray(light @ [0.2126, 0.7152, 0.0722])


def _per_colour(values: Floats64) -> tuple[float, float, float]:
    red, green, blue = values.round(5).tolist()
    return red, green, blue


def _clouds() -> Floats64:
    """Paint a sun and an overcast sky, three times as bright at the zenith (CIE 1955)."""
    away = directions(64, 128)
    height = away[..., 1]
    sky = (1.0 + 2.0 * np.maximum(height, 0.0)) / 3.0
    glow = _spot(away, azimuth=140.0, elevation=48.0, width=24.0)
    clouds = sky[..., None] * [0.95, 1.0, 1.08] + glow[..., None] * [3.2, 3.05, 2.8]
    return np.where(height[..., None] > 0.0, clouds, [0.17, 0.16, 0.14])


def _room() -> Floats64:
    """Paint a room with light walls, a window at the viewer's left, and a lamp at the right."""
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
    """Paint a street in the evening: a blue sky, a lamp above, shop windows, and two signs."""
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


def _gaussian(distances: Integers64, deviation: float) -> Floats64:
    """Return Gaussian weights of texels at some distances, (n, n); each row has the sum 1.

    distances: [texels], (n, n). deviation: standard deviation [texels].
    """
    weights = np.exp(-0.5 * (distances / deviation) ** 2)
    return np.asarray(weights / weights.sum(axis=1, keepdims=True))


def _spot(away: Floats64, *, azimuth: float, elevation: float, width: float) -> Floats64:
    """Paint a Gaussian spot on a map, (H, W), with the maximum 1.

    away: directions of the texels, (H, W, 3). width: standard deviation [deg].
    """
    across = np.radians(azimuth)
    up = np.radians(elevation)
    direction = [np.cos(up) * np.sin(across), np.sin(up), -np.cos(up) * np.cos(across)]
    angle = np.degrees(np.arccos(np.clip(away @ direction, -1.0, 1.0)))
    return np.asarray(np.exp(-0.5 * (angle / width) ** 2))


def _pane(
    away: Floats64, azimuths: tuple[float, float], elevations: tuple[float, float]
) -> Floats64:
    """Paint a rectangle on a map, (H, W): 1 between some angles [deg], 0 outside."""
    azimuth = np.degrees(np.arctan2(away[..., 0], -away[..., 2]))
    elevation = np.degrees(np.arcsin(away[..., 1]))
    across = (azimuth >= azimuths[0]) & (azimuth <= azimuths[1])
    return np.asarray(across & (elevation >= elevations[0]) & (elevation <= elevations[1]), float)


LIGHT_MAPS: Mapping[str, LightMap] = MappingProxyType(
    {"clouds": LightMap(_clouds()), "room": LightMap(_room()), "street": LightMap(_street())}
)
"""The computed maps: name -> map."""
