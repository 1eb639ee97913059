"""What a face does while nobody moves it: it blinks, glances about, and its head is never still.

`Idle` lays that beneath what is asked of a scene, and looks at the viewer: the eyes turn first,
each on its own, so that they meet there; beyond some degrees the head turns, too. Who stands
further aside is not followed. Controls that somebody else moves are left to him, together with
those that belong to them: who sets one way of the gaze has both eyes, who lowers a lid has both
lids.

Plain functions of time: the same seed and the same time give the same values, in whatever order
they are asked for, and no clock is read. Moments (blinks, glances) are drawn from a generator as
far ahead as somebody asks; what is slow is a sum of sines.

Sources (a head takes part in shifts of gaze of more than some 15 or 20 degrees: Freedman and Sparks
1997; Stahl 1999), for people at rest who look at somebody:
    Bentivoglio et al. 1997, "Analysis of blink rate patterns in normal subjects": 17 blinks a
        minute at rest, 26 in conversation.
    Trutoiu et al. 2011, "Modeling and animating eye blinks": lids shut fast and open slowly; blinks
        alike in both directions look unnatural.
    Lee, Badler, Badler 2002, "Eyes alive": how large saccades are, how long eyes stay with somebody
        and away from them, how long a saccade takes.
Differs from them: every blink shuts the eye, while about half of real ones do not (Ousler et al.
2014); glances away are shorter than 12 degrees, as there is nothing to be seen beside the viewer.
"""

from __future__ import annotations

import bisect
import math

import numpy as np
import numpy.typing as npt

from ..scenes import FaceScene, Scene

Values = dict[str, float]
Place = tuple[float, float]  # to the left and up [degrees]

# Blinks. Times between them are log-normal: never short, at times long.
BLINK_MEDIAN, BLINK_SPREAD = 3.3, 0.55  # [s] between two, and of its logarithm
DOUBLE_BLINKS = 0.1  # share that a second one follows at once
DOUBLE_AFTER = 0.34, 0.46  # [s] from the first to the second, least and most
FIRST_BLINK = 1.5, 3.0  # [s] after the start
# The lid's muscle follows late, and a short pulse would not shut the eye. With these the lid of the
# simulation is down by 95 % after 0.12 s, stays so for 0.09 s (99 % at most), comes up in 0.13 s.
SHUT_FOR, OPENS_IN = 0.14, 0.18  # [s] that the muscle is drawn, and then relaxes

# Glances [degrees], [s]
EYE_RANGE = 30.0  # that gaze = 1 stands for
FACE_SPREAD = 1.1, 0.7  # of glances over the viewer's face, across and along
FACE_LARGEST = 2.4
FACE_MEDIAN, FACE_DURATION_SPREAD = 1.3, 0.55
FIRST_PRESET = 2.5  # at the viewer, straight
AWAY = 0.18  # share of glances that leave the viewer: eyes stay some 8 s, as a listener's
AWAY_MEAN, AWAY_LEAST, AWAY_MOST = 6.9, 4.0, 12.0  # exponential, cut off
AWAY_FLATNESS = 0.55  # up and down is shorter
AWAY_MEDIAN, AWAY_DURATION_SPREAD = 0.7, 0.4
# A saccade takes 21 ms and 2.2 ms more for each degree. The eye's own lag is the former.
SECONDS_PER_DEGREE = 0.0022

# The head at rest: most that it strays [degrees], and what its controls stand for at 1.
HEAD_STRAYS = {"head_yaw": 1.2, "head_pitch": 0.7, "head_roll": 0.6}
HEAD_RANGES = {"head_yaw": 45.0, "head_pitch": 30.0, "head_roll": 30.0}
HEAD_PERIODS = 4.7, 7.9, 13.3  # [s]

LID = "orbicularis_oculi_palpebral_upper"
SIDES = "left", "right"


class Life:
    """The idle life of one face."""

    def __init__(self, seed: int = 0) -> None:
        """seed: faces of different seeds do the same things at different times."""
        lids, eyes, slow = (np.random.default_rng([seed, part]) for part in range(3))
        self._blinks = Blinks(lids)
        self._glances = Glances(eyes)
        self._head = {name: Drift(slow, HEAD_PERIODS) for name in HEAD_STRAYS}

    def parts(self, time: float) -> dict[str, Values]:
        """What to add to each control at `time` [s] from the start; what is not named is 0.

        In parts, each of which is moved together: lids, eyes, head.
        """
        across, along = self._glances.at(time)
        strays = {name: most * self._head[name].at(time) for name, most in HEAD_STRAYS.items()}
        return {
            "lids": _both(LID, self._blinks.at(time)),
            "eyes": {
                **_both("gaze_horizontal", across / EYE_RANGE),
                **_both("gaze_vertical", along / EYE_RANGE),
            },
            "head": {name: degrees / HEAD_RANGES[name] for name, degrees in strays.items()},
        }


def _both(name: str, value: float) -> Values:
    return {f"{name}_{side}": value for side in SIDES}


class Blinks:
    """When the eyes shut."""

    def __init__(self, generator: np.random.Generator) -> None:
        self._generator = generator
        self.starts = [float(generator.uniform(*FIRST_BLINK))]  # [s] in order, as far as drawn

    def at(self, time: float) -> float:
        """How far the lids' muscle is drawn, 0 to 1."""
        self.reach(time)
        last = bisect.bisect_right(self.starts, time) - 1
        return 0.0 if last < 0 else lid(time - self.starts[last])

    def reach(self, time: float) -> None:
        """Draw all blinks that begin until `time`."""
        generator = self._generator
        while self.starts[-1] <= time:
            wait = float(generator.lognormal(math.log(BLINK_MEDIAN), BLINK_SPREAD))
            start = self.starts[-1] + max(wait, DOUBLE_AFTER[1])
            self.starts.append(start)
            if generator.random() < DOUBLE_BLINKS:
                self.starts.append(start + float(generator.uniform(*DOUBLE_AFTER)))


def lid(age: float) -> float:
    """How far the lids' muscle is drawn `age` [s] after a blink began: at once, then less."""
    if not 0.0 <= age < SHUT_FOR + OPENS_IN:
        return 0.0
    return 0.5 + 0.5 * math.cos(math.pi * max(age - SHUT_FOR, 0.0) / OPENS_IN)


class Glances:
    """Where the eyes look, seen from straight at the viewer: to the left and up [degrees]."""

    def __init__(self, generator: np.random.Generator) -> None:
        self._generator = generator
        self.starts = [0.0, FIRST_PRESET]  # [s] in order, as far as drawn
        self.places = [(0.0, 0.0), self._on_face()]  # that is looked at from then on

    def at(self, time: float) -> Place:
        """Where they look at `time` [s]; a saccade leads from one place to the next."""
        while self.starts[-1] <= time:
            self._draw()
        last = max(bisect.bisect_right(self.starts, time) - 1, 0)
        before, there = self.places[max(last - 1, 0)], self.places[last]
        duration = SECONDS_PER_DEGREE * math.dist(before, there)
        share = min((time - self.starts[last]) / duration, 1.0) if duration else 1.0
        return (
            before[0] + share * (there[0] - before[0]),
            before[1] + share * (there[1] - before[1]),
        )

    def _draw(self) -> None:
        """How long the last place is looked at, and the next one."""
        generator = self._generator
        is_away = math.hypot(*self.places[-1]) > FACE_LARGEST
        if is_away:
            stays = generator.lognormal(math.log(AWAY_MEDIAN), AWAY_DURATION_SPREAD)
        else:
            stays = generator.lognormal(math.log(FACE_MEDIAN), FACE_DURATION_SPREAD)
        self.starts.append(self.starts[-1] + float(stays))
        leaves = not is_away and generator.random() < AWAY
        self.places.append(self._away() if leaves else self._on_face())

    def _on_face(self) -> Place:
        """A place of the viewer's face: an eye, the other, the mouth."""
        across, along = self._generator.normal(0.0, FACE_SPREAD)
        shrink = min(FACE_LARGEST / max(math.hypot(across, along), 1e-9), 1.0)
        return float(across * shrink), float(along * shrink)

    def _away(self) -> Place:
        """A place beside the viewer."""
        size = AWAY_LEAST + float(self._generator.exponential(AWAY_MEAN - AWAY_LEAST))
        size = min(size, AWAY_MOST)
        angle = float(self._generator.uniform(0.0, 2.0 * math.pi))
        return size * math.cos(angle), AWAY_FLATNESS * size * math.sin(angle)


class Drift:
    """Something slow that strays between -1 and 1: sines of periods that never meet."""

    def __init__(self, generator: np.random.Generator, periods: tuple[float, ...]) -> None:
        """periods: about [s]; phases, and a tenth of the periods, are left to chance."""
        self._waves = [
            (2.0 * math.pi / (period * generator.uniform(0.9, 1.1)), generator.uniform(0.0, 7.0))
            for period in periods
        ]

    def at(self, time: float) -> float:
        """Where it is at `time` [s]."""
        waves = [math.sin(rate * time + phase) for rate, phase in self._waves]
        return sum(waves) / len(waves)


EYES_ALONE = 10.0  # [degrees] off straight ahead that are left to the eyes
SHARE_OF_HEAD = 0.5  # of what lies beyond
EYES_MOST = 25.0  # [degrees] that eyes turn without strain
# [degrees] aside, and above or below: as far the viewer is looked at; and not at all.
FOLLOWED, LOST = (45.0, 32.0), (65.0, 45.0)


class Idle:
    """The life of a scene's face; a scene without one is left as it is."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self._life = Life()

    def beneath(
        self,
        moved: frozenset[str],
        viewer: npt.NDArray[np.float64],
        time: float,
        *,
        is_still: bool = False,
    ) -> Values:
        """What to add to the scene's controls at `time` [s] of its life.

        moved: lowest controls that are left alone. viewer: where he stands [mm], shape (3,).
        is_still: that it looks at the viewer is all.
        """
        if not isinstance(self.scene, FaceScene):
            return {}
        parts = {} if is_still else self._life.parts(time)
        for part, values in looking_at(self.scene, viewer).items():
            own = parts.get(part, {})
            sums = {name: own.get(name, 0.0) + value for name, value in values.items()}
            parts[part] = {**own, **sums}
        return {
            name: value
            for part in parts.values()
            if not moved & part.keys()
            for name, value in part.items()
            if name in self.scene.limits  # a rig may lack a muscle
        }


def looking_at(scene: FaceScene, viewer: npt.NDArray[np.float64]) -> dict[str, Values]:
    """The gaze and the pose of the head with which a face looks at a point [mm], shape (3,).

    The eyes make up for how the head is turned now. By parts, as `Life.parts`.
    """
    centres = {eye.name: np.asarray(eye.centre) for eye in scene.head.eyes}
    if not centres:
        return {}
    aside = _angles(viewer - np.mean(list(centres.values()), axis=0))
    share = math.prod(map(_followed, aside, FOLLOWED, LOST))
    turn, rise = (share * SHARE_OF_HEAD * _beyond(angle, EYES_ALONE) for angle in aside)
    to_rest = np.linalg.inv(scene.bone_transforms()["cranium"])
    seen = (to_rest @ [*viewer, 1.0])[:3]  # the viewer, as the turned head has him
    eyes = {}
    for side, centre in centres.items():
        for way, angle in zip(("horizontal", "vertical"), _angles(seen - centre), strict=True):
            angle = min(max(share * angle, -EYES_MOST), EYES_MOST)
            eyes[f"gaze_{way}_{side}"] = angle / EYE_RANGE
    head = {
        "head_yaw": turn / HEAD_RANGES["head_yaw"],
        "head_pitch": rise / HEAD_RANGES["head_pitch"],
    }
    return {"eyes": eyes, "head": head}


def _angles(way: npt.NDArray[np.float64]) -> tuple[float, float]:
    """To the left and up from straight ahead [degrees]."""
    x, y, z = way
    return math.degrees(math.atan2(x, z)), math.degrees(math.atan2(y, math.hypot(x, z)))


def _beyond(angle: float, least: float) -> float:
    return math.copysign(max(abs(angle) - least, 0.0), angle)


def _followed(angle: float, whole: float, none: float) -> float:
    """1 as far as `whole`, 0 from `none` on, and smooth between."""
    left = min(max((none - abs(angle)) / (none - whole), 0.0), 1.0)
    return left * left * (3.0 - 2.0 * left)
