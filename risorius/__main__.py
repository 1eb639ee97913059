"""The command `risorius` with the sub-commands of app/ and bench/."""

from __future__ import annotations

from typing import TYPE_CHECKING

from risorius.app.stopping import handle_signals

if TYPE_CHECKING:
    import click


def command() -> click.Group:
    """Return the command with all sub-commands."""
    from risorius.app.cli import main
    from risorius.bench.commands import bench
    from risorius.bench.reproduce.commands import reproduce

    main.add_command(bench)
    main.add_command(reproduce)
    return main


def run() -> None:
    """Run the command; signals are handled before other modules are loaded."""
    handle_signals()
    command()()


if __name__ == "__main__":
    run()
