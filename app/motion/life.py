"""Idle life of a face: blinks, glances and small motions of the head.

`Idle` adds this motion to a scene, and makes the face look at the viewer: each eye turns to the
viewer, and beyond 10 degrees the head turns too. A viewer far to the side is not followed. Idle
life does not touch controls that a script or a user moves, nor related controls: a set gaze in one
direction stops the glances of both eyes, and a lowered lid stops the blinks of both lids.

All values are functions of seed and time: they depend neither on the order of calls nor on a clock.
Time is divided into spans, and in each span one blink or one glance begins at a random moment. Slow
motion is a sum of sines.

Sources for people at rest who look at somebody:
    Freedman and Sparks 1997; Stahl 1999: the head takes part in shifts of gaze of more than 15 to
        20 degrees.
    Bentivoglio et al. 1997, "Analysis of blink rate patterns in normal subjects": 17 blinks a
        minute at rest, 26 in conversation.
    Trutoiu et al. 2011, "Modeling and animating eye blinks": lids shut fast and open slowly; blinks
        alike in both directions look unnatural.
    Munhall et al. 2004, "Visual prosody and speech intelligibility": a speaker's head moves with
        the loudness of speech.
    Lee, Badler, Badler 2002, "Eyes alive": size and duration of saccades, and the time for which
        eyes look at a person and away.
"""

from __future__ import annotations

import math

import numpy as np

from risorius.geometry.arrays import Floats64

from ..control_names.angles import FULL_ANGLES, GAZE_ANGLE
from ..scenes import Face, Scene

IdleValues = dict[str, float]
GlancePlace = tuple[float, float]  # to the left and up [degrees]


# Greatest idle motion of the head [degrees].
STRAY_ANGLES = {"head_yaw": 1.2, "head_pitch": 0.7, "head_roll": 0.6}
NOD_ANGLE = 4.0  # [degrees] that the head turns down for a fully open jaw
HEAD_PERIODS = np.array([4.7, 7.9, 13.3])  # [s] of the sines, without a common period

LID_CONTROL = "orbicularis_oculi_palpebral_upper"
# Separate streams of random numbers.
BLINK_STREAM = 0
GLANCE_STREAM = 1
PLACE_STREAM = 2
STRAY_STREAM = 3


class Life:
    """The idle life of one face."""

    def __init__(self, seed: int = 0) -> None:
        """seed: faces with different seeds blink and glance at different times."""
        self._seed = seed

    def parts(self, time: float) -> dict[str, IdleValues]:
        """Return amounts to add to controls at `time` [s], grouped into lids, eyes and head.

        Controls that are not named get 0.
        """
        across, along = self._glance(time)
        strays = zip(STRAY_ANGLES.items(), self._drifts(time), strict=True)
        blink_span = 3.5  # [s] for each blink
        return {
            "lids": _both_sides(
                LID_CONTROL, lid(time - self._latest(BLINK_STREAM, blink_span, time)[1])
            ),
            "eyes": {
                **_both_sides("gaze_horizontal", across / GAZE_ANGLE),
                **_both_sides("gaze_vertical", along / GAZE_ANGLE),
            },
            "head": {name: most * share / FULL_ANGLES[name] for (name, most), share in strays},
        }

    def _random(self, what: int, number: int) -> np.random.Generator:
        """Return the random generator of one span."""
        return np.random.default_rng([self._seed, what, number])

    def _latest(self, what: int, span: float, time: float) -> tuple[int, float]:
        """Return number and time [s] of the last event before `time` [s]; the first is number 1."""
        number = int(time // span) + 1
        latest_start = 0.8  # share of a span in which an event begins, so that two are apart
        for each in (number, number - 1):
            start = span * (each - 1 + latest_start * self._random(what, each).random())
            if start <= time and each > 0:
                return each, start
        return 0, -math.inf

    def _glance(self, time: float) -> GlancePlace:
        """Return the direction of gaze; a saccade leads from one target to the next."""
        glance_span = 1.6  # [s] for each glance
        number, start = self._latest(GLANCE_STREAM, glance_span, time)
        before = self._place(number - 1)
        there = self._place(number)
        # A saccade takes 21 ms, and 2.2 ms more for each degree. The eye's own lag makes the 21 ms.
        seconds_per_degree = 0.0022
        duration = seconds_per_degree * math.dist(before, there)
        share = min((time - start) / duration, 1.0) if duration else 1.0
        return (
            before[0] + share * (there[0] - before[0]),
            before[1] + share * (there[1] - before[1]),
        )

    def _place(self, number: int) -> GlancePlace:
        """Return the target of a glance, on the viewer's face or beside; the first is straight."""
        if number < 2:
            return 0.0, 0.0
        random = self._random(PLACE_STREAM, number)
        away_fraction = 0.1  # share of glances that leave the viewer
        if random.random() >= away_fraction:
            # Standard deviation of glances over the viewer's face, across and along [degrees].
            face_spread = 1.1, 0.7
            across, along = np.clip(random.normal(0.0, face_spread), -2.0, 2.0)
            return float(across), float(along)
        least_away = 4.0
        most_away = 12.0
        size = random.uniform(least_away, most_away)
        angle = random.uniform(0.0, 2.0 * math.pi)
        return size * math.cos(angle), 0.5 * size * math.sin(angle)

    def _drifts(self, time: float) -> list[float]:
        """Return slow motions of the head, each between -1 and 1: sines with random phases."""
        phases = self._random(STRAY_STREAM, 0).uniform(
            0.0, 7.0, (len(STRAY_ANGLES), len(HEAD_PERIODS))
        )
        drifts = np.sin(2.0 * math.pi * time / HEAD_PERIODS + phases).mean(axis=1)
        return [float(each) for each in drifts]


def _both_sides(name: str, value: float) -> IdleValues:
    sides = "left", "right"
    return {f"{name}_{side}": value for side in sides}


def lid(age: float) -> float:
    """Return the activation of the lids' muscle `age` [s] after a blink began."""
    # The simulated lid lags behind its muscle, so a short pulse would not shut the eye. With these
    # times the lid is 95 % shut after 0.12 s, stays shut for 0.09 s (99 % at most), and opens in
    # 0.13 s.
    shut_time = 0.14  # [s] of full activation
    opening_time = 0.18  # [s] in which it relaxes
    if not 0.0 <= age < shut_time + opening_time:
        return 0.0
    return 0.5 + 0.5 * math.cos(math.pi * max(age - shut_time, 0.0) / opening_time)


EYES_MOST = 25.0  # [degrees] that eyes turn without strain


class Idle:
    """The idle life of a scene's face; without a face it does nothing."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self._life = Life()

    def amounts(
        self,
        moved: frozenset[str],
        viewer: Floats64,
        time: float,
        *,
        is_still: bool = False,
        opening: float = 0.0,
    ) -> IdleValues:
        """Return amounts to add to the scene's controls at `time` [s].

        moved: lowest controls (sim/layers.py) that something else moves. viewer: position of the
        viewer [mm], shape (3,). is_still: whether the face only looks at the viewer. opening:
        opening of the jaw, 0 to 1; the head nods when the jaw opens, as on stressed syllables.
        """
        face = self.scene.face
        if face is None:
            return {}
        parts = {} if is_still else self._life.parts(time)
        for part, values in looking_at(face, viewer).items():
            own = parts.get(part, {})
            sums = {name: own.get(name, 0.0) + value for name, value in values.items()}
            parts[part] = {**own, **sums}
        if "head" in parts:
            nod = NOD_ANGLE * min(opening, 0.5)  # no syllable opens the mouth farther
            parts["head"]["head_pitch"] -= nod / FULL_ANGLES["head_pitch"]
        return {
            name: value
            for part in parts.values()
            if not moved & part.keys()
            for name, value in part.items()
            if name in self.scene.limits  # a rig may lack a muscle
        }


def looking_at(face: Face, viewer: Floats64) -> dict[str, IdleValues]:
    """Return values of gaze and head with which a face looks at a point [mm], shape (3,).

    The eyes compensate for the current turn of the head. Values are grouped as in `Life.parts`.
    """
    centres = {eye.name: np.asarray(eye.centre) for eye in face.head.eyes}
    if not centres:
        return {}
    aside = _angles(viewer - np.mean(list(centres.values()), axis=0))
    # Horizontal and vertical angles [degrees]: a nearer viewer is followed, a farther one is not.
    followed_angles = (45.0, 32.0)
    lost_angles = (65.0, 45.0)
    share = math.prod(map(_follow_weight, aside, followed_angles, lost_angles))
    eye_angle = 10.0  # [degrees] off straight ahead, up to which the head stays
    head_fraction = 0.5  # share of the angle beyond it that the head turns
    turn, rise = (share * head_fraction * _angle_beyond(angle, eye_angle) for angle in aside)
    to_rest = np.linalg.inv(face.bone_transforms()["cranium"])
    seen = (to_rest @ [*viewer, 1.0])[:3]  # the viewer in coordinates of the turned head
    eyes = {}
    for side, centre in centres.items():
        for way, angle in zip(("horizontal", "vertical"), _angles(seen - centre), strict=True):
            angle = min(max(share * angle, -EYES_MOST), EYES_MOST)
            eyes[f"gaze_{way}_{side}"] = angle / GAZE_ANGLE
    head = {
        "head_yaw": turn / FULL_ANGLES["head_yaw"],
        "head_pitch": rise / FULL_ANGLES["head_pitch"],
    }
    return {"eyes": eyes, "head": head}


def _angles(direction: Floats64) -> tuple[float, float]:
    """Return the angles of a direction to the left and up from straight ahead [degrees]."""
    x, y, z = direction
    return math.degrees(math.atan2(x, z)), math.degrees(math.atan2(y, math.hypot(x, z)))


def _angle_beyond(angle: float, least: float) -> float:
    return math.copysign(max(abs(angle) - least, 0.0), angle)


def _follow_weight(angle: float, whole: float, none: float) -> float:
    """Return 1 up to the angle `whole`, 0 above the angle `none`, and smooth values between."""
    left = min(max((none - abs(angle)) / (none - whole), 0.0), 1.0)
    return left * left * (3.0 - 2.0 * left)
