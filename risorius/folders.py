"""Folders of the user that several packages need."""

import os
from pathlib import Path


def configuration_folder() -> Path:
    """The user's configuration of Risorius, which need not be there."""
    folder = Path(os.environ.get("XDG_CONFIG_HOME") or Path.home() / ".config")
    return folder / "risorius"
