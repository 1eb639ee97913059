"""What `risorius bench script` prints: what a script costs that is a recorded take of ten minutes.

The take is that of `risorius bench take`. In the window it is timed beside a script of a few keys,
in turn: on a shared machine only times of one run can be compared.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from risorius.app.performances import read_performance, script_for
from risorius.app.script import Script, load_script, save_script, script_text

from .report import processor, table
from .takes import RATE, made_up

SEED = 2003
MINUTES = 10.0
LOADING, FRAME, EDIT = 3000.0, 0.2, 50.0  # [ms] promised: to read it, for a frame, for an edit
ROUNDS = 5
FRAMES = 20  # of the window in each round


@dataclass(frozen=True)
class Row:
    """What was timed."""

    what: str
    milliseconds: float  # median
    few_keys: float | None = None  # [ms] the same with a script of a few keys
    promised: float | None = None  # [ms]


def milliseconds(call: Callable[[], object], rounds: int = ROUNDS) -> float:
    """How long a call takes [ms], median over some rounds."""
    taken = []
    for _ in range(rounds):
        begin = time.perf_counter()
        call()
        taken.append(1e3 * (time.perf_counter() - begin))
    return float(np.median(taken))


def report(size: tuple[int, int], minutes: float = MINUTES, *, has_screen: bool) -> str:
    """Time everything; the text to print. size: of the window [pixels]."""
    with TemporaryDirectory() as folder:
        recording, path = Path(folder) / "take.csv", Path(folder) / "take.toml"
        recording.write_text(made_up(minutes), encoding="utf-8")
        script, _ = read_performance(recording)
        keys = sum(map(len, script.tracks.values()))
        samples = round(60.0 * minutes * RATE) * len(script.tracks)
        rows = list(_file_rows(script, path))
        megabytes = path.stat().st_size / 1e6
        if has_screen:
            rows += _window_rows(path, size)
    lines = [
        f"A take of {minutes:g} minutes, {len(script.tracks)} tracks at {RATE:g} Hz: {keys} keys "
        f"({keys / samples:.0%} of the samples), {megabytes:.1f} MB,",
        f"on {processor()}; medians in ms.",
        "",
        *table(
            "what:<44|median:10.3f|few keys:10.3f|promised:10.1f",
            [(row.what, row.milliseconds, row.few_keys, row.promised) for row in rows],
        ),
    ]
    if not has_screen:
        lines += ["", "There is no screen, so the window was not timed."]
    return "\n".join(lines)


def _file_rows(script: Script, path: Path) -> Iterator[Row]:
    """To a file and back, and the values of a frame."""
    save_script(path, script)
    yield Row("read the file", milliseconds(lambda: load_script(path)), promised=LOADING)
    read = load_script(path)
    yield Row("its text, when new", milliseconds(lambda: script_text(read), 1))
    yield Row("its text, when one key is new", milliseconds(lambda: script_text(read)))
    yield Row("values of the first frame", milliseconds(lambda: read.at(0.0), 1))
    frames = iter((np.arange(1, 2001) / RATE + 0.5 * read.duration).tolist())
    taken = milliseconds(lambda: read.at(next(frames)), 2000)
    yield Row("values of a frame", taken, promised=FRAME)


def _window_rows(path: Path, size: tuple[int, int]) -> Iterator[Row]:
    """Frames with a take and with a few keys, then what a user does with keys."""
    from risorius.app.viewer import Viewer
    from risorius.app.viewer.settings import Display
    from risorius.app.viewer.tracks import TRACKS

    few = script_for(None, "face")
    with Viewer(few, size, Display()) as viewer:
        session = viewer.session
        viewer.settings.folds[TRACKS] = True
        take = load_script(path)
        moments = np.random.default_rng(SEED)

        def scrub() -> None:
            """A frame in which the time that is shown changes."""
            session.seek(moments.uniform(0.0, session.script.duration))
            viewer.frame()

        def panels() -> None:
            """The same, without the face."""
            session.seek(moments.uniform(0.0, session.script.duration))
            viewer._draw_gui(is_visible=True)

        for what, call, shows_curves in (
            ("a frame while scrubbing", scrub, False),
            ("the panels of a frame", panels, False),
            ("the same with curves", panels, True),
        ):
            viewer.settings.shows_curves = shows_curves
            taken: dict[bool, list[float]] = {False: [], True: []}
            for turn in range(2 * ROUNDS):
                is_take = turn % 2 == 1
                session.open(take if is_take else few)
                call()
                taken[is_take].append(milliseconds(call, FRAMES))
            yield Row(what, float(np.median(taken[True])), float(np.median(taken[False])))

        viewer.settings.shows_curves = False
        yield from _edit_rows(viewer, take, moments)


def _edit_rows(viewer: Any, take: Script, moments: np.random.Generator) -> Iterator[Row]:
    """What a user does with keys of a take."""
    from risorius.app.script.keyframes import places_of

    session, selection = viewer.session, viewer.selection

    def select() -> None:
        """A fifth of the take, as in a box."""
        third, half = 0.3 * take.duration, 0.5 * take.duration
        selection.places = places_of(session.script).between(third, half)

    def set_key() -> None:
        """A slider is moved, and the face becomes a key."""
        session.set(next(iter(take.tracks)), moments.uniform(0.0, 1.0))
        selection.set_key()

    edits: dict[str, Callable[[], object]] = {
        "go to the next key": lambda: session.seek_key(1),
        "set a key": set_key,
        "select a fifth of all keys": select,
        "move these": lambda: selection.nudge(1),
        "delete these": selection.delete,
        "undo": session.undo,
    }
    taken_by = {what: list[float]() for what in edits}
    for _ in range(ROUNDS):
        session.open(take)
        for what, edit in edits.items():
            taken_by[what].append(milliseconds(edit, 1))
    for what, each in taken_by.items():
        yield Row(what, float(np.median(each)), promised=EDIT)
