"""Refinement presets for each scene, by names that users choose as looks.

`smooth` looks best; films and the window show it by default. `paper` is only the rule of Kähler,
Haber, Seidel 2003. All drawing code takes a scene's refiner and its options from this module.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any

from ..errors import UserError

STATIC_REFINER = "none"  # the refiner that does not change the mesh
STATIC_LABEL = "static"  # its name in pictures
CHANGED_SUFFIX = ", changed"  # suffix of the name of a preset or refiner with options of a user
FIRST_PRESET = "smooth"  # the default
PAPERS_PRESET = "paper"
PAPERS_CRITERION = "normal"
THRESHOLD_OPTIONS = ("threshold_once", "threshold_twice")  # options of PAPERS_CRITERION only


@dataclass(frozen=True)
class Preset:
    """Refinement of one scene: the refiner, and options for each refiner."""

    refiner: str = "kahler"
    options: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)  # by refiner

    def options_for(self, refiner: str) -> Mapping[str, Any]:
        """Return the options that this preset sets for a refiner; {} if it sets none."""
        return self.options.get(refiner, {})


CARD_REFINER = "kahler-gl"  # `kahler` on the graphics card, with fewer options


def _for_both(options: Mapping[str, Any]) -> dict[str, Mapping[str, Any]]:
    """Return the same options for `kahler` and for `kahler-gl`."""
    return {"kahler": options, CARD_REFINER: options}


# A flat mesh needs no tolerance, because it is not bent at rest. A search found these values, with
# which the wave has at most about the 1328 triangles of Table 1.
PLANE_THRESHOLDS = {"threshold_once": 0.001, "threshold_twice": 0.005}

PRESETS: Mapping[str, Mapping[str, Preset]] = MappingProxyType(  # by name, then by scene
    {
        FIRST_PRESET: {
            # With `displacement` alone the outlines of crown and chin would stay polygons, because
            # edges there are long and turn little. `border` would make an open mouth rounder, but
            # would make lids and pursed lips uneven.
            "face": Preset(
                options=_for_both({"scheme": "cubic", "criterion": "displacement+rest"})
            ),
            "plane": Preset(
                options={
                    **_for_both(PLANE_THRESHOLDS),
                    "kahler": {"normals": "refined", **PLANE_THRESHOLDS},
                }
            ),
        },
        PAPERS_PRESET: {
            "face": Preset(),
            "plane": Preset(options=_for_both(PLANE_THRESHOLDS)),
        },
    }
)


def words_of_presets(option: str) -> list[str]:
    """Return all values of an option in the presets, for any refiner."""
    presets = [preset for by_scene in PRESETS.values() for preset in by_scene.values()]
    every = [options for preset in presets for options in preset.options.values()]
    return [options[option] for options in every if option in options]


@dataclass(frozen=True)
class Refinement:
    """A user's choice: a preset, perhaps another refiner, and options that replace the preset's."""

    preset: str = FIRST_PRESET
    refiner: str | None = None  # None: the preset's refiner
    options: Mapping[str, Any] = field(default_factory=dict)  # replace the preset's

    def for_scene(self, scene: str) -> tuple[str, dict[str, Any]]:
        """Return the refiner's name and all its options for a scene, given the scene's name."""
        preset = PRESETS[self.preset][scene]
        name = preset.refiner if self.refiner is None else self.refiner
        return name, {**preset.options_for(name), **self.options}

    def has_thresholds(self, scene: str) -> bool:
        """Whether one of the criteria is PAPERS_CRITERION, which uses THRESHOLD_OPTIONS."""
        return PAPERS_CRITERION in self.criterion_on(scene).split("+")

    def check(self, scene: str) -> None:
        """Raise UserError for options that have no effect on a scene, given the scene's name."""
        unused = [name for name in THRESHOLD_OPTIONS if name in self.options]
        if unused and not self.has_thresholds(scene):
            raise UserError(
                f"--option {unused[0]}: is an option of the criterion {PAPERS_CRITERION}, but "
                f"the criterion is {self.criterion_on(scene)}; leave it out, or add "
                f"--option criterion={PAPERS_CRITERION}"
            )

    def criterion_on(self, scene: str) -> str:
        """Return the names of the criteria for a scene, joined by +."""
        return str(self.for_scene(scene)[1].get("criterion", PAPERS_CRITERION))

    @property
    def label(self) -> str:
        """The name of the refinement under a picture."""
        name = STATIC_LABEL if self.refiner == STATIC_REFINER else self.refiner or self.preset
        return f"{name}{CHANGED_SUFFIX}" if self.options else name


def named(name: str, preset: str) -> Refinement:
    """Return the preset of this name, or the refiner of this name with options of `preset`."""
    return Refinement(name) if name in PRESETS else Refinement(preset, name)
