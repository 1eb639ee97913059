"""Controls: the named values that a caller sets, and the activations that follow them.

The lowest controls are muscles, jaw and gaze. Controls of the layers above (layers.py) are set in
the same way, and add to the lowest controls by weights. The `wanted` value of a lowest control is
the sum of its own value and these additions, clamped to its limits.

A muscle does not reach a new activation at once: each control follows its wanted value as a
critically damped oscillator (90 % after some 90 ms, no overshoot). The oscillator is solved exactly
for every tick, so it is stable for any tick length and independent of the frame rate.

Own; 45 rad/s gives t50 = 37 ms and t90 = 86 ms on this model.
"""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
import numpy.typing as npt

from ..geometry.arrays import Floats64
from ..geometry.read_only import read_only
from ..jit import njit
from ..schema import quoted
from .checked import number as finite
from .checked import numbers
from .layers import BOTH_SIDES, NO_LAYERS, SIDE_ENDINGS, Layers, fraction_of_whole
from .rig import Rig

GAZE_RATE = 120.0  # rad/s: a saccade takes some 35 ms


@dataclass(frozen=True)
class Control:
    """One lowest input: a muscle, or a degree of freedom of a bone or the eyes."""

    name: str
    group: str
    low: float = 0.0
    high: float = 1.0
    rate: float = 45.0  # rad/s
    action: str = ""  # its effect, in words


class Controls:
    """All inputs of a face: the values that a caller sets, and the activations that follow them.

    A value beyond its limits raises ValueError; only sums are clamped here.

    The first C of all N controls are the lowest controls; only these have a wanted sum and an
    activation.
    """

    names: tuple[str, ...]
    """Names of all controls."""
    lowest: tuple[str, ...]
    """Names of the lowest controls: muscles, lips, jaw, gaze, head."""
    layers: Mapping[str, tuple[str, ...]]
    """Names of the controls of the layers above, by the title of the layer, from the bottom up."""
    limits: Mapping[str, tuple[float, float]]
    """Least and greatest value of each control, also of the layers' controls."""
    groups: Mapping[str, tuple[str, ...]]
    """Title of a group in a panel -> names of its controls; layers come last."""
    actions: Mapping[str, str]
    """The effect of each control, in words; "" if its file has none."""
    tables: Layers
    """The weights by which each control of the layers adds to the C lowest ones, in their order."""
    reached: Floats64
    """Activations of the lowest controls now, and a 0 behind them, shape (C + 1,), read only."""
    wanted: Floats64
    """Sums of the lowest controls, shape (C,), read only."""
    activation: Floats64
    """Values of the muscles, which follow `wanted`, shape (C,), read only."""

    def __init__(self, controls: tuple[Control, ...], layers: Layers = NO_LAYERS) -> None:
        self.lowest = tuple(control.name for control in controls)
        self.tables = layers
        self.names = (*self.lowest, *layers.shares)
        self.limits = MappingProxyType(_limits(controls, layers))
        groups: dict[str, tuple[str, ...]] = {}
        for control in controls:
            groups[control.group] = (*groups.get(control.group, ()), control.name)
        self.groups = MappingProxyType({**groups, **layers.groups})
        self.layers = layers.groups
        actions = {control.name: control.action for control in controls}
        self.actions = MappingProxyType({**actions, **layers.actions})
        self._places = {name: n for n, name in enumerate(self.names)}
        bounds = np.array([*self.limits.values()], np.float64).reshape(-1, 2)
        slack = 1e-6  # a value beyond a limit by less is a rounding error
        self._least = bounds[:, 0] - slack
        self._most = bounds[:, 1] + slack
        self._low, self._high = bounds[: len(controls)].T.copy()
        self._rate = np.array([control.rate for control in controls], dtype=np.float64)
        self._weights = np.array([layers.shares[name] for name in layers.shares])  # (N - C, C)
        floors = np.array([*layers.floors.values()]).reshape(len(layers.floors), len(controls))
        self._floored = np.flatnonzero(floors.any(axis=1))  # only few rows of layers have floors
        self._floors = floors[self._floored]
        self._share_of: list[tuple[int, int]] = []
        for name, whole in layers.share_of.items():
            self._share_of.append((self._places[name], self._places[whole]))
        self._values: Floats64 = np.zeros(len(self.names))
        self._wanted, self._speed = np.zeros((2, len(controls)))
        self._reached: Floats64 = np.zeros(len(controls) + 1)
        self._activation = self._reached[:-1]
        self.wanted = read_only(self._wanted)
        self.reached = read_only(self._reached)
        self.activation = self.reached[:-1]

    def place(self, name: str) -> int:
        """Index of a control in `names`; for a lowest control also in `wanted` and `activation`.

        Raises ValueError with similar names.
        """
        if not isinstance(name, str):
            raise ValueError(f"control: was {quoted(name)}, must be a name; see .limits for all")
        if name not in self._places:
            near = difflib.get_close_matches(name, self.names, n=3, cutoff=0.4)
            hint = f"did you mean {', '.join(near)}?" if near else "see .limits for all names"
            raise ValueError(f"there is no control called {quoted(name)}; {hint}")
        return self._places[name]

    @property
    def values(self) -> dict[str, float]:
        """Return the last value of each control that was set, including controls of the layers.

        The face follows within about 0.1 s.
        """
        return dict(zip(self.names, self._values.tolist(), strict=True))

    @property
    def sums(self) -> dict[str, float]:
        """The value of each lowest control, with the values that the layers above add to it."""
        return dict(zip(self.lowest, self.wanted.tolist(), strict=True))

    def places_in_reached(self, names: Iterable[str]) -> npt.NDArray[np.intp]:
        """Indices of controls in `reached`; the last index for controls without an entry."""
        none = len(self.lowest)
        return np.array([min(self._places.get(name, none), none) for name in names], np.intp)

    def set(self, name: str, value: float) -> None:
        """Set one control; raises ValueError for an unknown name or a value beyond its limits."""
        self.place(name)  # a wrong name may not even be hashable
        self.set_all({name: value})

    def set_all(self, values: Mapping[str, float]) -> None:
        """Set several controls; if `set` would refuse one of them, none is set."""
        self._set_over(self._values, values)

    def pose(self, values: Mapping[str, float]) -> None:
        """Set several controls, and all others to zero; if `set` would refuse one, none is set."""
        self._set_over(np.zeros_like(self._values), values)

    def _set_over(self, others: Floats64, values: Mapping[str, float]) -> None:
        if not isinstance(values, Mapping):
            raise ValueError(f"values: was {quoted(values)}, must be a mapping of name to number")
        wanted = others.copy()
        for name, value in values.items():
            wanted[self.place(name)] = finite(f"control '{name}'", value)
        self._store(wanted)

    def set_array(self, values: npt.ArrayLike) -> None:
        """Set all controls to values in the order of `names`; if one is wrong, none is set."""
        self._store(numbers("values", values, self._values.shape))

    def _store(self, wanted: Floats64) -> None:
        is_beyond = (wanted < self._least) | (wanted > self._most)
        if is_beyond.any():
            place = int(is_beyond.argmax())
            name = self.names[place]
            low, high = self.limits[name]
            raise ValueError(
                f"control '{name}': was {wanted[place]:g}, allowed is {low:g} to {high:g}; "
                "clamp it first"
            )
        self._values[:] = wanted
        self._wanted[:] = self._sums(wanted)

    def sums_of(self, values: npt.ArrayLike) -> Floats64:
        """The sums of the lowest controls, shape (C,), for values of all controls, shape (N,).

        Nothing is set.
        """
        return self._sums(numbers("values", values, self._values.shape))

    def _sums(self, values: Floats64) -> Floats64:
        count = len(self.lowest)
        sums: Floats64 = values[:count].copy()
        if not len(self._weights):
            return sums
        counted = values.copy()
        for index, whole in self._share_of:
            counted[index] = fraction_of_whole(values[index], values[whole])
        sums += counted[count:] @ self._weights
        least = (counted[count:][self._floored, None] * self._floors).max(axis=0, initial=0.0)
        np.maximum(sums, least, out=sums, where=least > 0.0)
        return np.clip(sums, self._low, self._high, out=sums)

    def advance(self, dt: float) -> None:
        """Move activations toward the wanted values for `dt` [s], with exact critical damping."""
        follow(self._wanted, self._activation, self._speed, self._rate, dt)

    def arrive(self) -> None:
        """Set activations to the wanted values at once."""
        self._activation[:] = self._wanted
        self._speed[:] = 0.0

    def copy_from(self, other: Controls) -> None:
        """Copy values and activations from another `Controls` of the same face."""
        self._values[:] = other._values
        self._wanted[:] = other._wanted
        self._activation[:] = other._activation
        self._speed[:] = other._speed

    def reset(self) -> None:
        """Set all values and activations to zero at once."""
        for array in (self._values, self._wanted, self._reached, self._speed):
            array[:] = 0.0


class MuscleDrive:
    """Computes the activation and the pull of each muscle from control values.

    Each muscle has a control. If its halves usually act together (the lips, procerus), there is
    also a control for both, and the two add up. The pull is a power of the activation,

        pull = activation ^ drive_power

    because a muscle that contracts by half is also only half as stiff: without the power the skin
    would move less than half way. One exponent does not suit every muscle, so the muscle's `drive`
    multiplies the exponent. Source: own; fitted to the motion of skin at half activations.
    """

    def __init__(self, rig: Rig, names: tuple[str, ...], controls: Controls) -> None:
        self._controls = controls
        halved = {muscle.name for muscle in rig.muscles if muscle.halves}
        self._own = controls.places_in_reached(names)
        wholes = [name.removesuffix("_left").removesuffix("_right") for name in names]
        drive = {muscle.name: muscle.drive for muscle in rig.muscles}
        self._power = rig.tissue.drive_power * np.array(
            [drive[name] for name in wholes], np.float64
        )
        self._whole = controls.places_in_reached(name if name in halved else "" for name in wholes)

    def activation(self) -> Floats64:
        """Activation 0..1 of each muscle, (M,): its own control plus the one for both halves."""
        reached = self._controls.reached
        return np.minimum(np.maximum(reached[self._own] + reached[self._whole], 0.0), 1.0)

    def pull(self, activation: Floats64) -> Floats64:
        """The pull of each muscle's fibres, shape (M,), which moves skin about linearly."""
        return activation**self._power


def _limits(controls: tuple[Control, ...], layers: Layers) -> dict[str, tuple[float, float]]:
    """Return the limits of each control; a control for both sides has the limits of one side."""
    limits = {control.name: (control.low, control.high) for control in controls}
    for name in layers.shares:
        names = [name + side for side in SIDE_ENDINGS]
        sides = [limits[each] for each in names if each in limits]
        of_both = sides and name in layers.groups.get(BOTH_SIDES, ())
        limits[name] = sides[0] if of_both else (0.0, 1.0)
    return limits


@njit
def follow(
    wanted: Floats64, activation: Floats64, speed: Floats64, rate: Floats64, dt: float
) -> None:
    """Advance critically damped oscillators of angular frequency `rate` [rad/s] by `dt` [s]."""
    settled_distance = 1e-6  # a distance from the wanted value that counts as none
    settled_speed = 1e-4  # per second: a speed that counts as rest
    for n in range(len(wanted)):
        away = activation[n] - wanted[n]
        slope = speed[n] + rate[n] * away
        decay = np.exp(-rate[n] * dt)
        away = (away + slope * dt) * decay
        speed[n] = (speed[n] - rate[n] * slope * dt) * decay
        # Below a millionth a muscle is relaxed, because rest must be reached exactly.
        if abs(away) < settled_distance and abs(speed[n]) < settled_speed:
            away = speed[n] = 0.0
        activation[n] = wanted[n] + away
