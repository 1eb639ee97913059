"""Commands of `risorius bench` that time what is played: `capture`, `take` and others."""

from __future__ import annotations

import click

from risorius.app.cli.parameters import FiniteRange, Size

from ..command_line import conclude


@click.command("take")
@click.option(
    "--minutes", type=FiniteRange(0.05, 120), default=10.0, show_default=True, help="Recorded."
)
def bench_take(minutes: float) -> None:
    """Time a long recording of a face: reading it, making a script of it, playing that."""
    from . import takes

    click.echo(takes.report(minutes))


@click.command("window")
@click.option("--size", type=Size(), default=(1280, 720), help="1280x720 unless told.")
@click.option(
    "--seconds", type=FiniteRange(0.3, 600.0), default=5.0, show_default=True, help="Of each case."
)
def bench_window(size: tuple[int, int], seconds: float) -> None:
    """Time the window while a smile plays, and while nothing happens; needs a screen."""
    from . import window

    click.echo(window.report(seconds, size))


@click.command("live")
@click.option(
    "--seconds", type=FiniteRange(1.0, 600.0), default=12.0, show_default=True, help="Of each."
)
@click.option("--window", is_flag=True, help="Also in the window; needs a screen.")
def bench_live(seconds: float, window: bool) -> None:
    """Time a live face from its packet to the skin, for each protocol."""
    from . import live

    text, target = live.report(seconds, with_window=window)
    conclude(text, [target])


@click.command("capture")
@click.option("--size", type=Size(), default=(1280, 720), help="1280x720 unless told.")
@click.option(
    "--seconds", type=FiniteRange(1.0, 60.0), default=8.0, show_default=True, help="Of the script."
)
def bench_capture(size: tuple[int, int], seconds: float) -> None:
    """Time a film without a screen: frames a second, and where its time goes."""
    from . import capture

    click.echo(capture.report(size, seconds))


COMMANDS = (bench_capture, bench_take, bench_window, bench_live)
