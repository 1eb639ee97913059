"""Named lights: lamps from lights.toml, and environment maps."""

import tomllib
from collections.abc import Iterator, Mapping
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


class _Lights(Mapping[str, Light]):
    """Lamps, and lights of the environment maps; the light of a map is computed when it is read."""

    def __getitem__(self, name: str) -> Light:
        lamp = LAMPS.get(name)
        return LIGHT_MAPS[name].light() if lamp is None else lamp

    def __iter__(self) -> Iterator[str]:
        yield from (*LAMPS, *LIGHT_MAPS)

    def __len__(self) -> int:
        return len(LAMPS) + len(LIGHT_MAPS)


LIGHTS: Mapping[str, Light] = _Lights()
"""All lights: name -> light."""
