"""Controls that somebody leads from outside, such as a live face, over what hand or script say."""

from __future__ import annotations

from collections.abc import Mapping


class Lead:
    """Where controls are led to, and how far: by a share of 0 (not at all) to 1 (all the way)."""

    def __init__(self) -> None:
        self._controls: Mapping[str, float] = {}
        self._share = 0.0

    def take(self, controls: Mapping[str, float], share: float) -> None:
        """Lead these controls from now on, and no others."""
        self._controls, self._share = controls, share

    @property
    def is_on(self) -> bool:
        """Whether anything is led."""
        return self._share > 0.0

    def over(
        self, values: Mapping[str, float], limits: Mapping[str, tuple[float, float]]
    ) -> dict[str, float]:
        """The values with what is led, within limits; a control that has no value is left out."""
        led = dict(values)
        for name, wanted in self._controls.items() if self._share else ():
            if name in values:
                low, high = limits[name]
                led[name] += self._share * (min(max(wanted, low), high) - values[name])
        return led
