"""Refiners for scenes: bound as a preset has them, and options as words of the command line."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType, NoneType
from typing import Any, Literal, get_args, get_origin

import numpy as np
import numpy.typing as npt

from risorius import assets, refine
from risorius.geometry.arrays import Floats64, Integers32

from ..errors import UserError
from ..scenes import Drawable
from .plug_ins import culprit_of, error_in, plug_ins_of
from .presets import PRESETS, STATIC, Refinement, named

Splits = npt.NDArray[np.uint8]

DETAIL = "detail"  # the one scheme that has to be given a finer mesh, see `finer_mesh`
NO_ATTRIBUTES: Mapping[str, npt.NDArray[np.float32]] = MappingProxyType({})
AS_IT_SUITS = "automatic"  # the word for an option that is left open
SWITCHES = {"on": True, "true": True, "off": False, "false": False}


def refiner_for(
    scene: Drawable,
    refinement: Refinement,
    splits: Splits | None = None,
    attributes: Mapping[str, npt.NDArray[np.float32]] = NO_ATTRIBUTES,
) -> refine.Refiner:
    """Bind the refiner of a refinement to the scene's mesh.

    `splits`: of each edge in all frames, shape (E,), in place of a criterion. `attributes`: values
    of vertices at rest by name, left out for a refiner that takes none. Raises UserError if it
    refuses an option, and PlugInError if somebody else's code fails.
    """
    name, options = refinement.on(scene.name)
    plug_ins = plug_ins_of(name, options)
    try:
        if refinement.options:
            _check(name, refinement.options)
        takes_detail = any(each.name == DETAIL for each in refine.parameters(name))
        if options.get("scheme") == DETAIL and "detail" not in options and takes_detail:
            options["detail"] = finer_mesh(scene)
            if options["detail"] is None:
                raise UserError(f"refiner {name}: scheme=detail needs a head that has a finer mesh")
        if splits is not None:
            options.pop("criterion", None)
            options["splits"] = splits
        mesh = scene.faces, scene.rest_positions, scene.skin.uv, scene.skin.face_uv
        if attributes and refine.takes_attributes(name):
            return refine.create(name, *mesh, **options, attributes=attributes)
        return refine.create(name, *mesh, **options)
    except UserError:
        raise
    except (Exception, SystemExit) as error:
        plug_in = culprit_of(error, plug_ins)
        is_refusal = isinstance(error, ValueError | TypeError)
        if plug_in is not None and not (is_refusal and plug_in.kind == "refiner"):
            raise error_in(plug_in, error) from error
        if not is_refusal:
            raise
        hint = _presets_share(refinement, options)
        raise UserError(f"refiner {name}: {error}{hint}") from error


def _presets_share(refinement: Refinement, options: Mapping[str, Any]) -> str:
    """Words for the options that come from the preset: a user may not know of them."""
    settings = [
        f"{name}={('off', 'on')[value] if isinstance(value, bool) else value}"
        for name, value in options.items()
        if name not in refinement.options and name != DETAIL
    ]
    is_mixed = settings and refinement.options
    return f"; the look {refinement.preset} has {', '.join(settings)}" if is_mixed else ""


def options_of(name: str) -> dict[str, Any]:
    """The options of a refiner that are numbers or words, with their defaults, as declared.

    An option whose default is None is left out, unless it is a choice.
    """
    choices = open_choices(name)
    return {
        each.name: each.default
        for each in refine.parameters(name)
        if isinstance(each.default, bool | int | float | str) or each.name in choices
    }


def open_choices(name: str) -> dict[str, dict[str, bool | str | None]]:
    """The options of a refiner that may be left open, and the values they may have, by words."""
    values = {each.name: _values_of(each.annotation) for each in refine.parameters(name)}
    return {option: {AS_IT_SUITS: None, **found} for option, found in values.items() if found}


def _values_of(annotation: object) -> dict[str, bool | str]:
    """Of `bool | None`, on and off; of `Literal[...] | None`, its words; else none.

    Not of any union with bool: numpy's ArrayLike may be one, too.
    """
    rest = set(get_args(annotation)) - {NoneType}
    if len(get_args(annotation)) != 2 or len(rest) != 1:
        return {}
    kind = rest.pop()
    if kind is bool:
        return {"on": True, "off": False}
    return {word: word for word in get_args(kind)} if get_origin(kind) is Literal else {}


def _check(name: str, options: Mapping[str, Any]) -> None:
    """UserError for an option that the refiner does not offer, or of another kind."""
    defaults = options_of(name)
    open_ones = open_choices(name)
    for option, value in options.items():
        if option not in defaults:
            takes = f"it takes {', '.join(defaults)}" if defaults else "it has no options"
            raise UserError(f"refiner {name}: unknown option {option}; {takes}")
        default = defaults[option]
        if option in open_ones:  # 1 is not on
            values = open_ones[option]
            is_right = any(type(value) is type(each) and value == each for each in values.values())
            wanted = " or ".join(word for word in values if word != AS_IT_SUITS)
        elif isinstance(default, bool):
            is_right = isinstance(value, bool)
            wanted = "on or off"
        elif isinstance(default, str):
            is_right = isinstance(value, str)
            wanted = "a word"
        else:
            is_right = isinstance(value, int | float) and not isinstance(value, bool)
            wanted = "a number"
        if not is_right:
            raise UserError(f"refiner {name}: option {option} was {value}, must be {wanted}")


def can_detail(scene: Drawable) -> bool:
    """Whether the scene's head comes with a finer mesh."""
    return scene.face is not None and isinstance(scene.face.head, assets.Head)


def finer_mesh(scene: Drawable) -> tuple[Floats64, Integers32] | None:
    """Vertices and triangles of the scene's head with four times its triangles, if it has them."""
    face = scene.face
    if face is None or not isinstance(face.head, assets.Head):
        return None
    finer = face.head.finer(1)
    return finer.vertices, finer.faces


def parse_options(refiner: str | None, settings: Sequence[str]) -> dict[str, Any]:
    """The options that `--option NAME=VALUE ...` sets for a refiner (None: the preset's).

    Numbers, on and off, or words. Raises UserError for an unknown refiner, and where the mesh is
    drawn as it is.
    """
    if refiner is not None and refiner not in refine.refiners.available():
        there_are = ", ".join(refine.refiners.available())
        raise UserError(f"refiner '{refiner}' is unknown; there are {there_are}")
    if refiner == STATIC and settings:
        raise UserError(
            f"--option {settings[0]}: --refiner none draws the mesh as it is and has no options"
        )
    options: dict[str, Any] = {}
    largest_number = 1e30  # in an option: in single precision it is still finite
    for setting in settings:
        name, equals, text = setting.partition("=")
        if not (name and equals and text):
            raise UserError(f"--option {setting}: write NAME=VALUE, as in scheme=cubic")
        options[name] = _value(text)
        value = options[name]
        if isinstance(value, int | float) and not -largest_number <= value <= largest_number:
            raise UserError(
                f"--option {setting}: {text} is not a finite number up to {largest_number:g}"
            )
    return options


def parse_comparison(names: str | None, refinement: Refinement) -> tuple[Refinement, ...]:
    """The looks and refiners that `--compare NAME,...` sets beside a refinement, left to right.

    None is nothing. Raises UserError for a name that is neither, and where two would be the same.
    """
    beside: list[Refinement] = []
    for name in [] if names is None else names.split(","):
        if name not in PRESETS and name not in refine.refiners.available():
            raise UserError(
                f"--compare: '{name}' is neither a look ({', '.join(PRESETS)}) nor a refiner "
                f"({', '.join(refine.refiners.available())}); a SCRIPT goes before --compare"
            )
        other = named(name, refinement.preset)
        if other in (refinement, *beside):
            raise UserError(
                f"--compare: '{name}' would stand beside itself; choose a --look or a --refiner "
                f"other than {name}, or compare with another"
            )
        beside.append(other)
    return tuple(beside)


def _value(text: str) -> bool | int | float | str:
    if text.lower() in SWITCHES:
        return SWITCHES[text.lower()]
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            pass
    return text
