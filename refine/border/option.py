"""Options of refiners and criteria, as their factories declare them.

An option is a keyword of the factory: its name, type and default are in the signature. An
annotation of the type adds its range and its help:

    def __init__(self, *, reach: Annotated[float, Option("how far it looks", least=0.0)] = 1.0):

The checks of `create`, the options of the command line and the sliders of a window are all derived
from this record.
"""

import inspect
import reprlib
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from numbers import Integral, Real
from types import MappingProxyType, NoneType
from typing import Annotated, Any, Literal, get_args, get_origin

import numpy as np

OptionKind = Literal["number", "integer", "switch", "word", "choice", "object"]
_KIND_OF_TYPE: Mapping[type, OptionKind] = MappingProxyType(
    {bool: "switch", int: "integer", float: "number", str: "word"}
)
LEFT_OPEN = "automatic"
"""The word for the value None, which leaves the choice to the refiner."""


@dataclass(frozen=True)
class Option:
    """One option of a refiner or a criterion."""

    help: str = ""
    """One sentence for a user."""
    least: float | None = None
    """The least number that is allowed; None: there is no limit."""
    most: float | None = None
    """The largest number that is allowed; None: there is no limit."""
    name: str = ""
    """Name of the keyword; taken from the signature, like all fields below."""
    default: Any = None
    kind: OptionKind = "object"
    """Kind of its value; an object, such as an array, can be set neither by slider nor by text."""
    choices: Mapping[str, Any] = field(default_factory=dict)
    """The allowed values of a choice, by the words that stand for them."""

    @property
    def wanted(self) -> str:
        """Describe the allowed values in words."""
        if self.kind == "switch" or True in self.choices.values():
            return "on or off (True or False)"
        if self.kind == "choice":
            return " or ".join(word for word in self.choices if word != LEFT_OPEN)
        if self.kind == "word":
            return "a word"
        number = "a whole number" if self.kind == "integer" else "a number"
        if self.least is not None and self.most is not None:
            return f"{number} from {self.least:g} to {self.most:g}"
        return number if self.least is None else f"{number}, {self.least:g} or more"

    def allows(self, value: object) -> bool:
        """Return whether a value has the kind and the range of this option."""
        is_switch = isinstance(value, bool | np.bool_)
        if self.kind == "object":
            return True
        if self.kind == "choice":
            same = (each for each in self.choices.values() if type(each) is type(value))
            return any(each == value for each in same)
        if self.kind == "switch":
            return is_switch
        if self.kind == "word":
            return not is_switch and not isinstance(value, Real | None)
        is_number = isinstance(value, Integral if self.kind == "integer" else Real)
        if not is_number or is_switch:
            return False
        number: Any = value
        is_above = self.least is None or self.least <= number
        return bool(is_above and (self.most is None or number <= self.most))

    def check(self, value: object) -> None:
        """Raise ValueError for a value that is not allowed."""
        if not self.allows(value):
            seen = value if isinstance(value, str) else reprlib.repr(value)
            raise ValueError(f"option {self.name} was {seen}, must be {self.wanted}")


def signature_of(factory: Callable[..., Any]) -> inspect.Signature:
    """Return the signature of a factory, with its type names resolved where possible."""
    try:
        return inspect.signature(factory, eval_str=True)
    except (NameError, AttributeError, SyntaxError, TypeError):  # imported for type checkers only
        return inspect.signature(factory)


def options_of(signature: inspect.Signature, first: int = 0) -> Iterator[Option]:
    """Return the options of a factory: all its keyword arguments from index `first` on."""
    for parameter in list(signature.parameters.values())[first:]:
        if parameter.kind in (parameter.KEYWORD_ONLY, parameter.POSITIONAL_OR_KEYWORD):
            yield _option_of(parameter)


def _option_of(parameter: inspect.Parameter) -> Option:
    annotation = parameter.annotation
    declared = Option()
    if get_origin(annotation) is Annotated:
        annotation, *beside = get_args(annotation)
        declared = next((each for each in beside if isinstance(each, Option)), declared)
    default = parameter.default
    choices = _choices_of(annotation)
    kind: OptionKind = "choice" if choices else _KIND_OF_TYPE.get(type(default), "object")
    return replace(declared, name=parameter.name, default=default, kind=kind, choices=choices)


def _choices_of(annotation: object) -> dict[str, Any]:
    """The values by words of `bool | None`, and of `Literal[...]` or `Literal[...] | None`.

    Other unions with bool count as no choice, because numpy's ArrayLike may be such a union.
    """
    if get_origin(annotation) is Literal:
        return {word: word for word in get_args(annotation)}
    rest = set(get_args(annotation)) - {NoneType}
    if len(get_args(annotation)) != 2 or len(rest) != 1:
        return {}
    kind = rest.pop()
    if kind is bool:
        return {LEFT_OPEN: None, "on": True, "off": False}
    if get_origin(kind) is Literal:
        return {LEFT_OPEN: None, **{word: word for word in get_args(kind)}}
    return {}
