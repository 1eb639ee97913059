"""The group `risorius bench`: measurements. What is slow to import, commands import inside."""

from __future__ import annotations

import click

from .playing.commands import COMMANDS as PLAYING
from .refinement.commands import COMMANDS as REFINEMENT
from .scans.commands import COMMANDS as SCANS
from .simulation.commands import COMMANDS as SIMULATION


@click.group()
def bench() -> None:
    """Measure: each command prints figures and how they were taken."""


for _each in (*REFINEMENT, *SIMULATION, *SCANS, *PLAYING):
    bench.add_command(_each)
