"""A note for the user at the first compilation of kernels, which takes long."""

from __future__ import annotations

import logging

import click

COMPILING_TEXT = "Compiling, once for each kind of work: half a minute, longer on a busy machine."


class _CompilingNote(logging.Handler):
    """Prints one note on compilation, and one if compiled kernels cannot be stored (jit.py)."""

    _printed: frozenset[int] = frozenset()

    def emit(self, record: logging.LogRecord) -> None:
        """Print a line, unless a line of this level was printed before."""
        if record.levelno not in self._printed:
            self._printed |= {record.levelno}
            line = COMPILING_TEXT
            if record.levelno >= logging.WARNING:
                line = f"risorius: {record.getMessage()}"
            click.echo(line, err=True)


def announce_compiling() -> None:
    """Install the log handler that prints the notes on compilation."""
    log = logging.getLogger("risorius.jit")
    log.handlers = [_CompilingNote()]
    log.propagate = False
    log.setLevel(logging.INFO)
