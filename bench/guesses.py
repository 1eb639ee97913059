"""Measure the errors of landmarks that are guessed from the first points of a head."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import scipy

from risorius.assets.fitting.guess import FIRST_LANDMARKS, guess
from risorius.assets.identities import person_called
from risorius.assets.meshes import Mesh
from risorius.geometry.arrays import Floats64

from .report import table
from .subjects import LANDMARK_GROUPS

PERSON_NUMBERS = (7, 63)


class Guess(NamedTuple):
    """A head with guessed landmarks.

    off: distance of each guess from the true landmark, scaled so that the outer eye corners are 89
    mm apart [mm], shape (68,).
    """

    name: str
    off: Floats64


def guessed(name: str, mesh: Mesh, true: Floats64) -> Guess:
    """Guess the landmarks of a mesh. true: the true landmarks [the mesh's unit], shape (68, 3)."""
    found = guess(mesh, {number: true[number] for number in FIRST_LANDMARKS})
    right_corner, left_corner = true[[36, 45]]
    apart = 89.0  # [mm], the value of the built-in head
    scale = apart / np.linalg.norm(left_corner - right_corner)
    return Guess(name, scale * np.linalg.norm(found - true, axis=1))


def persons_turned() -> list[Guess]:
    """The guesses for two made persons in metres, lying on a side and upside down."""
    found = []
    for number, degrees in zip(
        PERSON_NUMBERS, ((0.0, 20.0, 90.0), (150.0, -35.0, 10.0)), strict=True
    ):
        person = person_called(number)
        turn = scipy.spatial.transform.Rotation.from_euler("xyz", degrees, degrees=True)
        vertices = 0.001 * turn.apply(np.array(person.vertices)) + (3.0, -2.0, 1.5)
        mesh = Mesh(vertices, person.faces)
        found.append(guessed(f"person {number}, turned", mesh, vertices[person.landmarks]))
    return found


def lines_of(guesses: Sequence[Guess]) -> list[str]:
    """The table to print: median and worst error without the jaw, and each group's mean."""
    rows = []
    for each in guesses:
        own = each.off[LANDMARK_GROUPS["jaw"].stop :]
        groups = [
            each.off[numbers].mean() for name, numbers in LANDMARK_GROUPS.items() if name != "all"
        ]
        rows.append((each.name, np.median(own), own.max(), *groups))
    columns = "|".join(f"{name}:6.1f" for name in LANDMARK_GROUPS if name != "all")
    return [
        "Landmarks guessed from six true points, off [mm]: median and worst without the jaw,",
        "and means of groups.",
        "",
        *table(f"head:<18|median:7.1f|worst:6.1f|{columns}", rows),
    ]
