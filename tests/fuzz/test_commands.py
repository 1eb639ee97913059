"""The command line: every command and option with impossible values."""

import shlex

import pytest

from .command_inputs import ACCEPTED, REFUSED, hostile_values
from .sandbox import check_end, contents, run_command

pytestmark = pytest.mark.usefixtures("ready_face", "no_long_work")


def _short(words):
    return words if len(words) < 120 else f"{words[:100]}...{len(words)}"


@pytest.mark.slow
@pytest.mark.parametrize("line", ACCEPTED, ids=_short)
def test_good_commands(line, sandbox):
    """They succeed, and leave only their outputs."""
    before = contents(sandbox)
    ended = run_command(tuple(shlex.split(line)))
    assert ended.code == 0, ended.err
    check_end(ended, sandbox, before)


@pytest.mark.parametrize("line", REFUSED, ids=_short)
def test_mistakes(line, sandbox):
    """Each is reported in one line, in the words of the table."""
    before = contents(sandbox)
    ended = run_command(tuple(shlex.split(line)))
    assert ended.code == 2, ended
    check_end(ended, sandbox, before)
    assert REFUSED[line] in ended.err


@pytest.mark.slow
@pytest.mark.parametrize("words", [pytest.param(w, id=name) for name, w in hostile_values()])
def test_hostile_values(words, sandbox):
    """Any value of an option gives success, or one line."""
    before = contents(sandbox)
    check_end(run_command(words), sandbox, before)
