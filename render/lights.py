"""Named lights: lamps from lights.toml, and environment maps."""

import tomllib
from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType

from .light_map import LIGHT_MAPS
from .style import Light

_LAMP_ROWS = tomllib.loads((Path(__file__).parent / "lights.toml").read_text(encoding="utf-8"))
LAMPS: Mapping[str, Light] = MappingProxyType(
    {
        name: Light(**{key: tuple(xyz) for key, xyz in row.items()})
        for name, row in _LAMP_ROWS.items()
    }
)
"""Lamps: name -> key light, fill light, rim light, and ambient light of a hemisphere."""
LIGHTS: Mapping[str, Light] = MappingProxyType(
    {**LAMPS, **{name: each.light() for name, each in LIGHT_MAPS.items()}}
)
"""All lights: name -> light."""
