"""Mend the shipped form in three places: `python -m risorius.bench.form_mending FOLDER`.

The nose is shortened along the modes of people until it stands out as published means ask, while
eyes and lips stay; ears are raised, to reach from the brows to the base of the nose; the insides of
the lips part farther, as those of scanned people do. All else is carried along smoothly. It begins
with the head of revision f4bd608f.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from risorius import assets
from risorius.app.files import folder_atomically
from risorius.assets.identities.person import ears_off_head
from risorius.assets.identities.space import person_space
from risorius.assets.intersections import self_intersections
from risorius.assets.model import FloatArray, Head, IndexArray
from risorius.assets.norms import NORMS, measures_of
from risorius.assets.topology import smallest_angles

from .form import OWN, Form, save, without_cuts
from .registration import MIRROR, Target, relaxed, spread

SIDES = ("left", "right")
# By how many deviations measures are to change.
WANTED = {"sn-prn": -1.15, "ls-sto": -0.4, "n-gn": 0.15, "al-al": -0.1}
ASKED, KEPT, STILL = 25.0, 1.0, 0.25  # how these count, and others; [mm] that held rows may give
EAR_SHIFT, EAR_SCALE = np.array([0.0, 4.5, 0.0]), np.array([1.0, 1.05, 1.0])
EAR_REACH, FACE = 45.0, 30.0  # [mm] around an ear that follow; z before which nothing does
FADE = 18.0  # [mm] from held rows, beyond which nothing is held
LEAST_ANGLE = 14.0  # [deg] of triangles
INSIDE = (4.6, -5.7)  # [mm] of mouth_0 up or down, and back, from mouth_2
CORNER = 0.3  # of the way there at the corners of the mouth


def rows_of(head: Head, *names: str) -> IndexArray:
    """The vertices of some rows of both sides."""
    return np.unique(np.concatenate([head.rings[f"{n}_{s}"] for n in names for s in SIDES]))


def shorter_nose(head: Head) -> tuple[FloatArray, FloatArray]:
    """Displacements (V, 3), and the weights of the modes (k,) that the head has with them."""
    space = person_space()
    held = rows_of(head, *(f"eye_{k}" for k in range(5)), *(f"mouth_{k}" for k in range(7)))
    deviations = np.array([0.5 * (n.women.deviation + n.men.deviation) for n in NORMS.values()])
    rows = space.slopes / deviations[:, None]
    counts = np.array([ASKED if code in WANTED else KEPT for code in NORMS])
    aim = np.array([WANTED.get(code, 0.0) for code in NORMS])
    still = space.modes[:, held].reshape(len(space.modes), -1) / STILL
    still /= np.sqrt(len(held) / 10.0)
    system = np.eye(len(space.own)) + rows.T @ (counts[:, None] * rows) + still @ still.T
    step = np.linalg.solve(system, rows.T @ (counts * aim))
    moved = space.moved(step)
    fixed = rows_of(head, *(f"eye_{k}" for k in range(5)), *(f"mouth_{k}" for k in range(4)))
    fixed = np.union1d(fixed, rows_of(head, "rim"))
    away = np.linalg.norm(head.vertices[:, None] - head.vertices[fixed], axis=2).min(axis=1)
    back = -moved.copy()
    back[away > FADE] = 0.0
    known = np.union1d(fixed, np.flatnonzero(away > FADE))
    return moved + spread(head, head.vertices, back[None], known)[0], space.own + step


def higher_ears(head: Head, x: FloatArray) -> FloatArray:
    """Displacements (V, 3) that raise both ears."""
    moved, far = np.zeros_like(x), np.ones(len(x), dtype=bool)
    ears = rows_of(head, *(f"ear_{k}" for k in range(5)), "concha")
    for side in SIDES:
        own = np.array([v for v in ears if (x[v, 0] > 0.0) == (side == "left")])
        middle = x[head.rings[f"ear_0_{side}"]].mean(axis=0)
        moved[own] = EAR_SHIFT + (EAR_SCALE - 1.0) * (x[own] - middle)
        moved[head.anatomy[f"tragion_{side}"]] = EAR_SHIFT
        far &= np.linalg.norm(x - middle, axis=1) > EAR_REACH
    far |= x[:, 2] > FACE
    tragi = [head.anatomy[f"tragion_{side}"] for side in SIDES]
    known = np.unique(np.r_[ears, tragi, np.flatnonzero(far)])
    return np.asarray(spread(head, x, moved[None], known)[0])


def open_insides(head: Head, x: FloatArray) -> FloatArray:
    """Vertices of which the rows behind the lips part upward and downward, as scanned lips do."""
    new, ring = x.copy(), head.rings["mouth_0_left"]
    for column, edge in enumerate(x[head.rings["mouth_2_left"]]):
        share = min(1.0, CORNER + 1.6 * (1.0 - CORNER) * abs(column - 7) / 7.0)
        off = x[ring[column]] - edge
        up = float(np.sign(7 - column)) * INSIDE[0]
        new[ring[column]] += share * (np.array([off[0], up, INSIDE[1]]) - off)
    new[head.mirror[ring]] = new[ring] * MIRROR
    return new


def mended(head: Head) -> Form:
    """The head, mended."""
    fine = head.finer(2)
    nose, own = shorter_nose(head)
    x = head.vertices + nose
    x = x + higher_ears(head, x)
    x = open_insides(head, x)
    x = 0.5 * (x + x[head.mirror] * MIRROR)
    finest = fine.vertices + fine.interpolate(x - head.vertices)
    ears = np.flatnonzero(np.linalg.norm(x - head.vertices - nose, axis=1) > 0.05)
    ears = ears[x[ears, 2] < FACE].astype(np.int32)
    x = ears_off_head(head, relaxed(head, x, Target(finest, fine.faces), ears, LEAST_ANGLE))
    finest = fine.vertices + fine.interpolate(x - head.vertices)
    right = np.flatnonzero(head.vertices[:, 0] < 0.0)
    x[right] = x[head.mirror[right]] * MIRROR
    x[head.mirror == np.arange(len(x)), 0] = 0.0
    finest[: len(x)] = x
    finest = without_cuts(head, fine, x, finest)
    modes = person_space().modes
    return Form(x, finest, head.eyes, head.parts, head.jaw_axis, modes, own)


def main(folder: Path) -> None:
    """Write the mended head."""
    head = assets.load("head")
    form = mended(head)
    with folder_atomically(folder, OWN, overwrite=True) as part:
        save(head, form, part)
    for code, size in measures_of(form.vertices, head.anatomy).items():
        print(f"{code:8} {size:6.1f}")
    print("triangles that cut each other:", len(self_intersections(form.vertices, head.faces)))
    print("smallest angle:", smallest_angles(form.vertices, head.faces).min())


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:]))
