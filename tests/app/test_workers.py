"""Worker processes: results, failures, and no process left after a stop."""

import os
import signal
import sys
import time
from pathlib import Path
from typing import Any

import pytest

from risorius.app.errors import UserError
from risorius.app.workers import WorkerPool, run_all, share_of_cores

from . import working
from .command_line import started

STOPPED_PROGRAM = """
import sys
from pathlib import Path
from risorius.app.stopping import handle_signals
from risorius.app.workers import run_all
from tests.app import working
handle_signals()
folder = Path(sys.argv[1])
list(run_all(working.write_slowly, [folder / "a", folder / "b"]))
"""


def run(work, *arguments, jobs=1, **options):
    """The results of some work."""
    messages = list[Any]()
    WorkerPool(jobs).run(work, *arguments, on_message=messages.append, **options)
    return messages


def wait_until(is_so):
    """Wait for a condition; fail if it never becomes true."""
    for _ in range(6000):
        if is_so():
            return
        time.sleep(0.01)
    raise AssertionError("nothing happened for a minute")


def is_running(process):
    """Whether a process runs, and is not an ended one that its parent has not collected."""
    try:
        state = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0]
    except OSError:
        return False
    return state != "Z"


def test_every_part_is_done_in_another_process():
    """Each share is done in a process other than this one, and messages arrive in order."""
    shares = [[1, 2, 3], [10, 20], []]
    found = list(run_all(working.double, shares))
    assert sorted(number for number, _ in found) == [2, 4, 6, 20, 40]
    by_process = {each: [n for n, process in found if process == each] for _, each in found}
    assert sorted(by_process.values()) == [[2, 4, 6], [20, 40]]
    assert os.getpid() not in by_process
    assert list(run_all(working.double, [])) == []


def test_work_of_a_killed_process_is_repeated(tmp_path):
    """A killed process is replaced, and the log names the cause."""
    log = tmp_path / "log"
    other = tmp_path / ".risorius-0123456789ab"
    other.mkdir()  # as by another process
    assert run(working.die_once, tmp_path / "mark", log=log) == ["mark"]
    assert "risorius: the process of attempt 1 died of SIGKILL\n" in log.read_text()
    names = {path.name for path in tmp_path.iterdir()}
    assert names >= {"log", "mark", "mark.txt", other.name}


def test_work_that_kills_every_process_is_given_up(tmp_path):
    """Work that kills every process ends after three attempts, in one line.

    For a crash, the log has the place in the code.
    """
    log = tmp_path / "log"
    with pytest.raises(UserError, match="died 3 times, the last time of SIGSEGV"):
        run(working.die, log=log)
    assert "working.py" in log.read_text()


@pytest.mark.parametrize(
    ("kind", "message"),
    [
        ("user", "^the nose is too long$"),
        ("defect", "^ZeroDivisionError: one by zero$"),
        ("disk", "No space left"),
        ("unfit", "pickle"),
    ],
)
def test_an_exception_is_reported_and_not_tried_again(tmp_path, kind, message):
    """An exception is reported in one line, and the work is not tried again.

    A defect leaves a traceback in the log, a user's mistake does not.
    """
    log = tmp_path / "log"
    with pytest.raises(UserError, match=message):
        run(working.fail, kind, log=log)
    assert ("Traceback" in log.read_text()) == (kind in ("defect", "unfit"))
    assert "the process of attempt" not in log.read_text()


def test_everything_that_is_printed_goes_to_its_log(tmp_path):
    """Output of Python, of a C library and of child programs is in the log."""
    log = tmp_path / "log"
    run(working.talk, "nose", log=log)
    ways = ("as an error", "by Python", "by a child", "by a library")
    assert sorted(log.read_text().splitlines()) == [f"nose {how}" for how in ways]


def test_libraries_share_the_cores(monkeypatch):
    """With more processes than cores, each has one thread; a number set by the user is divided."""
    monkeypatch.delenv("LP_NUM_THREADS", raising=False)
    assert run(working.library_threads, jobs=1024) == ["1"]
    monkeypatch.setenv("LP_NUM_THREADS", "7")
    assert share_of_cores() == 7
    assert run(working.library_threads, jobs=2) == ["3"]
    for limit, share in (("0", 1), ("many", len(os.sched_getaffinity(0)))):
        monkeypatch.setenv("LP_NUM_THREADS", limit)
        assert share_of_cores() == share


def test_an_early_stop_leaves_no_process():
    """A caller that stops after the first message leaves no process."""
    running = run_all(working.double, [list(range(10_000))])
    process = next(running)[1]
    running.close()
    assert not is_running(process)


@pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX systems")
@pytest.mark.parametrize(
    "number",
    [
        signal.SIGINT,
        pytest.param(signal.SIGKILL, marks=pytest.mark.slow),
        pytest.param(signal.SIGTERM, marks=pytest.mark.slow),
    ],
)
def test_nothing_runs_on_when_it_is_stopped(tmp_path, number):
    """Ctrl-C, `kill`, and a sudden end of the calling process stop all work."""
    process = started("-c", STOPPED_PROGRAM, tmp_path)
    wait_until(lambda: len(list(tmp_path.glob(".risorius-*/?"))) == 2)
    threads = Path(f"/proc/{process.pid}/task").glob("*/children")
    workers = [int(each) for file in threads for each in file.read_text().split()]
    assert len(workers) == 2
    process.send_signal(number)
    assert process.wait(60) == -number
    wait_until(lambda: not any(is_running(each) for each in workers))
    assert list(tmp_path.iterdir()) == []
