"""Ctrl-C in the middle of what moderngl does not survive."""

from __future__ import annotations

import signal

import pytest

from render.programs import compile_program


def test_ctrl_c_waits_for_a_program() -> None:
    """An interrupt while a program is compiled comes when it is done: moderngl would crash."""
    finished = []

    class Interrupted:
        """A context whose user presses Ctrl-C in the middle of compiling."""

        def program(self, **stages: str | None) -> object:
            signal.raise_signal(signal.SIGINT)
            finished.append(stages)
            return object()

    with pytest.raises(KeyboardInterrupt):
        compile_program(Interrupted(), "surface.glsl")  # type: ignore[arg-type]
    assert len(finished) == 1
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
