"""The command line: every command and option with invalid values."""

import shlex

import pytest

from .command_inputs import ACCEPTED_COMMANDS, REFUSED_COMMANDS, hostile_values
from .sandbox import check_end, contents, run_command

pytestmark = pytest.mark.usefixtures("ready_face", "no_long_work")


def _short(words):
    return words if len(words) < 120 else f"{words[:100]}...{len(words)}"


@pytest.mark.slow
@pytest.mark.parametrize("line", ACCEPTED_COMMANDS, ids=_short)
def test_good_commands(line, sandbox):
    """Commands without mistakes succeed, and add only their outputs."""
    before = contents(sandbox)
    ended = run_command(tuple(shlex.split(line)))
    assert ended.code == 0, ended.err
    check_end(ended, sandbox, before)


@pytest.mark.parametrize("line", REFUSED_COMMANDS, ids=_short)
def test_mistakes(line, sandbox):
    """Each mistake is reported in one line, with the words in the table."""
    before = contents(sandbox)
    ended = run_command(tuple(shlex.split(line)))
    assert ended.code == 2, ended
    check_end(ended, sandbox, before)
    assert REFUSED_COMMANDS[line] in ended.err


@pytest.mark.slow
@pytest.mark.parametrize("words", [pytest.param(w, id=name) for name, w in hostile_values()])
def test_hostile_values(words, sandbox):
    """With a hostile value of any option, the command succeeds or prints one line."""
    before = contents(sandbox)
    check_end(run_command(words), sandbox, before)
