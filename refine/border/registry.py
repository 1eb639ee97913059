"""Registries of names: refiners here, schemes and criteria of `kahler` in the same way.

The package registers its own in the same way as others do. Installed packages announce theirs by
entry points, in a group for each kind. An entry point is looked up when a name is not registered
or when names are listed; it is imported when its name is used.
"""

import functools
import inspect
from collections.abc import Callable, Iterator, Mapping
from typing import TYPE_CHECKING, Any, Generic, TypeVar, Unpack, get_args, get_origin

import numpy.typing as npt

from .plugin import Refiner

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

Product = TypeVar("Product")


class Registry(Generic[Product]):
    """Factories of things of one kind, by name."""

    def __init__(self, kind: str, group: str) -> None:
        """`kind`: the product of the factories, for errors; `group`: of entry points."""
        self._kind = kind
        self._group = group
        self._factories: dict[str, Callable[..., Product]] = {}

    def register(self, name: str, factory: Callable[..., Product]) -> None:
        """Make `factory` known as `name`; raises ValueError if the name is empty or taken.

        It goes before an entry point of this name.
        """
        if not (isinstance(name, str) and name) or "+" in name:
            raise ValueError(f"the name of a {self._kind} must be a word without +, got {name!r}")
        if name in self._factories:
            raise ValueError(
                f"a {self._kind} named {name!r} exists already; taken are {self.available()}"
            )
        if not callable(factory):
            raise ValueError(f"factory of {self._kind} {name!r} must be callable, got {factory!r}")
        self._factories[name] = factory

    def available(self) -> tuple[str, ...]:
        """Names that are known, in the order of registration; then those of installed packages."""
        return tuple(dict.fromkeys([*self._factories, *self.installed()]))

    def installed(self) -> "Mapping[str, EntryPoint]":
        """What installed packages announce for this kind, by name; nothing is imported."""
        return _entry_points(self._group)

    def find(self, name: str) -> Callable[..., Product]:
        """Return the factory of a name.

        Raises ValueError if there is none, or if the package that announces it cannot be imported.
        """
        if name in self._factories:
            return self._factories[name]
        point = self.installed().get(name)
        if point is None:
            raise ValueError(f"{self._kind} {name!r} is unknown; there are {self.available()}")
        try:
            factory: Callable[..., Product] = point.load()
        except Exception as error:  # a foreign module may raise anything when it is imported
            reason = " ".join(f"{type(error).__name__}: {error}".split())
            raise ValueError(
                f"{self._kind} {name!r} of {point.value!r} cannot be loaded: {reason}"
            ) from error
        if not callable(factory):
            raise ValueError(
                f"{self._kind} {name!r} of {point.value!r} must be a class or a function, "
                f"got {factory!r}"
            )
        return factory


refiners: Registry[Refiner] = Registry("refiner", "risorius.refiners")
"""Refiners by name: built in, registered, then those of installed packages.

A factory is called as factory(faces, rest_positions, uv=..., face_uv=..., **options). An installed
package announces an entry point of group `risorius.refiners` instead.
"""


def create(
    name: str,
    faces: npt.ArrayLike,
    rest_positions: npt.ArrayLike,
    uv: npt.ArrayLike | None = None,
    face_uv: npt.ArrayLike | None = None,
    **options: Any,
) -> Refiner:
    """Bind the refiner `name` to a mesh; nothing that is passed is kept or changed.

    `faces`: vertices of each triangle, shape (F, 3), any integer type.
    `rest_positions`: undeformed vertex positions [any unit], shape (V, 3), any float type.
    `uv`: texture coordinates, shape (U, 2); `face_uv`: the one of each corner, shape (F, 3), or
    None if vertex v has coordinate v (then U = V).
    `options`: those of the method; see `create_kahler` and `Loop`. The built-in ones all
    take `attributes`: by name, values of each vertex, shape (V, k), or a pair of values, shape
    (A, k), and the row of each corner, shape (F, 3), for values that part along seams. They take
    `crease_angle` [degrees], too: edges at which two triangles turn by more at rest stay sharp.
    Raises ValueError for an unknown name or option, for arrays that do not fit together, and for a
    refiner of an installed package that cannot be imported.
    """
    factory = refiners.find(name)
    _check_options(name, factory, options)
    return factory(faces, rest_positions, uv=uv, face_uv=face_uv, **options)


def parameters(name: str) -> tuple[inspect.Parameter, ...]:
    """The options of a refiner that its factory declares, with their defaults and types.

    Types are as they are written where that is text that cannot be looked up.
    """
    return tuple(_options(_signature(refiners.find(name))))


def takes_attributes(name: str) -> bool:
    """Whether a refiner takes `attributes`, as all that hand on `Values` do."""
    return "attributes" in _allowed(_signature(refiners.find(name)))


def _signature(factory: Callable[..., Refiner]) -> inspect.Signature:
    try:
        return inspect.signature(factory, eval_str=True)
    except (NameError, AttributeError, SyntaxError, TypeError):  # of imports for type checkers only
        return inspect.signature(factory)


def _options(signature: inspect.Signature) -> Iterator[inspect.Parameter]:
    """What can be handed by name, but for the mesh and its texture coordinates."""
    for place, parameter in enumerate(signature.parameters.values()):
        is_of_mesh = place < 2 or parameter.name in ("uv", "face_uv")
        is_named = parameter.kind in (parameter.KEYWORD_ONLY, parameter.POSITIONAL_OR_KEYWORD)
        if is_named and not is_of_mesh:
            yield parameter


def _check_options(name: str, factory: Callable[..., Refiner], options: dict[str, Any]) -> None:
    signature = _signature(factory)
    if any(_takes_anything(each) for each in signature.parameters.values()):
        return
    allowed = _allowed(signature)
    unknown = sorted(set(options) - allowed)
    if unknown:
        takes = f"it takes {sorted(allowed)}" if allowed else "it takes none"
        raise ValueError(f"unknown option {unknown[0]!r} for refiner {name!r}; {takes}")


def _takes_anything(parameter: inspect.Parameter) -> bool:
    is_open = parameter.kind is parameter.VAR_KEYWORD
    return is_open and get_origin(parameter.annotation) is not Unpack


def _allowed(signature: inspect.Signature) -> set[str]:
    """The names of all options, those of `Values` too, but for texture coordinates."""
    allowed = {parameter.name for parameter in _options(signature)}
    for parameter in signature.parameters.values():
        if parameter.kind is parameter.VAR_KEYWORD and not _takes_anything(parameter):
            (values,) = get_args(parameter.annotation)
            allowed |= values.__annotations__.keys()
    return allowed - {"uv", "face_uv"}


@functools.cache
def _entry_points(group: str) -> "Mapping[str, EntryPoint]":
    from importlib.metadata import entry_points  # takes as long to import as all of this package

    return {point.name: point for point in entry_points(group=group)}
