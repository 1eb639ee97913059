"""The options of refiners: read from their declarations, with any version of numpy."""

from __future__ import annotations

import numpy.typing as npt
import pytest

from risorius import refine
from risorius.app.errors import UserError
from risorius.app.refining.presets import Refinement
from risorius.app.refining.refiners import open_choices, options_of, refiner_for
from risorius.app.scenes import PlaneScene
from risorius.refine.border import registry


def test_only_switches_numbers_and_words_are_options(monkeypatch):
    """An array that may also be a bool, as numpy 2.2 declares them, is no switch."""

    def declared(
        faces: npt.ArrayLike,
        rest_positions: npt.ArrayLike,
        *,
        uv: bool | int | float | str | list[float] | None = None,
        grown: bool | None = None,
        share: float = 0.5,
    ) -> refine.PassThrough:
        """A refiner of somebody else, whose annotations are text."""
        return refine.PassThrough(faces, rest_positions)

    monkeypatch.setattr(
        registry.refiners, "_factories", {"declared": declared, "loop": refine.Loop}
    )
    assert options_of("declared") == {"grown": None, "share": 0.5}
    assert options_of("loop") == {"levels": 1}


def test_what_may_be_left_open_is_a_choice():
    """Words stand for values; another value, or a number in place of a switch, is refused."""
    assert open_choices("kahler") == {
        "blend": {"automatic": None, "on": True, "off": False},
        "normals": {"automatic": None, "linear": "linear", "refined": "refined"},
    }
    plane = PlaneScene()
    for value in (None, "linear", "refined"):
        refiner_for(plane, Refinement(options={"normals": value}))
    for option, wrong, wanted in (
        ("normals", "round", "linear or refined"),
        ("blend", 1, "on or off"),
    ):
        with pytest.raises(UserError, match=f"option {option} was {wrong}, must be {wanted}"):
            refiner_for(plane, Refinement(options={option: wrong}))
