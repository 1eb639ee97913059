"""Where light comes from: a key, which throws shadows, a fill, a rim and a hemisphere of ambient.

All of it hangs on the camera, as in a studio where the camera stands still and the head turns.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from math import cos, hypot, radians, sin
from types import MappingProxyType

Vector = tuple[float, float, float]
UNIT = 1e-3  # that a direction's length may be off 1


@dataclass(frozen=True, kw_only=True)
class Light:
    """The light of a scene; the default is the studio's, in which all else was chosen.

    to_key, to_fill: unit vectors toward the lights, in view space (x right, y up, z to the viewer).
    key, fill, rim: linear light of each; sky, ground: of the ambient light from above and below.
    Raises ValueError for a direction that is no unit vector and for light below 0.
    """

    to_key: Vector = (-0.5300, 0.6300, 0.5677)  # over the viewer's left shoulder
    to_fill: Vector = (0.7770, 0.0600, 0.6266)
    key: Vector = (1.16, 1.11, 1.05)
    fill: Vector = (0.17, 0.158, 0.152)
    rim: Vector = (0.66, 0.645, 0.65)  # from behind the viewer's right
    sky: Vector = (0.215, 0.215, 0.225)
    ground: Vector = (0.125, 0.095, 0.083)

    def __post_init__(self) -> None:
        for name in ("to_key", "to_fill"):
            length = hypot(*getattr(self, name))
            if not abs(length - 1.0) <= UNIT:
                raise ValueError(f"{name} has the length {length:g}; it must be a unit vector")
        for name in ("key", "fill", "rim", "sky", "ground"):
            if not min(getattr(self, name)) >= 0.0:
                raise ValueError(f"{name} is {getattr(self, name)}; light must be 0 or more")


def toward(azimuth: float, elevation: float) -> Vector:
    """The unit vector toward a light, by angles [deg] from the camera: to its right, and up."""
    a, e = radians(azimuth), radians(elevation)
    return sin(a) * cos(e), sin(e), cos(a) * cos(e)


# Chosen by eye, so that no part of a face is lost in the dark or in the light.
LIGHTS: Mapping[str, Light] = MappingProxyType(
    {
        "studio": Light(),
        "side": Light(
            to_key=toward(-72.0, 18.0),
            to_fill=toward(65.0, 5.0),
            key=(1.22, 1.17, 1.11),
            fill=(0.14, 0.135, 0.135),
            sky=(0.20, 0.20, 0.21),
        ),
        "overcast": Light(
            to_key=toward(-10.0, 62.0),
            to_fill=toward(0.0, 0.0),
            key=(0.46, 0.465, 0.475),
            fill=(0.20, 0.205, 0.215),
            rim=(0.20, 0.205, 0.215),
            sky=(0.68, 0.69, 0.715),
            ground=(0.29, 0.265, 0.245),
        ),
        "window": Light(
            to_key=toward(58.0, 22.0),
            to_fill=toward(-60.0, 5.0),
            key=(1.28, 1.06, 0.81),
            fill=(0.12, 0.14, 0.18),
            rim=(0.10, 0.12, 0.16),
            sky=(0.15, 0.17, 0.21),
            ground=(0.16, 0.12, 0.09),
        ),
        "hard": Light(
            to_key=toward(28.0, 46.0),
            to_fill=toward(-70.0, 0.0),
            key=(1.34, 1.31, 1.26),
            fill=(0.05, 0.05, 0.055),
            rim=(0.25, 0.25, 0.26),
            sky=(0.12, 0.125, 0.14),
            ground=(0.11, 0.095, 0.085),
        ),
    }
)
