"""Plug-ins of a refinement: find the plug-in that raised an error.

A criterion, a scheme or a refiner may come from another package, or from a program that registers
it. An error in its code is reported in one line, with the name of the plug-in.
"""

from __future__ import annotations

import contextlib
import traceback
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from types import FrameType
from typing import Any, NamedTuple

from risorius import refine

from ..errors import UserError, line_for


class PlugIn(NamedTuple):
    """A criterion, scheme or refiner from outside this application."""

    kind: str
    """"criterion", "scheme" or "refiner"."""
    name: str
    """The name by which it was chosen."""
    factory: Any
    """The class or function that makes it."""

    @property
    def module(self) -> str:
        """The name of the module that defines it."""
        return str(getattr(self.factory, "__module__", None) or type(self.factory).__module__)

    def __str__(self) -> str:
        called = getattr(self.factory, "__qualname__", type(self.factory).__qualname__)
        return f"{self.kind} '{self.name}' ({self.module}:{called})"


class PlugInError(UserError):
    """A plug-in raised an error, or its results cannot be used; the text names the plug-in."""


def plug_ins_of(refiner: str, options: Mapping[str, Any]) -> tuple[PlugIn, ...]:
    """Return the plug-ins that a refiner with these options of `refine.create` uses.

    Unknown names are left out, because `refine.create` reports them. Raises PlugInError for a
    module that ends the program during its import.
    """
    wanted: list[tuple[str, Any, refine.Registry[Any]]] = [("refiner", refiner, refine.refiners)]
    chosen = options.get("criterion", ())
    parts = chosen.split("+") if isinstance(chosen, str) else chosen
    for part in parts if isinstance(parts, Sequence) else [parts]:
        wanted.append(("criterion", part, refine.criteria))
    if "scheme" in options:
        wanted.append(("scheme", options["scheme"], refine.schemes))
    found = []
    for kind, one, registry in wanted:
        if isinstance(one, str):
            factory = _factory(kind, one, registry)
            plug_in = PlugIn(kind, one, factory)
        else:
            factory = type(one)
            plug_in = PlugIn(kind, factory.__name__, factory)
        if factory is not None and _package(plug_in.module) != "risorius":
            found.append(plug_in)
    return tuple(found)


@contextlib.contextmanager
def reported(plug_ins: Sequence[PlugIn]) -> Iterator[None]:
    """Turn an error that one of the plug-ins raises, or causes, into a PlugInError.

    An error in other code is blamed on the results of the plug-ins (for example an array of a wrong
    size), unless it is an error that the user can correct.
    """
    try:
        yield
    except UserError:
        raise
    except (Exception, SystemExit) as error:
        if not plug_ins:
            raise
        plug_in = culprit_of(error, plug_ins)
        if plug_in is not None:
            raise error_in(plug_in, error) from error
        if isinstance(error, SystemExit) or line_for(error) is not None:
            raise
        names = " or ".join(map(str, plug_ins))
        raise PlugInError(f"{names}: its results cannot be used: {_words(error)}") from error


def culprit_of(error: BaseException, plug_ins: Sequence[PlugIn]) -> PlugIn | None:
    """Return the plug-in whose code raised an error, or None for errors in other code."""
    for frame in _frames(error):
        package = _package(frame.f_globals.get("__name__", ""))
        there = [each for each in plug_ins if _package(each.module) == package]
        for plug_in in there:  # a package may have several
            if type(frame.f_locals.get("self")) is plug_in.factory:
                return plug_in
        if there:
            return there[0]
    return None


def error_in(plug_in: PlugIn, error: BaseException) -> PlugInError:
    """Return a PlugInError whose text names the plug-in, the error, and the line of code."""
    package = _package(plug_in.module)
    where = ""
    for frame in _frames(error):
        if _package(frame.f_globals.get("__name__", "")) == package:
            where = f", in {Path(frame.f_code.co_filename).name}:{_line(error, frame)}"
            break
    return PlugInError(f"{plug_in} raised {_words(error)}{where}")


def _factory(kind: str, name: str, registry: refine.Registry[Any]) -> Any:
    """Return the factory of a plug-in, or None for an unknown name."""
    try:
        return registry.find(name)
    except ValueError:
        return None
    except SystemExit:
        raise PlugInError(f"{kind} '{name}': its module ends the program when imported") from None


def _package(module: str) -> str:
    return module.partition(".")[0]


def _words(error: BaseException) -> str:
    return f"{type(error).__name__}: {error}".removesuffix(": ")


def _frames(error: BaseException) -> list[FrameType]:
    """Return the stack frames of an error, the innermost first."""
    return [frame for frame, _ in traceback.walk_tb(error.__traceback__)][::-1]


def _line(error: BaseException, wanted: FrameType) -> int:
    lines = [line for frame, line in traceback.walk_tb(error.__traceback__) if frame is wanted]
    return lines[-1]
