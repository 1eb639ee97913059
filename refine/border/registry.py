"""Registries of names: refiners here, schemes and criteria of `kahler` in the same way.

This package registers its own factories in the same way as other packages. Installed packages
announce factories by entry points, with one group for each kind. Entry points are looked up when a
name is not registered or when names are listed; a factory is imported when its name is used.
"""

import functools
import inspect
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, Generic, TypeVar, Unpack, get_args, get_origin

import numpy.typing as npt

from .option import Option, options_of, signature_of
from .plugin import Refiner

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

Product = TypeVar("Product")


class Registry(Generic[Product]):
    """Factories of one kind of object, by name."""

    def __init__(self, kind: str, group: str) -> None:
        """`kind`: name of the products, for errors; `group`: group name of the entry points."""
        self.kind = kind
        self._group = group
        self._factories: dict[str, Callable[..., Product]] = {}

    def register(self, name: str, factory: Callable[..., Product]) -> None:
        """Register `factory` as `name`; raises ValueError if the name is empty or taken.

        A registered factory has precedence over an entry point with the same name.
        """
        if not (isinstance(name, str) and name) or "+" in name:
            raise ValueError(f"the name of a {self.kind} must be a word without +, got {name!r}")
        if name in self._factories:
            raise ValueError(
                f"a {self.kind} named {name!r} exists already; taken are {self.available()}"
            )
        if not callable(factory):
            raise ValueError(f"factory of {self.kind} {name!r} must be callable, got {factory!r}")
        self._factories[name] = factory

    def available(self) -> tuple[str, ...]:
        """Known names in the order of registration; then those of installed packages."""
        return tuple(dict.fromkeys([*self._factories, *self.installed()]))

    def installed(self) -> "Mapping[str, EntryPoint]":
        """Entry points of this kind in installed packages, by name; nothing is imported."""
        return entry_points_of(self._group)

    def find(self, name: str) -> Callable[..., Product]:
        """Return the factory of a name.

        Raises ValueError if no factory has this name, or if its package cannot be imported.
        """
        if name in self._factories:
            return self._factories[name]
        point = self.installed().get(name)
        if point is None:
            raise ValueError(f"{self.kind} {name!r} is unknown; there are {self.available()}")
        try:
            factory: Callable[..., Product] = point.load()
        except Exception as error:  # a foreign module may raise anything when it is imported
            reason = " ".join(f"{type(error).__name__}: {error}".split())
            raise ValueError(
                f"{self.kind} {name!r} of {point.value!r} cannot be loaded: {reason}"
            ) from error
        if not callable(factory):
            raise ValueError(
                f"{self.kind} {name!r} of {point.value!r} must be a class or a function, "
                f"got {factory!r}"
            )
        return factory

    def options(self, name: str) -> tuple[Option, ...]:
        """Return the options that the factory with this name declares."""
        return tuple(options_of(signature_of(self.find(name))))

    def make(self, name: str, **options: Any) -> Product:
        """Call the factory with this name; raises ValueError for options that it lacks."""
        factory = self.find(name)
        _check_options(self.kind, name, factory, options)
        return factory(**options)


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
    """Bind the refiner `name` to a mesh; no argument is kept or changed.

    `faces`: vertices of each triangle, shape (F, 3), any integer type. `rest_positions`: undeformed
    vertex positions [any unit], shape (V, 3), any float type. `uv`: texture coordinates, shape (U,
    2); `face_uv`: the row in `uv` of each corner, shape (F, 3), or None if vertex v has coordinate
    v (then U = V). `options`: options of the refiner; see `create_kahler` and `Loop`. All built-in
    refiners take `attributes`, by name: one array of vertex values, shape (V, k). If values differ
    along seams, give a pair instead: values, shape (A, k), and rows of the corners, shape (F, 3).
    They also take `crease_angle` [degrees]: edges whose two triangles form a larger angle at rest
    stay sharp. Raises ValueError for an unknown name or option, for arrays that do not fit
    together, and for a refiner of an installed package that cannot be imported.
    """
    factory = refiners.find(name)
    _check_options(refiners.kind, name, factory, options)
    return factory(faces, rest_positions, uv=uv, face_uv=face_uv, **options)


def parameters(name: str) -> tuple[Option, ...]:
    """Return the options that the factory of a refiner declares."""
    return _options_of_refiner(signature_of(refiners.find(name)))


def takes_attributes(name: str) -> bool:
    """Return whether a refiner takes `attributes`, as all refiners with `**values: Values` do."""
    signature = signature_of(refiners.find(name))
    values = (_names_of_values(each) for each in signature.parameters.values())
    declared = (option.name for option in _options_of_refiner(signature))
    return "attributes" in {*declared, *(name for names in values for name in names)}


def _options_of_refiner(signature: inspect.Signature) -> tuple[Option, ...]:
    """All arguments but the mesh, which comes first, and its texture coordinates."""
    options = options_of(signature, first=2)
    return tuple(option for option in options if option.name not in ("uv", "face_uv"))


def _names_of_values(parameter: inspect.Parameter) -> set[str]:
    """Return the keyword names that `**values: Unpack[Values]` stands for."""
    is_unpacked = get_origin(parameter.annotation) is Unpack
    if parameter.kind is not parameter.VAR_KEYWORD or not is_unpacked:
        return set()
    (values,) = get_args(parameter.annotation)
    return set(values.__annotations__) - {"uv", "face_uv"}


def _check_options(
    kind: str, name: str, factory: Callable[..., Any], options: Mapping[str, Any]
) -> None:
    """Raise ValueError for options that a factory does not have, and for values out of range."""
    signature = signature_of(factory)
    of_refiner = kind == refiners.kind
    found = _options_of_refiner(signature) if of_refiner else options_of(signature)
    declared = {option.name: option for option in found}
    allowed = set(declared)
    takes_anything = False
    for parameter in signature.parameters.values():
        values = _names_of_values(parameter)
        allowed |= values
        takes_anything |= parameter.kind is parameter.VAR_KEYWORD and not values
    unknown = sorted(set(options) - allowed)
    if unknown and not takes_anything:
        takes = f"it takes {sorted(allowed)}" if allowed else "it takes none"
        raise ValueError(f"unknown option {unknown[0]!r} for {kind} {name!r}; {takes}")
    for each, value in options.items():
        if each in declared:
            declared[each].check(value)


@functools.cache
def entry_points_of(group: str) -> "Mapping[str, EntryPoint]":
    """The entry points of a group, by name; they are looked up once."""
    from importlib.metadata import entry_points  # its import takes as long as all of this package

    return {point.name: point for point in entry_points(group=group)}
