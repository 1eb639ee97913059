"""A line for the user when kernels are compiled, which takes long once."""

from __future__ import annotations

import logging

import click


class _CompilingNote(logging.Handler):
    """Prints once that kernels are compiled, and once that they cannot be stored (jit.py)."""

    _printed: frozenset[int] = frozenset()

    def emit(self, record: logging.LogRecord) -> None:
        """Print a line, unless a line of this level was printed before."""
        if record.levelno not in self._printed:
            self._printed |= {record.levelno}
            line = "Compiling, once for each kind of work: up to half a minute."
            if record.levelno >= logging.WARNING:
                line = f"risorius: {record.getMessage()}"
            click.echo(line, err=True)


def announce_compiling() -> None:
    """From here on print a note when kernels are compiled, which takes long once."""
    log = logging.getLogger("risorius.jit")
    log.handlers = [_CompilingNote()]
    log.propagate = False
    log.setLevel(logging.INFO)
