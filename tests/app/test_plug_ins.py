"""A separate package, installed beside the application, adds its own refinement."""

import os
from collections.abc import Iterator
from pathlib import Path

import pytest
from click.testing import Result

from risorius.app.capture import processes
from risorius.app.performances import script_for
from risorius.app.viewer import Viewer
from risorius.app.viewer.panels import mechanism
from risorius.refine.border import registry

from .command_line import refusal, risorius
from .driving import until

pytestmark = pytest.mark.usefixtures("shared_scenes")

PLUG_IN_MODULE = '''
import numpy as np

from risorius import refine


class Everywhere(refine.Criterion):
    """Splits all edges once."""

    def measure(self, positions, normals, metric):
        metric[:] = 0.5


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
BROKEN_MODULE = '''
import sys

import numpy as np

from risorius import refine


class Unborn(refine.Criterion):
    def __init__(self):
        self.least = 1 / 0

    def measure(self, positions, normals, metric):
        pass


class NeedsWords(Unborn):
    def __init__(self, words):
        pass


class Unbound(refine.Criterion):
    def bind(self, connectivity, rest_positions, rest_normals):
        raise KeyError("no such edge")

    def measure(self, positions, normals, metric):
        pass


class Moody(refine.Criterion):
    """Bears the mesh at rest, and nothing else."""

    def bind(self, connectivity, rest_positions, rest_normals):
        self.rest = rest_positions

    def measure(self, positions, normals, metric):
        if np.abs(positions - self.rest).max() > 0.5:
            raise RuntimeError("two\\nlines")


class Shapeless(refine.Criterion):
    def measure(self, positions, normals, metric):
        metric[:] = np.zeros(3)


class Quitter(refine.Scheme):
    def bind(self, connectivity, rest_positions, rest_normals):
        pass

    def place(self, frame):
        sys.exit(7)


class Silent(refine.PassThrough):
    def fill(self, stream, view):
        return None


class Empty(refine.PassThrough):
    @property
    def vertex_capacity(self):
        return -1


class Picky(refine.PassThrough):
    def __init__(self, faces, rest_positions, *, share: float = 2.0, **values):
        raise ValueError(f"share must be below 1, got {share}")


class Lost(refine.PassThrough):
    def fill(self, stream, view):
        return undefined_name
'''
ENTRY_POINTS = """
[risorius.refiners]
silent = broken_for_a_test:Silent
empty = broken_for_a_test:Empty
picky = broken_for_a_test:Picky
lost = broken_for_a_test:Lost
leaves = leaves_for_a_test:Leaves
half = theirs_for_a_test:Half
gone = nowhere_at_all:Gone
three = theirs_for_a_test:THREE

[risorius.schemes]
quitter = broken_for_a_test:Quitter
straight = theirs_for_a_test:Straight

[risorius.criteria]
unborn = broken_for_a_test:Unborn
words = broken_for_a_test:NeedsWords
unbound = broken_for_a_test:Unbound
moody = broken_for_a_test:Moody
shapeless = broken_for_a_test:Shapeless
everywhere = theirs_for_a_test:Everywhere
"""


@pytest.fixture(autouse=True)
def package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Install the package as pip does, and remove it afterwards."""
    site = tmp_path / "site"
    notes = site / "theirs-1.0.dist-info"
    notes.mkdir(parents=True)
    (site / "theirs_for_a_test.py").write_text(PLUG_IN_MODULE, encoding="utf-8")
    (site / "broken_for_a_test.py").write_text(BROKEN_MODULE, encoding="utf-8")
    (site / "leaves_for_a_test.py").write_text("raise SystemExit(5)", encoding="utf-8")
    (notes / "METADATA").write_text("Metadata-Version: 2.1\nName: theirs\nVersion: 1.0\n")
    (notes / "entry_points.txt").write_text(ENTRY_POINTS, encoding="utf-8")
    monkeypatch.syspath_prepend(site)
    registry.entry_points_of.cache_clear()
    yield
    registry.entry_points_of.cache_clear()


def capture(folder: Path, *options: str) -> Result:
    """Draw the head at rest with these options."""
    still = ("--set", "joy=0", "--size", "64x48")
    return risorius("capture", "-o", folder / "rest.png", *still, *options)


@pytest.mark.parametrize(
    ("options", "count"),
    [
        (["--option", "criterion=everywhere"], 12180),  # blended: six subtriangles per triangle
        (["--option", "criterion=everywhere", "--option", "scheme=straight"], 8120),
        (["--refiner", "half"], 1015),
        (["--refiner", "half", "--option", "share=0.1"], 203),
    ],
)
def test_all_kinds_are_drawn(tmp_path, options, count):
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
def test_an_unusable_plug_in_is_reported_in_one_line(tmp_path, options, text):
    """A wrong name is reported with the correct ones, a broken package with its reason."""
    assert text in refusal(capture(tmp_path, *options))


def test_they_are_offered():
    """The window and the doctor list plug-ins beside the built-in refiners."""
    assert "straight" in mechanism.choices_of("scheme")
    assert "everywhere" in mechanism.choices_of("criterion")
    lines = risorius("doctor").output.splitlines()
    named = {line.partition(": ")[0]: line.split(", ") for line in lines}
    assert {"half", "gone"} <= set(named["refiners"])
    assert named["schemes"][-1] == "straight"
    assert named["criteria"][-1] == "everywhere"


BROKEN_PLUG_INS = {
    "criterion=unborn": "criterion 'unborn' (broken_for_a_test:Unborn) raised ZeroDivisionError: ",
    "criterion=words": "missing 1 required positional argument: 'words'",
    "criterion=unbound": "criterion 'unbound' (broken_for_a_test:Unbound) raised KeyError: ",
    "criterion=rest+moody": r"(broken_for_a_test:Moody) raised RuntimeError: two\nlines, in broken",
    "criterion=shapeless": "(broken_for_a_test:Shapeless) raised ValueError: could not broadcast",
    "scheme=quitter": "scheme 'quitter' (broken_for_a_test:Quitter) raised SystemExit: 7, in ",
    "silent": "refiner 'silent' (broken_for_a_test:Silent): its results cannot be used: Type",
    "empty": "refiner 'empty' (broken_for_a_test:Empty): its results cannot be used: Value",
    "picky": "refiner picky: share must be below 1, got 2.0",
    "lost": "(broken_for_a_test:Lost) raised NameError: name 'undefined_name' is not defined, in ",
    "leaves": "refiner 'leaves': its module ends the program when imported",
}


def chosen(name: str) -> tuple[str, ...]:
    """The options that choose a broken plug-in."""
    if "scheme" in name:
        return ("--option", name, "--option", "criterion=normal")
    return ("--option", name) if "=" in name else ("--refiner", name)


@pytest.mark.parametrize("name", BROKEN_PLUG_INS)
def test_an_error_in_one_is_reported_with_its_name(tmp_path, name):
    """Any error of a plug-in is one line with its name, in pictures and in motion."""
    draw = ("capture", "-o", tmp_path / "face.png", "--size", "64x48")
    move = ("export", "-o", tmp_path / "face.vtkhdf", "--refined", "--fps", "5")
    for words in (draw, move):
        if name == "empty" and words is move:  # an export does not ask for its memory
            continue
        assert BROKEN_PLUG_INS[name] in refusal(risorius(*words, "--set", "joy", *chosen(name)))
    assert not [item for item in tmp_path.iterdir() if item.name.startswith("face")]


def test_the_traceback_is_printed_on_request(tmp_path, monkeypatch):
    """RISORIUS_DEBUG=1 prints the traceback before the line, and the exit code stays."""
    monkeypatch.setenv("RISORIUS_DEBUG", "1")
    for name in ("criterion=unborn", "lost", "gone"):
        result = capture(tmp_path, *chosen(name))
        lines = result.output.splitlines()
        assert result.exit_code == 2
        assert lines[-1].startswith("risorius: ")
        assert "Traceback (most recent call last):" in lines
    assert "ModuleNotFoundError: No module named 'nowhere_at_all'" in lines


@pytest.mark.slow
def test_one_in_other_processes(tmp_path, monkeypatch):
    """Worker processes report the same line: for samples, frames of a film, lines of a list."""
    sample = ("dataset", "--count", "1", "-o", tmp_path / "set", "--size", "64x64", "--quiet")
    assert BROKEN_PLUG_INS["lost"] in refusal(risorius(*sample, "--refiner", "lost"))
    still = ("--set", "joy", "--size", "64x48", *chosen("criterion=moody"))
    listing = tmp_path / "list.txt"
    words = " ".join(map(str, ("capture", "-o", tmp_path / "face.png", *still)))
    listing.write_text(f"{words}\n", encoding="utf-8")
    result = risorius("batch", listing, "--jobs", "1", "--quiet")
    assert result.exit_code == 1
    assert "(broken_for_a_test:Moody) raised RuntimeError" in result.output
    monkeypatch.setattr(processes, "process_count", lambda *_: 2)
    monkeypatch.setenv("RISORIUS_DEBUG", "1")
    result = risorius("capture", "-o", tmp_path / "face.mp4", "--fps", "5", *still)
    assert result.exit_code == 2
    assert "Traceback (most recent call last):" in result.output
    assert "criterion 'moody'" in result.output.splitlines()[-1]
    assert not (tmp_path / "face.mp4").exists()


@pytest.mark.window
@pytest.mark.skipif("DISPLAY" not in os.environ, reason="needs a display; `make test` brings one")
def test_a_window_reports_a_broken_plug_in(tmp_path):
    """A window opened with a broken plug-in closes with its line.

    A plug-in that fails after the face moves does not end an open window.
    """
    view = ("view", "--size", "300x200")
    assert BROKEN_PLUG_INS["criterion=unborn"] in refusal(
        risorius(*view, *chosen("criterion=unborn"))
    )
    assert BROKEN_PLUG_INS["lost"] in refusal(risorius(*view, *chosen("lost")))
    script = script_for(None, "face")
    with Viewer(script, (300, 200)) as viewer:
        display = viewer.settings.display
        display.options["kahler"] = {"criterion": "moody"}
        viewer.frame()
        assert not viewer.messages.is_error
        viewer.session.set("jaw_open", 0.9)
        assert until(viewer, lambda: viewer.messages.is_error)
        assert "(broken_for_a_test:Moody) raised RuntimeError" in viewer.messages.text
        assert viewer.context.stage.refined is viewer.context.stage.static
        for refiner in ("gone", "picky"):
            viewer.messages.text = ""
            display.refiner = refiner
            assert until(viewer, lambda: "efiner" in viewer.messages.text)
        display.choose_preset("smooth")
        assert until(
            viewer, lambda: viewer.context.stage.refined is not viewer.context.stage.static
        )
        viewer.session.work.begin_script()
