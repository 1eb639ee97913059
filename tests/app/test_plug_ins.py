"""A package of somebody else, installed beside the application, brings refinement of its own."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from click.testing import Result

from risorius.app.viewer.panels import mechanism
from risorius.refine.border import registry

from .command_line import refusal, risorius

pytestmark = pytest.mark.usefixtures("shared_scenes")

MODULE = '''
import numpy as np

from risorius import refine


class Everywhere(refine.Criterion):
    """Splits all edges once."""

    def mark(self, positions, normals, splits):
        splits[:] = 1


class Straight(refine.Scheme):
    """Leaves all points where they are."""

    def bind(self, connectivity, rest_positions, rest_normals):
        self.edges = connectivity.edges

    def place(self, frame):
        count, split = len(frame.points), frame.split_edges
        assert not len(frame.twice_split_edges)
        frame.rows[:count, :6] = np.hstack([frame.points, frame.normals])
        frame.rows[frame.first_points[split], :6] = frame.rows[self.edges[split], :6].mean(axis=1)


THREE = 3

class Half(refine.PassThrough):
    """Draws the first triangles only."""

    def __init__(self, faces, rest_positions, *, share: float = 0.5, **values):
        super().__init__(faces, rest_positions, **values)
        self.share = share

    def fill(self, stream, view):
        vertex_count, triangle_count = super().fill(stream, view)
        return vertex_count, int(self.share * triangle_count)
'''
ENTRY_POINTS = """
[risorius.refiners]
half = theirs_for_a_test:Half
gone = nowhere_at_all:Gone
three = theirs_for_a_test:THREE

[risorius.schemes]
straight = theirs_for_a_test:Straight

[risorius.criteria]
everywhere = theirs_for_a_test:Everywhere
"""


@pytest.fixture(autouse=True)
def package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Install the package, as pip lays it, and forget it afterwards."""
    site = tmp_path / "site"
    notes = site / "theirs-1.0.dist-info"
    notes.mkdir(parents=True)
    (site / "theirs_for_a_test.py").write_text(MODULE, encoding="utf-8")
    (notes / "METADATA").write_text("Metadata-Version: 2.1\nName: theirs\nVersion: 1.0\n")
    (notes / "entry_points.txt").write_text(ENTRY_POINTS, encoding="utf-8")
    monkeypatch.syspath_prepend(site)
    registry._entry_points.cache_clear()
    yield
    registry._entry_points.cache_clear()


def capture(folder: Path, *options: str) -> Result:
    """Draw the head at rest by these options."""
    still = ("--set", "joy=0", "--size", "64x48")
    return risorius("capture", "-o", folder / "rest.png", *still, *options)


@pytest.mark.parametrize(
    ("options", "count"),
    [
        (["--option", "criterion=everywhere"], 8120),
        (["--option", "criterion=everywhere", "--option", "scheme=straight"], 8120),
        (["--refiner", "half"], 1015),
        (["--refiner", "half", "--option", "share=0.1"], 203),
    ],
)
def test_all_kinds_are_drawn(tmp_path: Path, options: list[str], count: int) -> None:
    """A criterion, a scheme and a refiner are found by name on the command line."""
    result = capture(tmp_path, *options)
    assert result.exit_code == 0, result.output
    assert f" {count} triangles" in result.output


@pytest.mark.parametrize(
    ("options", "text"),
    [
        (["--option", "criterion=evrywhere"], "there are ('normal', "),
        (["--option", "scheme=strait"], "'straight')"),
        (["--refiner", "half", "--option", "part=1"], "unknown option part; it takes share"),
        (["--refiner", "gone"], "'nowhere_at_all:Gone' cannot be loaded: ModuleNotFoundError"),
        (["--refiner", "three"], "must be a class or a function, got 3"),
    ],
)
def test_what_is_of_no_use_is_told_in_one_line(
    tmp_path: Path, options: list[str], text: str
) -> None:
    """A wrong name brings the right ones, and a package that is broken its reason."""
    assert text in refusal(capture(tmp_path, *options))


def test_they_are_offered() -> None:
    """The window lists them beside the built-in ones, and so does the doctor."""
    assert "straight" in mechanism._choices("scheme")
    assert "everywhere" in mechanism._choices("criterion")
    lines = risorius("doctor").output.splitlines()
    named = {line.partition(": ")[0]: line.split(", ") for line in lines}
    assert {"half", "gone"} <= set(named["refiners"])
    assert named["schemes"][-1] == "straight" and named["criteria"][-1] == "everywhere"
