"""Options of refiners, read from their declarations, with any version of numpy."""

from __future__ import annotations

import numpy.typing as npt
import pytest

from risorius import refine
from risorius.app.errors import UserError
from risorius.app.refining.presets import Refinement
from risorius.app.refining.refiners import options_of, refiner_for
from risorius.app.scenes import PlaneScene


@pytest.mark.usefixtures("own_refiners")
def test_only_switches_numbers_and_words_are_options():
    """An array that may also be a bool, as numpy 2.2 declares arrays, is not a switch."""

    def declared(
        faces: npt.ArrayLike,
        rest_positions: npt.ArrayLike,
        *,
        uv: bool | int | float | str | list[float] | None = None,
        grown: bool | None = None,
        share: float = 0.5,
    ) -> refine.PassThrough:
        """A refiner of another author, with annotations as text."""
        return refine.PassThrough(faces, rest_positions)

    refine.refiners.register("declared", declared)
    declared_ones = options_of("declared", "normal")
    assert {name: each.default for name, each in declared_ones.items()} == {
        "grown": None,
        "share": 0.5,
    }
    (levels,) = options_of("loop", "normal").values()
    assert (levels.name, levels.default, levels.least, levels.most) == ("levels", 1, 1, 4)


def test_optional_values_are_choices():
    """Texts stand for values; another value, or a number instead of a switch, is refused."""
    options = options_of("kahler", "normal")
    choices = {name: dict(each.choices) for name, each in options.items() if each.choices}
    assert choices == {
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


@pytest.mark.parametrize("criterion", ["rest", "silhouette", "displacement+rest", "normal"])
def test_levels_and_thresholds_of_criteria(criterion):
    """Each criterion has its own levels and thresholds, addressed by its name.

    Fewer levels limit how often an edge is split.
    """
    plane = PlaneScene()
    plane.pose({"amplitude": 1.0, "phase": 0.3})
    plane.step(0.5)
    view = refine.View([1e6, 1e5, 0.0])  # along the plane: all edges are at the outline
    options = options_of("kahler", criterion)
    wholes = {"scheme": "cubic", "criterion": criterion}
    for part in criterion.split("+"):
        assert f"{part}.levels" in options
        assert part == "normal" or {f"{part}.once", f"{part}.twice"} <= set(options)
        if part != "normal":
            wholes[f"{part}.once"] = 1e-5
            wholes[f"{part}.twice"] = 1e-5
    seen = []
    for levels in (0, 1, 2):
        chosen = {f"{part}.levels": levels for part in criterion.split("+")}
        refiner = refiner_for(plane, Refinement(options={**wholes, **chosen}))
        mesh = refiner.refine(plane.positions, view=view)
        refine.check(refiner, mesh, plane.positions)
        seen.append(int(refiner.splits.max()))
    assert seen[0] == 0
    assert seen[1] == (0 if criterion == "rest" else 1)  # a plane is flat at rest
    assert seen[2] <= 2
    assert criterion == "rest" or seen[2] == 2


def test_options_of_criteria_that_do_not_fit():
    """Options of an unused or unknown criterion, and values out of range, are refused."""
    plane = PlaneScene()
    for options, wanted in (
        ({"rest.levels": 1}, "unknown option rest.levels; it takes .*normal.levels"),
        ({"criterion": "rest", "rest.height": 1}, r"unknown option rest\.height; it takes"),
        ({"criterion": "rest", "rest.levels": 3}, r"option rest\.levels was 3, must be a whole"),
        ({"criterion": "rest", "rest.once": "x"}, r"option rest\.once was x, must be a number"),
    ):
        with pytest.raises(UserError, match=wanted):
            refiner_for(plane, Refinement(options=options))
