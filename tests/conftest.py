"""Fixtures of all tests: floating-point errors of numpy raise, and random numbers have a seed."""

import os
import random
from collections.abc import Iterator

import numpy as np
import pytest
from hypothesis import settings

from risorius import assets
from risorius.assets.model import Head
from risorius.refine.border.registry import refiners

# No deadlines: a shared machine may stall any example. In continuous integration the examples are
# the same every time, and there are more of them; on a developer's machine hypothesis always tries
# new ones.
settings.register_profile("everywhere", deadline=None, max_examples=40)
settings.register_profile("integration", deadline=None, derandomize=True)
settings.load_profile("integration" if os.environ.get("CI") else "everywhere")


@pytest.fixture(autouse=True)
def floating_point_errors_raise() -> Iterator[None]:
    """Overflow, division by zero and invalid operations in numpy are test failures."""
    with np.errstate(over="raise", divide="raise", invalid="raise"):
        yield


@pytest.fixture(autouse=True)
def fixed_seed() -> None:
    """The standard generator is in the same state at the start of each test."""
    random.seed(20030214)


@pytest.fixture
def own_refiners(monkeypatch: pytest.MonkeyPatch) -> None:
    """Remove the refiners that a test registered."""
    monkeypatch.setattr(refiners, "_factories", dict(refiners._factories))


@pytest.fixture
def generator() -> np.random.Generator:
    """A seeded numpy generator."""
    return np.random.default_rng(20030214)


@pytest.fixture(scope="session")
def head() -> Head:
    """The built-in head, with read-only arrays."""
    return assets.load("head")
