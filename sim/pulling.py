"""Pull to pose: which muscles hold the skin where a finger draws it to, an inverse problem.

The skin under the finger shall lie at its targets once the finger is gone, with few muscles at work
and the rest of the face left alone: minimise over what changes of the controls, within their limits

    sum_i s_i |A (t_i - p_i)|^2  +  REST sum_j a_j |p_j - p_j(0)|^2 / sum_i a_i  +  sum_c price_c |u_c|

i runs over the vertices under the finger, with shares s that add up to 1, j over all others, with
areas a; A counts less what lies along the line of sight, which a mouse does not tell.

Gauss and Newton: p is a twin of the face at rest, and its slope is measured, on a second twin, by
moving each control a little and letting the skin come to rest. That takes six steps, since a twin's
muscles have no lag, and it knows what no linear model of the springs does: lips that stick and
part, lids on their eyeballs, muscles that stiffen the skin. Each step solves the bounded problem
exactly enough by going down along one control after the other.

Source: own; Sifakis, Neverov, Fedkiw 2005 solve for muscles from dense markers; the price per
control is the lasso of Tibshirani 1996, solved as by Friedman et al. 2007.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import numpy.typing as npt

from ..jit import njit
from .face import Simulation
from .landmarks import Array

STEP = 1.0 / 60.0  # [s] of a twin
STEPS_TO_REST = 6  # of a twin after a small change; what is left is a few hundredths of it
MOST = 20  # controls that are looked at: those that move the finger's skin most
PROBE = 0.25  # of a control's range, to measure its slope
ALONG = 0.15  # what a distance along the line of sight counts
REST = 0.02  # what the rest of the face counts, against as large an area under the finger
PRICE = 0.04  # mm2 for a control at its limit, under a finger that draws by REACH
DULL = 1e-3  # mm2: a control that moves the finger's skin by less has no slope
SWEEPS = 60
ROUNDS = 6  # of Gauss and Newton for a final answer
LEAST = 0.03  # of a control's range: what is less is left away


class Pull:
    """A finger on the skin, and the controls that do what it does."""

    def __init__(
        self,
        face: Simulation,
        vertices: npt.ArrayLike,
        firmness: npt.ArrayLike,
        *,
        candidates: Sequence[tuple[str, ...]],
        sight: npt.ArrayLike = (0.0, 0.0, 1.0),
    ) -> None:
        """Begin at a face as it is.

        vertices, firmness: of the finger, as for `Simulation.drag`. candidates: controls that may
        be used, those in one tuple together, such as both sides of a muscle. sight: direction in
        which the finger is seen, (3,).
        """
        self._base, self._probe = face.twin(), face.twin()
        self._vertices = np.asarray(vertices)
        share = np.asarray(firmness, np.float64)
        self._share = share / share.sum()
        axis = np.asarray(sight, np.float64)
        axis = axis / np.linalg.norm(axis)
        self._seen = np.eye(3) - (1.0 - ALONG) * np.outer(axis, axis)
        values = face.values
        self._base.jump({})
        self._rest(self._base)
        self._from = self._base.positions.copy()
        areas = face.areas
        self._area = REST * areas / areas[self._vertices].sum()
        self._area[self._vertices] = 0.0
        near = self._near(candidates)
        self.candidates = [candidates[n] for n in near]
        self._start = np.array([values[names[0]] for names in self.candidates])
        limits = [face.limits[names[0]] for names in self.candidates]
        self._low, self._high = np.array(limits, np.float64).reshape(-1, 2).T
        self._value = self._start.copy()
        self._slope = np.zeros((len(self.candidates), *self._from.shape))
        self.targets = self._from[self._vertices]
        for n in range(len(self.candidates)):
            self._measure(n)
        self._next = 0

    @property
    def changes(self) -> dict[str, float]:
        """The new values of all controls that are not where they were."""
        moved = np.flatnonzero(self._value != self._start)
        return {name: float(self._value[n]) for n in moved for name in self.candidates[n]}

    @property
    def short(self) -> float:
        """How far the skin is from where it was drawn to, on average and as seen [mm]."""
        off = (self.targets - self._base.positions[self._vertices]) @ self._seen
        return float(self._share @ np.linalg.norm(off, axis=1))

    def follow(self, count: int = 4) -> None:
        """A step of Gauss and Newton from where it is, with `count` slopes measured anew."""
        for _ in range(min(count, len(self.candidates))):
            self._measure(self._next)
            self._next = (self._next + 1) % len(self.candidates)
        self._improve(np.ones(len(self._value), bool), 1.0)

    def solve(self) -> None:
        """The answer for these targets, whatever the finger did on its way."""
        self._go(self._start)
        every = np.ones(len(self._start), bool)
        for n in range(len(self._start)):
            self._measure(n)
        for _ in range(ROUNDS):
            self._improve(every, 1.0)
            for n in np.flatnonzero(self._value != self._start):
                self._measure(n)
        few = np.abs(self._value - self._start) > LEAST * (self._high - self._low)
        self._go(np.where(few, self._value, self._start))
        for _ in range(ROUNDS // 2):
            self._improve(few, 0.0)
            for n in np.flatnonzero(few):
                self._measure(n)

    def _near(self, candidates: Sequence[tuple[str, ...]]) -> list[int]:
        """The candidates that move the finger's skin most, in the order of the candidates."""
        moved = []
        for names in candidates:
            self._probe.copy_from(self._base)
            self._probe.jump(self._towards(names, 1.0))
            self._probe.step(STEP)
            off = (self._probe.positions - self._from)[self._vertices] @ self._seen
            moved.append(float(self._share @ (off**2).sum(axis=1)))
        order = sorted(range(len(candidates)), key=lambda n: -round(moved[n], 6))[:MOST]
        return sorted(n for n in order if moved[n] > DULL)

    def _towards(self, names: tuple[str, ...], share: float) -> dict[str, float]:
        """Controls moved by a share of their range, back where there is no more room."""
        low, high = self._base.limits[names[0]]
        value = self._base.values[names[0]]
        step = share * (high - low)
        moved = value + step if value + step <= high else max(value - step, low)
        return dict.fromkeys(names, moved)

    def _measure(self, n: int) -> None:
        """The slope of the skin in one control, here."""
        names = self.candidates[n]
        moved = self._towards(names, PROBE)
        self._probe.copy_from(self._base)
        self._probe.jump(moved)
        self._rest(self._probe)
        self._slope[n] = self._probe.positions - self._base.positions
        self._slope[n] /= moved[names[0]] - self._value[n]

    def _rest(self, twin: Simulation) -> None:
        for _ in range(STEPS_TO_REST):
            twin.step(STEP)

    def _go(self, value: Array) -> None:
        self._value = value
        self._base.jump({name: float(value[n]) for n, c in enumerate(self.candidates) for name in c})
        self._rest(self._base)

    def _improve(self, usable: npt.NDArray[np.bool_], thrift: float) -> None:
        """One step of Gauss and Newton over the usable controls; thrift: 0 spares nothing."""
        now = self._base.positions
        under = self._slope[:, self._vertices] @ self._seen
        root = np.sqrt(self._share)[None, :, None]
        a = (under * root).reshape(len(under), -1)
        b = (((self.targets - now[self._vertices]) @ self._seen) * root[0]).ravel()
        gram, right = a @ a.T, a @ b
        if thrift:
            weight = thrift * self._area
            flat = (self._slope * weight[None, :, None]).reshape(len(a), -1)
            gram = gram + flat @ self._slope.reshape(len(a), -1).T
            right = right + flat @ (self._from - now).ravel()
        gram[np.diag_indices_from(gram)] += DULL
        right = right + DULL * (self._start - self._value)
        drawn = (self.targets - self._from[self._vertices]) @ self._seen
        worth = float(self._share @ (drawn**2).sum(axis=1))
        price = np.full(len(a), thrift * PRICE * worth) / (self._high - self._low)
        value = self._value.copy()
        descend(gram, right, price, self._start, np.where(usable, self._low, value),
                np.where(usable, self._high, value), value)
        self._go(value)


@njit
def descend(gram, right, price, start, low, high, value):  # type: ignore[no-untyped-def]
    """Minimise x G x / 2 - r x + price |u - start|, x = u - value, low <= u <= high, into `value`.

    One control after the other, each to its minimum, SWEEPS times.
    """
    count = len(value)
    moved = np.zeros(count)
    first = value.copy()
    for _ in range(SWEEPS):
        for c in range(count):
            pull = right[c] + gram[c, c] * moved[c]
            for d in range(count):
                pull -= gram[c, d] * moved[d]
            away = first[c] + pull / gram[c, c] - start[c]
            thresh = price[c] / gram[c, c]
            if away > thresh:
                away -= thresh
            elif away < -thresh:
                away += thresh
            else:
                away = 0.0
            moved[c] = min(max(start[c] + away, low[c]), high[c]) - first[c]
    for c in range(count):
        value[c] = first[c] + moved[c]
