"""Kernels whose arguments are bound once, and whose machine code outlives the process.

A plug-in should not cost a second each time a program starts, nor more to call than to run. Numba's
own way costs both: its import and what it sets up before it can read its cache take most of a
second, and every array that is handed to a kernel 0.08 microseconds, of which a frame has fifty. So
here arguments are *bound* once, as a list of addresses and shapes, and the compiled code takes
nothing but that list:

    call = vertex_normals.bind(positions, faces, sums, normals)      # once
    call()                                                           # every frame

Several bound kernels can be put in `Turns`, which is one call again: a frame of the paper's refiner
is one in all.

Of every array the type, and every length but the first, are part of the code where they are small,
so `rows[v, 2]` is one instruction. Where the code is kept and how it is made: machine_code.py.

The price: such a kernel takes arrays and integers only, returns an integer or nothing, and neither
allocates nor raises.
"""

import ctypes
import functools
import operator
from collections.abc import Callable
from typing import Any, TypeVar, cast

import numpy as np
import numpy.typing as npt

from .kernels import Arguments, Compiled, Result
from .machine_code import load, load_turns

Rows = TypeVar("Rows", bound=npt.NDArray[Any])

LARGEST_CONSTANT = 6
"""Lengths up to this are part of the code: 2, 3, 4 columns of what there is, 6 of output rows."""


class Call(functools.partial[int]):
    """A kernel with its arguments; calling it runs the machine code.

    It returns what the kernel returns, 0 for nothing.
    """

    def __new__(
        cls, function: Callable[[int], int], names: tuple[str, ...], arguments: tuple[object, ...]
    ) -> "Call":
        """Write the list of `arguments`, and let nothing but C stand between a call and it.

        `names`: those that the arguments have in the kernel.
        """
        sizes = [1 + a.ndim if isinstance(a, np.ndarray) else 1 for a in arguments]
        places = (ctypes.c_int64 * max(1, sum(sizes)))()
        call = super().__new__(cls, function, ctypes.addressof(places))
        call._list = places
        call._numbers = {name: k for k, name in enumerate(names)}
        call._places = [sum(sizes[:k]) for k in range(len(sizes))]
        call._arguments = list(arguments)  # kept alive, since the code has only their addresses
        for k, argument in enumerate(arguments):
            call._write(k, argument)
        return call

    _list: "ctypes.Array[ctypes.c_int64]"
    _numbers: dict[str, int]
    _places: list[int]
    _arguments: list[object]

    @property
    def addresses(self) -> tuple[int, int]:
        """Of the machine code, and of the list that it takes."""
        code = ctypes.cast(cast(Any, self.func), ctypes.c_void_p).value
        assert code is not None
        return code, self.args[0]

    def takes(self, name: str) -> bool:
        """Whether the kernel has an argument of this name."""
        return name in self._numbers

    def has(self, arguments: tuple[object, ...]) -> bool:
        """Whether these objects, not others that are equal, are the arguments."""
        return all(map(operator.is_, self._arguments, arguments))

    def put(self, name: str, argument: object) -> None:
        """Replace an argument by one of the same type and the same number of columns."""
        k = self._numbers[name]
        if argument is not self._arguments[k]:
            self._arguments[k] = argument
            self._write(k, argument)

    def _write(self, k: int, argument: Any) -> None:
        place = self._places[k]
        if not isinstance(argument, np.ndarray):
            self._list[place] = int(argument)
            return
        self._list[place] = argument.ctypes.data
        for i, length in enumerate(argument.shape):
            self._list[place + 1 + i] = length


class Turns(functools.partial[int]):
    """Bound kernels that run in turn, as one call from Python: what lies between costs nothing.

    It stops behind a kernel that returns something else than 0, and returns that, else 0.
    """

    def __new__(cls, *calls: Call) -> "Turns":
        """Put `calls` in a row; what is `put` into them later counts here, too."""
        addresses = [address for call in calls for address in call.addresses]
        places = (ctypes.c_int64 * (len(addresses) + 1))(*addresses)
        turns = super().__new__(cls, load_turns(), ctypes.addressof(places))
        turns._list, turns._calls = places, calls  # kept alive
        return turns

    _list: "ctypes.Array[ctypes.c_int64]"
    _calls: tuple[Call, ...]


class Native(Compiled[Arguments, Result]):
    """What `native` makes of a function; it is bound only if it returns an integer or nothing."""

    def __call__(self, *arguments: Arguments.args, **keywords: Arguments.kwargs) -> Result:
        """Bind and run: for what is done once. In compiled code, just what it says."""
        return cast(Result, self.bind(*arguments, **keywords)())

    def bind(self, *arguments: Arguments.args, **keywords: Arguments.kwargs) -> Call:
        """Return the kernel with these arguments, which are not copied, to be run at any time."""
        assert not keywords, "arguments are bound by position"
        code = self.py_func.__code__
        names = code.co_varnames[: code.co_argcount]
        return Call(load(self, ", ".join(map(_type_of, arguments))), names, arguments)

    def again(
        self, before: Call | None, *arguments: Arguments.args, **keywords: Arguments.kwargs
    ) -> Call:
        """Return the call from before if its arguments are these very objects, else a new one."""
        is_same = before is not None and before.has(arguments)
        return before if is_same and before else self.bind(*arguments, **keywords)

    def _options(self) -> dict[str, Any]:
        return {"forceinline": True}


def native(function: Callable[Arguments, Result]) -> Native[Arguments, Result]:
    """Compile `function` for the types of the arguments that it is bound to."""
    return Native(function)


def with_room(rows: Rows) -> Rows:
    """Copy rows of three numbers into memory that goes on for one number behind the last.

    For kernels that read each row with the number behind it: four at once.
    """
    copy = np.zeros(rows.size + 1, dtype=rows.dtype)[:-1].reshape(rows.shape)
    copy[:] = rows
    return cast(Rows, copy)


def has_room(rows: npt.NDArray[Any]) -> bool:
    """Whether rows were made by `with_room`."""
    return isinstance(rows.base, np.ndarray) and rows.base.size > rows.size


def _type_of(argument: object) -> str:
    """Type of an argument in the words of machine_code.py: "int" or, say, "float32[: 3]"."""
    if not isinstance(argument, np.ndarray):
        return "int"
    assert argument.flags.c_contiguous and argument.flags.aligned, "arrays in one piece only"
    small = [str(n) if n <= LARGEST_CONSTANT else ":" for n in argument.shape[1:]]
    return f"{argument.dtype.name}[{' '.join([':', *small])}]"
