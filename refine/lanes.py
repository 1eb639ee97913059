"""Four numbers side by side, in compiled code: what a processor adds in one instruction.

A position has three numbers, and three take three instructions where four take one. So kernels take
a row of three together with the number behind it, whatever that is, and go on with four:

    ends = four(points, a) + four(points, b)
    write(rows, k, EDGE_END * ends + EDGE_WING * wings)

Each of the four is computed alone, in the order that is written and rounded each time, so results
are the same to the last bit as of one number after the other. The fourth is used to the end and
means nothing. Behind the last row there has to be one number more (`native.with_room`), and where
rows of three are written, each goes over what the row before it wrote as its fourth.

A compiler finds such fours by itself in simple cases only: first it has to prove that nothing that
is written is read again. Here they are asked for.

These are names for typing and reading; what they stand for is in lane_code.py, which needs numba
and is imported when the first kernel is compiled.
"""

import functools
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Any, Generic, ParamSpec, Protocol, TypeVar, cast

import numpy as np
import numpy.typing as npt

Arguments = ParamSpec("Arguments")
Result = TypeVar("Result")
Rows = npt.NDArray[Any]
Number = int | np.uint32 | np.uint64


class Four(Protocol):
    """Four numbers of one type, or twelve; in compiled code only."""

    def __add__(self, other: "Four") -> "Four":
        """Sum, number by number."""

    def __sub__(self, other: "Four") -> "Four":
        """Difference."""

    def __mul__(self, other: "Four") -> "Four":
        """Product, number by number."""

    def __rmul__(self, weight: np.float32) -> "Four":
        """Multiple."""


class Instruction(Generic[Arguments, Result]):
    """A function that exists in compiled code only."""

    file = str(Path(__file__).with_name("lane_code.py"))
    """Where the code of all of them is."""

    def __init__(self, function: Callable[Arguments, Result]) -> None:
        functools.update_wrapper(cast(Any, self), function)
        self._name = function.__name__

    def __call__(self, *arguments: Arguments.args, **keywords: Arguments.kwargs) -> Result:
        """In compiled code, just what it says."""
        raise TypeError(f"{self._name} works in compiled code only")

    @functools.cached_property
    def _numba_type_(self) -> Any:
        """How numba asks what a name means that it finds in a kernel: a function."""
        return import_module(f"{__package__}.lane_code").type_of(self._name)


@Instruction
def four(rows: Rows, k: Number) -> Four:
    """Row k of rows of three, and the number behind it; of plain numbers those from k on."""
    raise NotImplementedError


@Instruction
def twelve(rows: Rows, k: Number) -> Four:
    """Four rows of three, from row k on."""
    raise NotImplementedError


@Instruction
def write(rows: Rows, k: Number, numbers: Four) -> None:
    """Write from row k on what `four` or `twelve` would take from there."""
    raise NotImplementedError


@Instruction
def is_zero(numbers: Four) -> bool:
    """Whether all four, which are whole numbers, are 0."""
    raise NotImplementedError


@Instruction
def counted_from(k: Number) -> Four:
    """k, k + 1, k + 2, k + 3 as 32 bits each."""
    raise NotImplementedError


@Instruction
def spread(number: np.float32) -> Four:
    """The same number four times."""
    raise NotImplementedError


@Instruction
def single(numbers: Four) -> Four:
    """Round double to single precision."""
    raise NotImplementedError


@Instruction
def cross(p: Four, q: Four) -> Four:
    """Cross product of two vectors."""
    raise NotImplementedError


@Instruction
def sums_of_three(p: Four, q: Four, r: Four, s: Four) -> Four:
    """(x + y) + z of each of four vectors."""
    raise NotImplementedError


@Instruction
def above(p: Four, limits: Four) -> Four:
    """1 where a number is above its limit, else 0, as bytes."""
    raise NotImplementedError
