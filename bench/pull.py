"""Are muscles found again by pulling the skin? `risorius bench pull`.

One to three muscles of the left side, by chance, move the skin of the built-in head. A finger is
put where the front of the face moved most, and draws each vertex under it to where it had gone.
Told are how far that was, how far the skin is from there when it has settled with the muscles that
are solved (sim.Pull), and how much of the whole face's motion is not found again.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np
import numpy.typing as npt

from risorius import assets, sim

from .report import processor, table

Array = npt.NDArray[np.float64]

FINGER = 16.0  # mm
FRONT = 75.0  # mm behind the tip of the nose that a finger reaches
LEAST = 1.5  # mm that a target is away at least
STEP, SETTLE = 1.0 / 60.0, 60  # [s], and steps until a pose is still
APART = ("gaze_", "head_", "tongue_", "lips_closed")


@dataclass(frozen=True)
class Pulled:
    """One target."""

    muscles: int  # that made it
    drawn: float  # mm on average under the finger
    short: float  # mm that are left with what was solved
    rest: float  # of the motion of the whole face, share that is not found again
    controls: int  # solved
    again: float  # share of the muscles that are among them
    press: float  # ms of processor time until the first answer
    frame: float  # ms of a frame while the finger moves
    release: float  # ms of the last answer


def measure(count: int, seed: int = 20030214) -> list[Pulled]:
    """Pull `count` times."""
    face, generator = sim.create(assets.load("head")), np.random.default_rng(seed)
    names = [each for each in face.controls if f"{each}_left" not in face.controls]
    usable = [(each,) for each in names if not each.startswith(APART)]
    left = [each for each in names if each.endswith("_left") and not each.startswith(APART)]
    pulled: list[Pulled] = []
    while len(pulled) < count:
        chosen = generator.choice(left, len(pulled) % 3 + 1, replace=False)
        moved = _settled(face, {str(n): float(generator.uniform(0.3, 1.0)) for n in chosen})
        is_front = face.rest_positions[:, 2] > face.rest_positions[:, 2].max() - FRONT
        middle = int((np.linalg.norm(moved, axis=1) * is_front).argmax())
        if np.linalg.norm(moved[middle]) > LEAST:
            pulled.append(_pulled(face, usable, set(chosen), moved, middle))
    return pulled


def _pulled(
    face: sim.Simulation,
    usable: Sequence[tuple[str, ...]],
    chosen: set[str],
    moved: Array,
    middle: int,
) -> Pulled:
    """Pull by a motion (V, 3) around a vertex."""
    face.reset()
    distance = np.linalg.norm(face.positions - face.positions[middle], axis=1)
    finger = np.flatnonzero(distance < FINGER)
    share = (1.0 - (distance[finger] / FINGER) ** 2) ** 2
    times = [time.process_time()]
    pull = sim.Pull(face, finger, share, usable)
    pull.targets = pull.targets + moved[finger]
    for task in (pull.follow, pull.follow, pull.solve):
        task()
        times.append(time.process_time())
    press, frame, release = 1e3 * np.diff(times)
    found = {name: value for names, value in pull.changes.items() for name in names}
    off = moved - _settled(face, found)
    short, drawn = (
        float(np.average(np.linalg.norm(each[finger], axis=1), weights=share))
        for each in (off, moved)
    )
    rest = float(np.linalg.norm(off) / np.linalg.norm(moved))
    again = len(chosen & found.keys()) / len(chosen)
    return Pulled(len(chosen), drawn, short, rest, len(found), again, press, frame, release)


def _settled(face: sim.Simulation, values: dict[str, float]) -> Array:
    """How far the skin moves (V, 3) [mm]."""
    face.reset()
    face.set_all(values)
    for _ in range(SETTLE):
        face.step(STEP)
    moved: Array = face.positions - face.rest_positions
    return moved


def report(pulled: Sequence[Pulled]) -> str:
    """The text to print: means, and medians of processor times."""
    rows = []
    for muscles in sorted({each.muscles for each in pulled}):
        some = [each for each in pulled if each.muscles == muscles]
        means = [np.mean([getattr(each, f.name) for each in some]) for f in fields(Pulled)[1:6]]
        times = [np.median([getattr(each, f.name) for each in some]) for f in fields(Pulled)[6:]]
        rows.append((muscles, len(some), *means, *times))
    columns = "muscles:7d|pulls:6d|drawn mm:9.1f|short mm:9.2f|rest of face:13.2f"
    columns += "|controls:9.1f|found again:12.2f|press ms:9.0f|frame ms:9.0f|release ms:11.0f"
    return "\n".join([f"Muscles that a finger on the skin finds again, on {processor()}", "",
                      *table(columns, rows)])  # fmt: skip
