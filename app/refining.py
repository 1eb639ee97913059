"""Refiners for scenes: options as words of the command line, and what a scene adds to them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import NoneType
from typing import Any, get_args

import numpy as np
import numpy.typing as npt

from risorius import refine

from .errors import UserError
from .scenes import Scene

LARGEST = 1e30  # of a number in an option: in single precision it is still one
DETAIL = "detail"  # the one scheme that has to be given a finer mesh, see `finer_mesh`
SWITCHES = {"on": True, "true": True, "off": False, "false": False}


def refiner_for(scene: Scene, name: str, options: Mapping[str, Any] | None) -> refine.Refiner:
    """Bind the refiner `name` to the scene's mesh; UserError if it refuses an option.

    options: over those that suit the scene; None for the latter alone.
    """
    try:
        if options:
            _check(name, options_of(name), options)
        merged: dict[str, Any] = {**scene.refiner_options.get(name, {}), **(options or {})}
        if merged.get("scheme") == DETAIL and "detail" not in merged:
            merged["detail"] = finer_mesh(scene)
            if merged["detail"] is None:
                raise UserError(f"refiner {name}: scheme=detail needs a head that has a finer mesh")
        return refine.create(
            name, scene.faces, scene.rest_positions, scene.uv, scene.face_uv, **merged
        )
    except (ValueError, TypeError) as error:
        raise UserError(f"refiner {name}: {error}") from None


def options_of(name: str) -> dict[str, Any]:
    """What a refiner can be told in numbers and words, as it is declared, and its defaults.

    An option whose default is None is left out, unless it may be on or off.
    """
    return {
        each.name: each.default
        for each in refine.parameters(name)
        if isinstance(each.default, bool | int | float | str) or _is_switch(each.annotation)
    }


def _is_switch(annotation: object) -> bool:
    """Whether it is `bool | None`. Not any union with bool: numpy's ArrayLike may be one, too."""
    return set(get_args(annotation)) == {bool, NoneType}


def _check(name: str, defaults: Mapping[str, Any], options: Mapping[str, Any]) -> None:
    """UserError for an option that the refiner does not offer, or of another kind."""
    for option, value in options.items():
        if option not in defaults:
            takes = f"it takes {', '.join(defaults)}" if defaults else "it has no options"
            raise UserError(f"refiner {name}: unknown option {option}; {takes}")
        default = defaults[option]
        if default is None or isinstance(default, bool):
            is_right, wanted = value is None or isinstance(value, bool), "on or off"
        elif isinstance(default, str):
            is_right, wanted = isinstance(value, str), "a word"
        else:
            is_right = isinstance(value, int | float) and not isinstance(value, bool)
            wanted = "a number"
        if not is_right:
            raise UserError(f"refiner {name}: option {option} was {value}, must be {wanted}")


def can_detail(scene: Scene) -> bool:
    """Whether the scene's head comes with a finer mesh."""
    return hasattr(getattr(scene, "head", None), "finer")


def finer_mesh(scene: Scene) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.int32]] | None:
    """Vertices and triangles of the scene's head with four times its triangles, if it has them."""
    if not can_detail(scene):
        return None
    finer = scene.head.finer(1)  # type: ignore[attr-defined]
    return finer.vertices, finer.faces


def parse_options(name: str, settings: Sequence[str]) -> dict[str, Any] | None:
    """What `--option NAME=VALUE ...` tells the refiner `name`; None for nothing.

    Numbers, on and off, or words. Raises UserError for an unknown refiner, and where the mesh is
    drawn as it is.
    """
    if name not in refine.available():
        there_are = ", ".join(refine.available())
        raise UserError(f"refiner '{name}' is unknown; there are {there_are}")
    if name == "none" and settings:
        raise UserError(
            f"--option {settings[0]}: --refiner none draws the mesh as it is and has no options"
        )
    options: dict[str, Any] = {}
    for setting in settings:
        name, equals, text = setting.partition("=")
        if not (name and equals and text):
            raise UserError(f"--option {setting}: write NAME=VALUE, as in scheme=cubic")
        options[name] = _value(text)
        value = options[name]
        if isinstance(value, int | float) and not -LARGEST <= value <= LARGEST:
            raise UserError(f"--option {setting}: {text} is not a finite number up to {LARGEST:g}")
    return options or None


def _value(text: str) -> bool | int | float | str:
    if text.lower() in SWITCHES:
        return SWITCHES[text.lower()]
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            pass
    return text
