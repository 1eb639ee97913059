"""Commands of `risorius bench` that time what is played: `capture`, `window`."""

from __future__ import annotations

import click

from risorius.app.cli.parameters import FiniteRange, Size


@click.command("window")
@click.option("--size", type=Size(), default=(1280, 720), help="1280x720 unless told.")
@click.option(
    "--seconds", type=FiniteRange(0.3, 600.0), default=5.0, show_default=True, help="Of each case."
)
def bench_window(size: tuple[int, int], seconds: float) -> None:
    """Time the window while a smile plays, and while nothing happens; needs a screen."""
    from . import window

    click.echo(window.report(seconds, size))


@click.command("capture")
@click.option("--size", type=Size(), default=(1280, 720), help="1280x720 unless told.")
@click.option(
    "--seconds", type=FiniteRange(1.0, 60.0), default=8.0, show_default=True, help="Of the script."
)
def bench_capture(size: tuple[int, int], seconds: float) -> None:
    """Time a film without a screen: frames a second, and where its time goes."""
    from . import capture

    click.echo(capture.report(size, seconds))


COMMANDS = (bench_capture, bench_window)
