"""Samples of a data set before drawing: the table, and random choices from it."""

import itertools
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from risorius.app.dataset.sampling import MOST_UNITS, Sample, draw
from risorius.app.dataset.table import PERSON_COUNT, load_table, paired_units
from risorius.app.errors import UserError
from risorius.app.scenes import FaceScene

from .command_line import risorius

TABLE = load_table(None)


@pytest.fixture(scope="module")
def limits() -> dict[str, tuple[float, float]]:
    """Limits of the face's controls."""
    return FaceScene().limits


def units_of(sample):
    """The action units of a sample, without sides."""
    names = {name for name in sample.controls if name.startswith("AU")}
    unit_of = {f"{unit}_{side}": unit for unit in paired_units() for side in ("left", "right")}
    return {unit_of.get(name, name) for name in names}


@given(seed=st.integers(0, 2**32 - 1), index=st.integers(0, 999_999))
def test_any_sample_is_a_face_that_can_be_made(limits, seed, index):
    """Controls of any sample are within limits and compatible; the camera is in its ranges."""
    sample = draw(TABLE, seed, index)
    for name, value in sample.controls.items():
        low, high = limits[name]
        assert low <= value <= high
    units = units_of(sample)
    for pair in itertools.combinations(units, 2):
        assert frozenset(pair) not in TABLE.excluded.pairs
    assert len(units) <= MOST_UNITS + 2  # the units of an expression, and a blink
    if sample.kind == "neutral":
        assert units <= {"AU45"}
    for name, (low, high) in vars(TABLE.camera).items():
        if name != "shift":
            assert low <= getattr(sample.view, name) <= high
    assert 0 <= sample.person - seed * PERSON_COUNT < TABLE.persons.count


@given(seed=st.integers(0, 2**32 - 1), index=st.integers(0, 999_999))
def test_a_sample_follows_from_seed_and_number_alone(seed, index):
    first = draw(TABLE, seed, index)
    draw(TABLE, seed, index + 1)
    assert draw(TABLE, seed, index) == first


@pytest.fixture(scope="module")
def many() -> list[Sample]:
    """Samples enough that a fraction of a third has a standard deviation of 0.01."""
    return [draw(TABLE, 1, index) for index in range(2000)]


def test_kinds_and_units_come_as_often_as_the_table_says(many):
    total = sum(TABLE.kinds.values())
    for kind, share in TABLE.kinds.items():
        assert sum(s.kind == kind for s in many) / len(many) == pytest.approx(
            share / total, abs=0.05
        )
    for unit in TABLE.units:
        assert any(unit in units_of(sample) for sample in many), f"{unit} never comes"


def read(tmp_path, text):
    """Write a text to a file, and read it as a table."""
    file = tmp_path / "my.toml"
    file.write_text(text, encoding="utf-8")
    return load_table(file)


def test_a_table_of_ones_own_replaces_sections(tmp_path):
    """The printed table, used as a user's table, changes nothing.

    A user's table replaces whole sections, but some sections keep rows that it leaves out.
    """
    printed = risorius("dataset", "--sample-table").output
    assert read(tmp_path, printed) == TABLE
    own = read(tmp_path, "[units]\nAU12 = 1.0\n[kinds]\nunit = 1\n[persons]\ncount = 3\n")
    assert {draw(own, 0, index).name for index in range(20)} == {"AU12"}
    assert own.expressions == TABLE.expressions
    assert own.persons == replace(TABLE.persons, count=3)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("[kind]", "unknown key 'kind'; did you mean 'kinds'? Allowed: kinds"),
        ("[kinds]\nsmile = 1", "'kinds', 'smile': was 'smile', must be one of neutral"),
        ("[units]\nAU12 = nan", "'units', 'AU12': was nan"),
        ("[expressions]\njoy = { share = 1, AU12 = 2 }", "'expressions', 'joy', 'AU12': was 2"),
        ("[excluded]\npairs = [['AU1', 'AU1']]", "'excluded', 'pairs': was ['AU1', 'AU1']"),
        ("[camera]\nyaw = [3, 1]", "'camera', 'yaw': was [3.0, 1.0]"),
        ("[kinds", "not valid TOML"),
    ],
)
def test_a_wrong_table_is_reported_in_one_line(tmp_path, text, message):
    """The line names file, section and row, and the allowed values."""
    with pytest.raises(UserError) as raised:
        read(tmp_path, text)
    assert str(raised.value).startswith(str(tmp_path / "my.toml"))
    assert message in str(raised.value)
