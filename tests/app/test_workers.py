"""Processes that work: every item once, whatever dies, and nothing left when they are stopped."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from risorius.app.errors import UserError
from risorius.app.workers import Outcome, run_all
from risorius.app.workers.child import cores, share_of_cores

from . import working

STOPPED = """
import sys
from pathlib import Path
from risorius.app.stopping import handle_signals
from risorius.app.workers import run_all
from tests.app import working
handle_signals()
folder = Path(sys.argv[1])
list(run_all(working.write_slowly, [folder / "a", folder / "b"], jobs=2))
"""


def outcomes(work: Callable[[Any], Any], items: list[Any], **options: Any) -> list[Outcome]:
    """What became of each item, in their order; each must be told once."""
    found = sorted(run_all(work, items, **{"jobs": 2, **options}), key=lambda each: each.index)
    assert [each.index for each in found] == list(range(len(items)))
    assert [each.item for each in found] == items
    return found


def wait_until(is_so: Callable[[], bool]) -> None:
    """Wait for something; a failure where it does not come."""
    for _ in range(6000):
        if is_so():
            return
        time.sleep(0.01)
    raise AssertionError("nothing happened for a minute")


def is_running(process: int) -> bool:
    """Whether a process is there, and not only its end that nobody has asked for."""
    try:
        state = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0]
    except OSError:
        return False
    return state != "Z"


@pytest.mark.parametrize("jobs", [1, 3])
def test_results_are_those_of_a_loop(jobs: int) -> None:
    """Every item is done once, in no more processes than asked for, none of them this one."""
    found = outcomes(working.double, list(range(20)), jobs=jobs)
    assert [each.result[0] for each in found] == [2 * number for number in range(20)]
    assert all(each.error is None and each.attempts == 1 for each in found)
    processes = {each.result[1] for each in found}
    assert 1 <= len(processes) <= jobs and os.getpid() not in processes


def test_what_dies_costs_its_item_an_attempt(tmp_path: Path) -> None:
    """A killed process is replaced, its item done again, and the others have one attempt.

    The logs of those that died say so.
    """
    marks = [tmp_path / name for name in ("calm 1", "one", "calm 2", "two", "calm 3")]
    logs = [mark.with_suffix(".log") for mark in marks]
    found = outcomes(working.die_once, marks, logs=logs)
    died = "risorius: the process of attempt 1 died of SIGKILL\n"
    assert [log.read_text() for log in logs] == ["", died, "", died, ""]
    assert [each.result for each in found] == [mark.name for mark in marks]
    assert [each.attempts for each in found] == [1, 2, 1, 2, 1]


def test_what_the_dead_had_half_written_goes(tmp_path: Path) -> None:
    """When its item is done again; not what another process is at."""
    other = tmp_path / ".risorius-0123456789ab"
    other.mkdir()
    outcomes(working.die_before_the_end, [tmp_path / "film"])
    assert {path.name for path in tmp_path.iterdir()} == {"film", "film.begun", other.name}


def test_what_kills_every_process_fails_alone(tmp_path: Path) -> None:
    """It is given up after three attempts, in one line; a fault says in the log where it was."""
    names = ["first", "deadly", "last"]
    logs = [tmp_path / name for name in names]
    found = outcomes(working.die, names, logs=logs)
    assert [each.result for each in found] == ["first", None, "last"]
    assert [each.attempts for each in found] == [1, 3, 1]
    assert found[1].error is not None
    assert "died 3 times" in found[1].error and "SIGSEGV" in found[1].error
    assert "working.py" in logs[1].read_text()


def test_what_is_raised_is_told_and_not_tried_again(tmp_path: Path) -> None:
    """One line for each; a defect leaves a traceback in the log, the user's mistake does not."""
    kinds = ["user", "defect", "disk", "unfit"]
    logs = [tmp_path / kind for kind in kinds]
    found = outcomes(working.fail, kinds, logs=logs)
    assert all(each.attempts == 1 and each.result is None for each in found)
    user, defect, disk, unfit = (each.error or "" for each in found)
    assert user == "the nose is too long"
    assert defect == "ZeroDivisionError: one by zero"
    assert "No space left" in disk
    assert "cannot be sent" in unfit
    assert ["Traceback" in log.read_text() for log in logs] == [False, True, False, False]


def test_everything_that_is_printed_goes_to_its_log(tmp_path: Path) -> None:
    """By Python, by a library in C, and by programs that are started; nothing goes astray."""
    logs = [tmp_path / word for word in ("nose", "chin", "brow")]
    outcomes(working.talk, [log.name for log in logs], jobs=1, logs=logs)
    for log in logs:
        lines = [f"{log.name} {how}" for how in ("as an error", "by Python", "by a child")]
        assert sorted(log.read_text().splitlines()) == [*lines, f"{log.name} by a library"]


def test_libraries_share_the_cores(monkeypatch: pytest.MonkeyPatch) -> None:
    """More processes than cores have one thread each; what the user has set stays."""
    monkeypatch.delenv("LP_NUM_THREADS", raising=False)
    assert outcomes(working.library_threads, [0], jobs=1024)[0].result == "1"
    monkeypatch.setenv("LP_NUM_THREADS", "7")
    assert outcomes(working.library_threads, [0])[0].result == "7"


@pytest.mark.parametrize(("told", "share"), [("3", 3), ("0", 1), ("many", None), (None, None)])
def test_a_command_takes_the_cores_that_it_is_told(
    monkeypatch: pytest.MonkeyPatch, told: str | None, share: int | None
) -> None:
    """By LP_NUM_THREADS, one at least; all there are where that says nothing."""
    monkeypatch.delenv("LP_NUM_THREADS", raising=False)
    if told is not None:
        monkeypatch.setenv("LP_NUM_THREADS", told)
    assert share_of_cores() == (share or cores()) >= 1


def test_whoever_stops_early_leaves_no_process() -> None:
    """The caller breaks off after the first outcome."""
    running = run_all(working.double, list(range(4)), jobs=2)
    process = next(running).result[1]
    running.close()  # type: ignore[attr-defined]
    assert not is_running(process)


@pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX systems")
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGKILL])
def test_nothing_runs_on_when_it_is_stopped(tmp_path: Path, number: signal.Signals) -> None:
    """Ctrl-C, `kill`, and even the end of the process that asked without a word."""
    process = subprocess.Popen(
        [sys.executable, "-c", STOPPED, str(tmp_path)],
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
    )
    wait_until(lambda: len(list(tmp_path.glob(".risorius-*/?"))) == 2)
    children = Path(f"/proc/{process.pid}/task/{process.pid}/children")
    threads = Path(f"/proc/{process.pid}/task").glob("*/children")
    workers = [int(each) for file in threads for each in file.read_text().split()]
    assert len(workers) == 2, children
    process.send_signal(number)
    assert process.wait(60) == -number
    wait_until(lambda: not any(is_running(each) for each in workers))
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("address", ["nonsense", "tcp://127.0.0.1:9", "foo://a:3", "tcp://a:99999"])
def test_a_scheduler_that_is_not_there(address: str) -> None:
    """One line, at once."""
    with pytest.raises(UserError, match="no Dask scheduler answers there"):
        outcomes(working.double, [1], scheduler=address)


def test_a_cluster_gives_what_a_loop_gives(cluster: Any, tmp_path: Path) -> None:
    """The same outcomes as here: results, errors, deaths and logs."""
    address = cluster.scheduler_address
    found = outcomes(working.double, list(range(10)), scheduler=address)
    assert [each.result[0] for each in found] == [2 * number for number in range(10)]
    found = outcomes(working.die_once, [tmp_path / "calm", tmp_path / "one"], scheduler=address)
    assert [each.attempts for each in found] == [1, 2]
    found = outcomes(working.fail, ["user", "defect"], scheduler=address)
    assert [each.error for each in found] == [
        "the nose is too long",
        "ZeroDivisionError: one by zero",
    ]
    logs = [tmp_path / "nose", tmp_path / "chin"]
    outcomes(working.talk, ["nose", "chin"], scheduler=address, logs=logs)
    assert all(f"{log.name} by a child" in log.read_text() for log in logs)


def parent(process: int) -> int:
    """The process that started it."""
    status = Path(f"/proc/{process}/status").read_text()
    return int(status.split("PPid:")[1].split()[0])


@pytest.mark.slow
def test_a_worker_of_the_cluster_is_killed_halfway(cluster: Any, tmp_path: Path) -> None:
    """Every file is whole, and none we heard of is done again; its process ends with the worker."""
    targets = [tmp_path / f"{number}.txt" for number in range(6)]
    killed = 0
    heard_of: Path | None = None
    found = []
    for outcome in run_all(
        working.write_in_steps, targets, jobs=1, scheduler=cluster.scheduler_address
    ):
        found.append(outcome)
        if not killed:
            heard_of = outcome.item
            killed = parent(outcome.result)
            os.kill(killed, signal.SIGKILL)
    assert sorted(each.index for each in found) == list(range(6))
    assert [each.error for each in found] == [None] * 6
    assert {path.read_text() for path in targets} == {f"whole {path.name}" for path in targets}
    assert heard_of and heard_of.with_suffix(".times").read_text() == "once\n"
    assert not is_running(killed)
    processes = {each.result for each in found}
    wait_until(lambda: not any(is_running(each) for each in processes))
    assert not list(tmp_path.glob(".risorius-*"))
