"""Refinement presets: how each scene is refined, under names that a user chooses from as looks.

`smooth` looks best, and is what films and the window show unless told; `paper` is the rule of
Kähler, Haber, Seidel 2003 alone. Whatever is drawn asks here by which refiner, told what.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any

from ..errors import UserError

STATIC = "none"  # the refiner that leaves the mesh as it is
CHANGED = ", changed"  # after the name of what has options over its own
FIRST_PRESET, PAPERS_PRESET = "smooth", "paper"  # the one that is seen unless told, and the paper's
THRESHOLDS = "threshold_once", "threshold_twice"  # options of this criterion alone:
PAPERS_CRITERION = "normal"


@dataclass(frozen=True)
class Preset:
    """How one scene is refined: by which refiner, and what each refiner is told there."""

    refiner: str = "kahler"
    options: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)  # by refiner

    def told(self, refiner: str) -> Mapping[str, Any]:
        """What a refiner is told where its defaults do not do; nothing, where this knows none."""
        return self.options.get(refiner, {})


ON_CARD = "kahler-gl"  # `kahler` on the graphics card, of which it has less


def _alike(told: Mapping[str, Any]) -> dict[str, Mapping[str, Any]]:
    """Options that `kahler` and its twin on the graphics card both have."""
    return {"kahler": told, ON_CARD: told}


# By `displacement` alone outlines of crown and chin would stay polygons: edges there are long, turn
# little. `border` would make an opened mouth rounder, and lids and pursed lips uneven.
SMOOTH = Preset(options=_alike({"scheme": "cubic", "criterion": "displacement+rest"}))
PAPER = Preset()
# A flat mesh needs no slack for bends that it was made with. Found by search, so that the wave
# makes about as many triangles at most as in Table 1 (1328).
PLANE = {"threshold_once": 0.001, "threshold_twice": 0.005}
PAPERS_PLANE = Preset(options=_alike(PLANE))
SMOOTH_PLANE = Preset(options={**_alike(PLANE), "kahler": {"normals": "refined", **PLANE}})

PRESETS: Mapping[str, Mapping[str, Preset]] = MappingProxyType(  # by name, then by scene
    {
        FIRST_PRESET: {"face": SMOOTH, "plane": SMOOTH_PLANE},
        PAPERS_PRESET: {"face": PAPER, "plane": PAPERS_PLANE},
    }
)


def words_of_presets(option: str) -> list[str]:
    """What presets tell any refiner by an option that is a word."""
    presets = [preset for by_scene in PRESETS.values() for preset in by_scene.values()]
    return [told[option] for each in presets for told in each.options.values() if option in told]


@dataclass(frozen=True)
class Refinement:
    """What a user asks for: a preset, or a refiner as that has it, and options over both."""

    preset: str = FIRST_PRESET
    refiner: str | None = None  # None: the preset's own
    options: Mapping[str, Any] = field(default_factory=dict)  # over what the preset tells it

    def on(self, scene: str) -> tuple[str, dict[str, Any]]:
        """The refiner's name, and all that it is told, on the scene of this name."""
        preset = PRESETS[self.preset][scene]
        name = preset.refiner if self.refiner is None else self.refiner
        return name, {**preset.told(name), **self.options}

    def has_thresholds(self, scene: str) -> bool:
        """Whether the criterion is, or has in it, the one that THRESHOLDS are of."""
        return PAPERS_CRITERION in self._criterion(scene).split("+")

    def check(self, scene: str) -> None:
        """Raise UserError for options that would do nothing on the scene of this name."""
        unused = [name for name in THRESHOLDS if name in self.options]
        if unused and not self.has_thresholds(scene):
            raise UserError(
                f"--option {unused[0]}: counts for the criterion {PAPERS_CRITERION} alone, and "
                f"here it is {self._criterion(scene)}; leave it out, or add "
                f"--option criterion={PAPERS_CRITERION}"
            )

    def _criterion(self, scene: str) -> str:
        return str(self.on(scene)[1].get("criterion", PAPERS_CRITERION))

    @property
    def label(self) -> str:
        """What it is called under a picture."""
        name = "static" if self.refiner == STATIC else self.refiner or self.preset
        return f"{name}{CHANGED}" if self.options else name


def named(name: str, preset: str) -> Refinement:
    """The preset of this name, or else the refiner of it, told what `preset` tells it."""
    return Refinement(name) if name in PRESETS else Refinement(preset, name)
