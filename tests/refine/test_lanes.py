"""Instructions for four numbers at once, against one number after the other."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from refine import lanes, machine_code
from refine.lanes import (
    above,
    counted_from,
    cross,
    four,
    is_zero,
    single,
    spread,
    sums_of_three,
    twelve,
    write,
)
from refine.native import native, with_room

HALF = np.float32(0.5)


@native
def combine(p: Any, q: Any, sums: Any, differences: Any, products: Any, halves: Any) -> None:
    """All operators, on plain numbers."""
    k = np.uint64(2)
    write(sums, k, four(p, k) + four(q, k))
    write(differences, k, four(p, k) - four(q, k))
    write(products, k, four(p, k) * four(q, k))
    write(halves, k, HALF * four(p, k))


@native
def cross_rows(p: Any, q: Any, crossed: Any) -> None:
    """Cross products of rows of three doubles, in single precision."""
    for k in range(p.shape[0]):
        write(crossed, k, cross(single(four(p, k)), single(four(q, k))))


@native
def add_up(rows: Any, sums: Any) -> None:
    """Sums of four rows."""
    one = np.uint32(1)
    k = np.uint32(0)
    p, q = four(rows, k), four(rows, k + one)
    write(sums, k, sums_of_three(p, q, four(rows, np.int64(2)), four(rows, 3)))


@native
def compare(numbers: Any, limits: Any, flags: Any) -> None:
    """How many of two limits each number is above."""
    found = four(numbers, 0)
    write(flags, 1, above(found, spread(limits[0])) + above(found, spread(limits[1])))


@native
def count_up(numbers: Any, first: int) -> None:
    """Four numbers in turn."""
    write(numbers, 3, counted_from(first))


@native
def copy_unless_zero(flags: Any, rows: Any, copy: Any, k: int) -> int:
    """Copy four rows from k on; return 1 and leave them if the flags from k on are all 0."""
    if is_zero(four(flags, k)):
        return 1
    write(copy, k, twelve(rows, k))
    return 0


def numbers(count: int, seed: int) -> np.ndarray:
    """Some single-precision numbers."""
    return np.random.default_rng(seed).normal(size=count).astype(np.float32)


def test_operators() -> None:
    """Four numbers are added, subtracted, multiplied each for itself; others stay as they are."""
    p, q = numbers(7, 1), numbers(7, 2)
    results = [np.zeros(7, np.float32) for _ in range(4)]
    combine.bind(p, q, *results)()
    for result, expected in zip(results, (p + q, p - q, p * q, HALF * p), strict=True):
        assert (result[2:6] == expected[2:6]).all()
        assert not result[[0, 1, 6]].any()


def test_operators_on_whole_numbers() -> None:
    """Whole numbers wrap around, as numpy's do."""
    p, q = np.full(4, 0xFFFFFFFF, np.uint32), np.arange(4, dtype=np.uint32)
    sums = np.zeros(4, np.uint32)
    add_whole.bind(p, q, sums)()
    assert sums.tolist() == [0xFFFFFFFF, 0, 1, 2]


@native
def add_whole(p: Any, q: Any, sums: Any) -> None:
    """Sums of whole numbers."""
    write(sums, 0, four(p, 0) + four(q, 0))


def test_cross_products() -> None:
    """Rows of three are read with the number behind, and the last is not written over."""
    p, q = (with_room(numbers(15, seed).reshape(5, 3).astype(np.float64)) for seed in (3, 4))
    crossed = with_room(np.zeros((5, 3), np.float32))
    cross_rows.bind(p, q, crossed)()
    u, v = p.astype(np.float32), q.astype(np.float32)
    expected = np.roll(u, -1, 1) * np.roll(v, -2, 1) - np.roll(u, -2, 1) * np.roll(v, -1, 1)
    assert (crossed == expected).all()


def test_sums_of_three() -> None:
    """The three are added in their order, to the last bit."""
    rows = with_room(numbers(12, 5).reshape(4, 3))
    sums = np.zeros(4, np.float32)
    add_up.bind(rows, sums)()
    assert (sums == (rows[:, 0] + rows[:, 1]) + rows[:, 2]).all()


def test_comparing() -> None:
    """Above means above: a number equal to a limit is not, nor is one that is no number."""
    values = np.array([1.0, 1.5, 3.0, np.nan], np.float32)
    flags = np.full(6, 9, np.uint8)
    compare.bind(values, np.array([1.0, 2.0], np.float32), flags)()
    assert flags.tolist() == [9, 0, 1, 2, 0, 9]


@pytest.mark.parametrize("dtype", [np.int32, np.uint32])
def test_counting(dtype: type) -> None:
    """Four numbers from the first on, as 32 bits."""
    places = np.zeros(8, dtype)
    count_up.bind(places, 2**31 - 2)()
    expected = np.arange(2**31 - 2, 2**31 + 2).astype(dtype)
    assert places.tolist() == [0, 0, 0, *expected.tolist(), 0]


@pytest.mark.parametrize("place", range(6))
@pytest.mark.parametrize("dtype", [np.uint8, np.uint16])
def test_four_zeros(place: int, dtype: type) -> None:
    """Only the four in question decide; four whole rows are copied, and no number more."""
    flags = np.zeros(6, dtype)
    flags[place] = 1
    rows = np.arange(18, dtype=np.uint32).reshape(6, 3)
    copy = np.zeros_like(rows)
    untouched = copy_unless_zero.bind(flags, rows, copy, 1)()
    assert untouched == (place in (0, 5))
    assert (copy[1:5] == (0 if untouched else rows[1:5])).all()
    assert not copy[[0, 5]].any()


def test_only_in_compiled_code() -> None:
    """Called from Python, an instruction says what it is."""
    with pytest.raises(TypeError, match="four works in compiled code only"):
        four(np.zeros(4), 0)


def test_sources() -> None:
    """Machine code with instructions holds for the file that says what they are."""
    code = Path(lanes.__file__).with_name("lane_code.py")
    assert machine_code._digest(str(code)) in machine_code._sources(combine)
    assert machine_code._digest(str(code)) not in machine_code._sources(plain)


@native
def plain(numbers: Any) -> None:
    """A kernel without instructions."""
    numbers[0] = HALF
