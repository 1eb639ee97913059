"""The `risorius` command: what it can do is in commands.py, one short function for each."""

from __future__ import annotations

import os
import sys

import click

from risorius import __version__

from . import commands
from .compiling import announce
from .group import OneLineGroup


@click.group(cls=OneLineGroup, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, prog_name="risorius")
def main() -> None:
    """Physics-based facial animation with dynamically refined triangle meshes."""
    if sys.stderr is None:  # closed by whoever started us; progress bars ask it what it is
        sys.stderr = open(os.devnull, "w")
    announce()


for command in commands.ALL:
    main.add_command(command)
