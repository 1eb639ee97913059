"""Pull to pose: find the controls that hold the skin where a finger draws it (inverse kinematics).

The skin under the finger should stay at its targets when the finger is gone. Few controls should
change, and the rest of the face should not move. Minimise, over the controls u within their limits,

    sum_i s_i |A (t_i - p_i)|^2 + REST_WEIGHT sum_j a_j |p_j - p_j(0)|^2
        + d^2 sum_c (PRICE |u_c - u_c(0)| + EFFORT (u_c - u_c(0))^2)

i runs over the vertices under the finger, with targets t and weights s that add up to 1; d is the
mean distance to the targets. j runs over all other vertices, with areas a relative to the area
under the finger. The matrix A gives distances along the line of sight a small weight, because a
mouse does not determine them. PRICE and EFFORT keep changes of controls small.

Few controls are used. The first is the control that reduces the sum most. The second is the control
that reduces the sum most together with the first, and so on. The slopes at the start determine the
choice. So the controls depend only on the targets, not on the path of the finger, and the pose
stays when the finger is released.
A control that moves skin at the finger's rim more than skin at the mouse is only used if there is
no answer without it: a brow that is drawn up would open the lid. A control that moves other skin
most is not added if it only replaces a part of another one: a chin that is drawn down would lower
the lip instead of the jaw. Nor is it the first one if one or two others hold the skin nearly as
well, and move other skin much less: a corner that is drawn outward would move the whole mouth.
No control moves the finger's skin away from its target. Otherwise a chin that is drawn down would
also thrust the jaw forward, because this holds the rest of the jaw in its place.
A target beyond the reach of the strongest control is moved back to this reach, because the price
grows with d, and no control would be used farther out.

The price and the rest of the face keep the skin from reaching the mouse. So all changes are finally
multiplied by one factor, until the finger's centre is as near to the mouse as possible, or until a
control is at its limit. The factor keeps the ratios of controls: a smile that is pulled too far
remains a smile.

Solved by Gauss and Newton. p is a clone of the face, at rest; its slopes are measured on a second
clone, by moving one control a little and letting the skin come to rest. A clone's muscles have no
lag, so the skin comes to rest in six steps of 0.3 ms. The slopes include effects that linearised
springs lack: lips that stick and part, lids on their eyeballs, muscles that stiffen the skin.

Source: own; Sifakis, Neverov, Fedkiw 2005 solve for muscles from dense markers. With prices the
problem is an elastic net (Zou, Hastie 2005; lasso.py); with the factor at the end it is a relaxed
elastic net (Meinshausen 2007).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from ..geometry.arrays import Flags, Floats64
from .face import Simulation
from .lasso import Lasso

STEP_LENGTH = 1.0 / 60.0  # [s] of a clone's steps
Names = tuple[str, ...]


class Pull:
    """A finger on the skin, and the controls that move the skin like this finger."""

    MOST_CONTROLS = 3  # controls that are used
    ROUND_TOLERANCE = 0.01  # a change that counts as none, between rounds

    mends: bool  # whether the solution reduces the distance to the aims noticeably
    targets: Floats64  # where the finger draws each of its vertices [head units], shape (n, 3)

    def __init__(
        self,
        face: Simulation,
        vertices: npt.ArrayLike,
        firmness: npt.ArrayLike,
        candidates: Sequence[Names],
        sight: npt.ArrayLike = (0.0, 0.0, 1.0),
    ) -> None:
        """Begin at the current state of a face; the face itself does not change.

        vertices, firmness: the skin under the finger, (n,), as for `Touch.drag`. candidates:
        controls that may be used; a tuple holds controls that move together, such as both sides of
        a muscle. sight: direction in which the finger is seen, shape (3,).
        """
        self._base = face.clone()
        self._probe = face.clone()
        self._vertices = np.asarray(vertices, np.int64)
        share = np.asarray(firmness, np.float64)
        self._share = share / share.sum()
        middle_power = 6  # power of the firmness, for the skin next to the mouse
        self._middle = share**middle_power / (share**middle_power).sum()
        axis = np.asarray(sight, np.float64) / np.linalg.norm(sight)
        sight_weight = 0.05  # weight of a distance along the line of sight
        self._seen = np.eye(3) - (1.0 - sight_weight) * np.outer(axis, axis)
        _rest(self._base, {})
        self._home = self._base.clone()
        self._from = self._base.positions.copy()
        self.targets = self._aims = self._from[self._vertices]
        self._area = face.areas / face.areas[self._vertices].sum()
        self._area[self._vertices] = 0.0
        self._given = candidates
        self.candidates = list[Names]()
        self._value = self._start = np.zeros(0)
        self._drawn = 0.0  # mean square distance to the aims
        self.mends = False

    def _choose_candidates(self) -> bool:
        """Find the controls that matter, and slopes; False if none matters."""
        if self._given:
            self.candidates = self._strongest(self._given)
            self._given = ()
            controls = self._home.controls
            firsts = [names[0] for names in self.candidates]
            values = controls.values
            limits = [controls.limits[first] for first in firsts]
            self._limits = np.array(limits, np.float64).reshape(-1, 2).T
            self._value = self._start = np.array([values[first] for first in firsts], np.float64)
            self._slope = np.zeros((len(firsts), *self._from.shape))
            self._measure(np.arange(len(firsts)))
            self._leave_out_others()
            self._first = self._slope.copy()
            lengths = np.linalg.norm(self._slope, axis=2)
            under = lengths[:, self._vertices].max(axis=1)
            self._is_at_home = under > 0.95 * lengths.max(axis=1)
        return bool(self.candidates)

    def _leave_out_others(self) -> None:
        """Leave out candidates that are meant for other skin."""
        at_mouse = self._middle @ self._slope[:, self._vertices] @ self._seen  # (candidates, 3)
        centre = np.linalg.norm(at_mouse, axis=1)
        fraction = centre / np.linalg.norm(self._slope, axis=2).max(axis=1, initial=1e-12)
        # A control is meant for other skin if the skin next to the mouse moves less than this share
        # of the control's largest motion. Where all controls move the skin little, as on the nose,
        # those that move it most are used.
        least_of_largest = 0.25
        least_of_best = 0.7
        best = fraction.max(initial=0.0)
        is_meant = fraction > min(least_of_largest, least_of_best * best)
        # Other controls move the finger's rim more than the skin at the mouse.
        least_of_finger = 0.7
        lengths = np.sqrt([self._square(slope[self._vertices]) for slope in self._slope])
        self._is_at_mouse = (centre > least_of_finger * lengths)[is_meant]
        self.candidates = [self.candidates[n] for n in np.flatnonzero(is_meant)]
        self._limits = self._limits[:, is_meant]
        self._value = self._start = self._start[is_meant]
        self._slope = self._slope[is_meant]

    @property
    def changes(self) -> dict[Names, float]:
        """Return new values of the changed controls, in order of their change, greatest first."""
        moved = np.abs(self._value - self._start) * self.mends
        changed = np.flatnonzero(moved > self.ROUND_TOLERANCE)
        order = sorted(changed, key=lambda n: -round(float(moved[n]), 3))
        return {self.candidates[n]: float(self._value[n]) for n in order}

    @property
    def remaining(self) -> float:
        """Remaining distance of the finger's centre from its target, as seen [head units]."""
        there = self._base.positions if self.mends else self._from
        return float(np.linalg.norm(self._remaining_vector(self.targets, there)))

    def _remaining_vector(self, targets: Floats64, positions: Floats64) -> Floats64:
        """Vector from vertices (V, 3) to targets (n, 3) in the finger's middle, as seen, (3,)."""
        return np.asarray(self._middle @ (targets - positions[self._vertices]) @ self._seen)

    def solve(self) -> None:
        """Solve for these targets; earlier targets have no influence."""
        if not self._choose_candidates():
            return
        self._solve_with(self._is_at_mouse)
        if not self.changes and not self._is_at_mouse.all():
            self._solve_with(np.ones_like(self._is_at_mouse))

    def _solve_with(self, usable: Flags) -> None:
        """Solve with some of the candidates, and keep the better one of two answers.

        One answer begins with the control that improves most. The other one begins with a control
        that moves the finger's skin most. It is better if it holds this skin nearly as well with
        one or two controls, and moves other skin much less.
        """
        self._usable = usable
        self._begin()
        nearest = self._chosen_after(np.ones_like(usable))
        at_home = self._chosen_after(self._is_at_home)
        most_moved = 2.0 / 3.0  # of the other answer's motion of other skin, squared
        moved, moved_at_home = map(self._motion_of_others, (nearest, at_home))
        is_calmer = 1 <= at_home.sum() <= 2 and moved_at_home < most_moved * moved
        self._solve_from(nearest)
        if is_calmer:
            most_loss = 0.1  # of the squared distances
            least = self._squared_error(self._base.positions)
            self._solve_from(at_home)
            if self._squared_error(self._base.positions) > least + most_loss * self._drawn:
                self._solve_from(nearest)

    def _begin(self) -> None:
        """Return to the state before the pull, and set the aims."""
        self._base.copy_from(self._home)
        self._slope[:] = self._first
        self._value = self._start
        self._aim()

    def _solve_from(self, needed: Flags) -> None:
        """Solve with these controls, and with others that become necessary."""
        self._begin()
        most_rounds = 12  # of Gauss and Newton at most
        for _ in range(most_rounds):
            before = self._value
            self._value = before + self._system().minimise(needed)
            self._take_values()
            if np.abs(self._value - before).max(initial=0.0) < self.ROUND_TOLERANCE:
                break
            self._measure(np.flatnonzero(self._value != self._start))
            needed = self._with_best(needed, np.ones_like(needed))
        least_gain = 0.25  # of the squared distances: an answer must reduce them by at least this
        self.mends = self._squared_error(self._base.positions) < (1.0 - least_gain) * self._drawn
        if self.mends:
            self._stretch()

    def _chosen_after(self, firsts: Flags) -> Flags:
        """Choose controls one after another, the first one among those flagged by `firsts`."""
        needed = self._with_best(np.zeros_like(firsts), firsts)
        while (more := self._with_best(needed, firsts)).sum() > needed.sum():
            needed = more
        return needed

    def _motion_of_others(self, needed: Flags) -> float:
        """Mean square motion of all other skin by some controls, computed from slopes."""
        moved = np.tensordot(self._system().change(needed), self._slope, 1)
        return float(self._area @ (moved**2).sum(axis=1))

    def _take_values(self) -> None:
        """Let the clone's skin come to rest under the solved values."""
        values = zip(self._value.tolist(), self.candidates, strict=True)
        _rest(self._base, {name: each for each, names in values for name in names})

    def _stretch(self) -> None:
        """Let all changes grow by one factor until the finger's middle is nearest to the mouse."""
        drawn = self._remaining_vector(self.targets, self._from)
        most_rounds = 6  # the skin's motion is not proportional
        for _ in range(most_rounds):
            went = drawn - self._remaining_vector(self.targets, self._base.positions)
            changed = self._value - self._start
            moved = changed != 0.0
            ends = np.where(changed > 0.0, self._high, self._low) - self._start
            to_limit = float((ends[moved] / changed[moved]).min(initial=np.inf))
            factor = min(float(went @ drawn) / max(float(went @ went), 1e-12), to_limit)
            if not factor > 1.0 + self.ROUND_TOLERANCE:
                break
            self._value = self._start + factor * changed
            self._take_values()

    def _aim(self) -> None:
        """Set the aims of the finger, limited to the reach of the strongest control.

        Also set the limits of controls: none may move the finger's skin away from its aims.
        """
        drawn = self.targets - self._from[self._vertices]
        seen = (self._share[:, None] * drawn) @ self._seen
        along = ((self._first[:, self._vertices] @ self._seen) * seen).sum(axis=(1, 2))
        lengths = np.sqrt([self._square(slope[self._vertices]) for slope in self._first])
        # Cosine between two motions, from which on they count as motions in one direction.
        least_cosine = 0.5
        least = least_cosine * lengths * np.sqrt(self._square(drawn))
        low, high = self._limits
        self._low = np.where(along > least, self._start, low)
        self._high = np.where(along < -least, self._start, high)
        room = np.where(along > 0.0, high, low) - self._start
        reach = float((along * room)[self._usable].max(initial=0.0))
        drawn *= min(reach / max(self._square(drawn), 1e-12), 1.0)
        self._aims = self._from[self._vertices] + drawn
        self._drawn = max(self._squared_error(self._from), 1e-12)

    def _strongest(self, candidates: Sequence[Names]) -> list[Names]:
        """Return the candidates that move the finger's skin most within a step."""
        moved = []
        for names in candidates:
            self._probe.copy_from(self._base)
            self._probe.jump(_shifted(self._base, names, 1.0))
            self._probe.step(STEP_LENGTH)
            moved.append(self._square((self._probe.positions - self._from)[self._vertices]))
        most_candidates = 16  # number of examined controls: those that move the finger's skin most
        strongest = sorted([0.0, *moved])[-most_candidates:]
        least = 0.99 * strongest[0]  # two equal controls are both included
        return [c for c, far in zip(candidates, moved, strict=True) if far > least]

    def _square(self, by: Floats64) -> float:
        """Mean square of distances (n, 3) under the finger, as seen."""
        return float(self._share @ ((by @ self._seen) ** 2).sum(axis=1))

    def _squared_error(self, positions: Floats64) -> float:
        """Mean square distance of vertices (V, 3) under the finger from their aims."""
        return self._square(self._aims - positions[self._vertices])

    def _measure(self, which: npt.ArrayLike) -> None:
        """Slopes of the skin in the controls with these indices, at the current values."""
        probe_fraction = 0.25  # of a control's range, to measure its slope
        for n in np.asarray(which, np.int64):
            names = self.candidates[n]
            self._slope[n] = _slope(self._base, self._probe, names, probe_fraction)

    def _with_best(self, needed: Flags, firsts: Flags) -> Flags:
        """Return the used controls and the control that improves most together with them.

        firsts: flags of the controls that may be the first one.
        """
        if needed.sum() >= self.MOST_CONTROLS:
            return needed
        system = self._system()
        # A control is not added if it improves the squared distances by less than this share.
        least_worth = 0.025
        worth = least_worth * self._drawn
        single = np.eye(len(needed), dtype=bool)
        costs = np.array([system.cost(needed | one) for one in single])
        # A control that moves other skin most is not added if it replaces a part of a used control.
        least_kept = 0.8  # share of a used control's change that must stay
        before = system.change(needed)
        for n in np.flatnonzero(~needed & ~self._is_at_home):
            after = system.change(needed | single[n])
            if (np.abs(after) < least_kept * np.abs(before))[needed].any():
                costs[n] = np.inf
        costs[~self._usable] = np.inf
        if not needed.any():
            costs[~firsts] = np.inf
        best = needed | single[costs.argmin()]
        # Controls whose gains differ by less than this share are used together, such as both sides
        # of a muscle.
        alike_share = 0.2
        alike = needed | (costs <= costs.min() + alike_share * worth)
        if alike.sum() > best.sum() and system.cost(alike) < costs.min() - worth:
            best = alike
        is_worth_it = best.sum() <= self.MOST_CONTROLS and costs.min() < system.cost(needed) - worth
        return best if is_worth_it else needed

    def _system(self) -> Lasso:
        """Return the linear problem at the current values."""
        now = self._base.positions
        count = len(self._value)
        root = np.sqrt(self._share)[:, None]
        under = ((self._slope[:, self._vertices] @ self._seen) * root).reshape(count, -1)
        off = (((self._aims - now[self._vertices]) @ self._seen) * root).ravel()
        slope = self._slope.reshape(count, -1)
        # Weight of the rest of the face, relative to an equal area under the finger.
        rest_weight = 0.02
        others = slope * np.repeat(rest_weight * self._area, 3)
        square_price = 0.034  # the same, as the square of its share: two equal controls share it
        effort = square_price * self._drawn
        changed = self._value - self._start
        price = 0.0041  # of a control at its limit, against skin that does not move at all
        back = (self._from - now).ravel()  # of the rest of the face, to its place before the pull
        return Lasso(
            gram=under @ under.T + others @ slope.T + effort * np.eye(count),
            right=under @ off + others @ back - effort * changed,
            price=0.5 * price * self._drawn / np.abs(self._limits).max(axis=0),
            changed=changed,
            low=self._low - self._start,
            high=self._high - self._start,
        )


def _rest(clone: Simulation, values: dict[str, float]) -> None:
    clone.jump(values)
    steps_to_rest = 6  # of a clone after a small change; less than a twentieth of it is left
    for _ in range(steps_to_rest):
        clone.step(STEP_LENGTH)


def _shifted(face: Simulation, names: Names, fraction: float) -> dict[str, float]:
    """Values of controls moved up by a share of their range, or down without room above."""
    low, high = face.controls.limits[names[0]]
    value = face.controls.values[names[0]]
    step = fraction * (high - low)
    moved = value + step if value + step <= high else max(value - step, low)
    return dict.fromkeys(names, moved)


def _slope(base: Simulation, probe: Simulation, names: Names, fraction: float) -> Floats64:
    """Motion of the skin for each unit of controls that move together, (V, 3) [head units].

    The probe moves the controls by a share of their range.
    """
    moved = _shifted(base, names, fraction)
    probe.copy_from(base)
    _rest(probe, moved)
    by = moved[names[0]] - base.controls.values[names[0]]
    slope: Floats64 = (probe.positions - base.positions) / by
    return slope


def motion_of(face: Simulation, name: str) -> Floats64:
    """Motion of the resting skin from 0 to 1 of a control, to first order, (V, 3) [head units].

    The face itself does not change.
    """
    base = face.clone()
    base.reset()
    return _slope(base, base.clone(), (name,), 1.0)
