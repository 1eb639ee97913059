"""`risorius batch`: complete checks of lists, each line done once, safe against kills."""

import csv
import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from .command_line import refusal, risorius, started, succeeded
from .test_workers import is_running, wait_until

SCRIPT_FORM = "duration = {0}\n[[pose]]\ntime = 0.0\n[[pose]]\ntime = {0}\n{1} = 1.0\n"
SMALL_OPTIONS = "--size 64x48 --fps 20"
LIST_TEXT = f"""
# frames, a film and a clip
capture joy.toml -o joy {SMALL_OPTIONS}
  capture 'waves.toml' -o "films/waves it is.mp4" {SMALL_OPTIONS}

export ripples.toml -o ripples.npz --fps 20
"""
FILM_NAME = "films/waves it is.mp4"
MADE_FILES = ("joy", FILM_NAME, "ripples.npz")


def plane_script(duration):
    """A script of the plane, which starts faster than a face."""
    return 'scene = "plane"\n' + SCRIPT_FORM.format(duration, "amplitude")


@pytest.fixture(autouse=True)
def scripts(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A folder of scripts and a list, as the test's working directory."""
    monkeypatch.chdir(tmp_path)
    Path("joy.toml").write_text(SCRIPT_FORM.format(0.5, "joy"))
    for name in ("waves", "ripples"):
        Path(f"{name}.toml").write_text(plane_script(0.5))
    Path("clips.txt").write_text(LIST_TEXT)


def batch(*arguments):
    """Run the command in this process."""
    return risorius("batch", "clips.txt", *arguments)


def rows():
    """The rows of the summary, by line number."""
    with open("clips_logs/summary.csv", encoding="utf-8", newline="") as file:
        return {int(row["line"]): row for row in csv.DictReader(file)}


def statuses():
    """The final status of each line, in order."""
    return [row["status"] for row in rows().values()]


def contents(*names):
    """The bytes of these files, and of all files in these folders."""
    files = [file for name in names for file in (Path(name), *Path(name).rglob("*"))]
    return {str(file): file.read_bytes() for file in files if file.is_file()}


def test_a_list_is_done_and_not_done_again():
    """Every output equals that of the single command; --resume makes missing and outdated ones."""
    ended = batch("--jobs", "2")
    assert ended.exit_code == 0, ended.output
    assert "3 lines: 3 ok, 0 failed, 0 skipped; 33 frames" in ended.stdout
    assert statuses() == ["ok"] * 3
    assert list(rows()) == [3, 4, 6]
    for row in rows().values():
        assert row["frames"] == "11"
        assert float(row["seconds"]) > 0
    made = contents(*MADE_FILES)
    assert len(made) == 2 + 11
    log = Path("clips_logs/line_0003.log").read_text()
    assert log.startswith("risorius capture joy.toml")
    assert "joy: " in log

    alone = f"capture waves.toml -o alone.mp4 {SMALL_OPTIONS} --quiet".split()
    succeeded(*alone)
    assert Path("alone.mp4").read_bytes() == made[FILM_NAME]

    assert batch("--resume").exit_code == 0
    assert statuses() == ["skipped"] * 3
    Path("waves.toml").write_text(plane_script(0.25))
    Path("ripples.npz").unlink()
    assert batch("--resume").exit_code == 0
    assert statuses() == ["skipped", "ok", "ok"]
    again = contents(*MADE_FILES)
    changed = [name for name in made if again.get(name) != made[name]]
    assert changed == [FILM_NAME]
    assert batch("--resume").exit_code == 0
    assert statuses() == ["skipped"] * 3


def test_every_wrong_line_is_reported_and_nothing_is_done():
    """Every wrong line is reported with its number, also lines in conflict; nothing is done."""
    Path("mine").mkdir()
    Path("mine/notes.txt").write_text("mine")
    Path("clips.txt").write_text(
        "capture joy.toml -o joy.mp4 --size 320x\n"
        "capture joy.toml -o 'joy.mp4\n"
        "capture joy.toml -o a.mp4\n"
        "capture joy.toml -o ./a.mp4\n"
        "dataset --count 3\n"
        "risorius capture joy.toml -o b.mp4\n"
        "capture nothere.toml -o c.mp4\n"
        "capture joy.toml\n"
        "convert ripples.toml -o joy.toml\n"
        "capture joy.toml -o mine\n"
        "capture joy.toml -o joy.toml\n"
    )
    before = contents(".")
    ended = batch()
    lines = ended.stderr.splitlines()
    words = (
        (1, "'320x' is not a size"),
        (2, "quotation mark"),
        (3, "is written by line 9"),
        (4, "a.mp4: is written by line 3"),
        (5, "allowed are capture, export, convert"),
        (6, "'risorius' is not a command"),
        (7, "nothere.toml: there is no such file"),
        (8, "writes no file"),
        (10, "not empty"),
        (11, "is both an input and an output"),
    )
    assert ended.exit_code == 2
    assert ended.stdout == ""
    for number, part in words:
        message = [line for line in lines if line.startswith(f"risorius: clips.txt:{number}: ")]
        assert any(part in line for line in message), (number, message)
    assert all(line.startswith("risorius: clips.txt:") and line.isprintable() for line in lines)
    assert contents(".") == before


@pytest.mark.parametrize(
    ("text", "message"), [(None, "no such list"), ("# nothing\n\n", "has no command")]
)
def test_a_list_of_nothing(text, message):
    """An empty list gives one line and exit code 2."""
    Path("clips.txt").unlink()
    if text is not None:
        Path("clips.txt").write_text(text)
    assert message in refusal(batch())


def test_jobs_and_scheduler_exclude_each_other():
    """Both options are refused together, because a cluster has a fixed number of workers."""
    message = refusal(batch("--jobs", "2", "--scheduler", "tcp://a:1"))
    assert "--jobs and --scheduler exclude each other" in message


@pytest.mark.slow
def test_one_line_fails_alone():
    """One line fails alone, with exit code 1 and its reason in one line and in the summary.

    `--resume` tries it again.
    """
    Path("silent.wav").write_text("no sound")
    Path("waves.toml").write_text('sound = "silent.wav"\n' + plane_script(0.5))
    ended = batch("--jobs", "1")
    assert ended.exit_code == 1
    assert statuses() == ["ok", "failed", "ok"]
    assert "silent.wav" in rows()[4]["error"]
    assert not contents("films")
    assert [line for line in ended.stderr.splitlines() if "clips.txt:4: " in line]
    Path("waves.toml").write_text(plane_script(0.5))
    assert batch("--resume").exit_code == 0
    assert statuses() == ["skipped", "ok", "skipped"]


@pytest.mark.parametrize("address", ["nonsense", "tcp://127.0.0.1:9", "foo://a:3", "tcp://a:99999"])
def test_a_scheduler_that_is_not_there(address):
    """An unreachable scheduler is reported in one line at once."""
    assert "no Dask scheduler answers there" in refusal(batch("--scheduler", address))


@pytest.mark.slow
def test_a_cluster_gives_the_results_of_this_machine(cluster):
    """Files made by a cluster are the same; a failing line fails alone, with the same report."""
    Path("waves.toml").write_text("duration = [")
    ended = batch("--scheduler", cluster.scheduler_address)
    assert ended.exit_code == 1
    assert statuses() == ["ok", "failed", "ok"]
    assert "waves.toml" in rows()[4]["error"]
    succeeded(*"export ripples.toml -o alone.npz --fps 20 --quiet".split())
    assert Path("alone.npz").read_bytes() == Path("ripples.npz").read_bytes()


def films(count):
    """A list of this number of films, and their names."""
    for number in range(count):
        Path(f"{number}.toml").write_text(plane_script(1 + number / 20))
    lines = [
        f"capture {number}.toml -o made/{number}.mp4 {SMALL_OPTIONS}" for number in range(count)
    ]
    Path("clips.txt").write_text("\n".join(lines))
    return [f"{number}.mp4" for number in range(count)]


def begun(*arguments):
    """The command, started as a process."""
    words = ("-m", "risorius", "batch", "clips.txt", *arguments)
    return started(*words, stdout=subprocess.DEVNULL)


def workers_of(process):
    """The worker processes of this process."""
    found = []
    for file in Path(f"/proc/{process.pid}/task").glob("*/children"):
        with_any = file.read_text() if file.exists() else ""
        found += [int(each) for each in with_any.split()]
    return found


linux = pytest.mark.skipif(not sys.platform.startswith("linux"), reason="looks into /proc")


@pytest.mark.slow
@linux
def test_killed_at_random_moments():
    """After a worker or the whole batch is killed, --resume gives exactly the undisturbed bytes."""
    names = films(3)
    assert batch("--jobs", "2").exit_code == 0
    undisturbed = contents("made")
    assert sorted(undisturbed) == [f"made/{name}" for name in names]
    chance = random.Random(20030214)
    for _ in range(3):
        for name in names:
            Path("made", name).unlink()
        process = begun("--jobs", "2", "--quiet")
        time.sleep(chance.uniform(0.2, 6.0))
        victims = [process.pid, *workers_of(process)]
        os.kill(chance.choice(victims), signal.SIGKILL)
        process.communicate(timeout=120)
        wait_until(lambda: not any(map(is_running, victims)))  # noqa: B023
        for path in Path("made").glob("*.mp4"):
            assert path.read_bytes() == undisturbed[str(path)], path
        resumed = batch("--resume", "--jobs", "2")
        assert resumed.exit_code == 0, resumed.output
        assert contents(*Path("made").glob("*.mp4")) == undisturbed
        assert len(rows()) == 3
