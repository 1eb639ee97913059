"""The user's folders that several packages need."""

import os
from pathlib import Path


def configuration_folder() -> Path:
    """The user's folder for the configuration of Risorius; it may be missing."""
    folder = Path(os.environ.get("XDG_CONFIG_HOME") or Path.home() / ".config")
    return folder / "risorius"


def cache_folder() -> Path:
    """The user's folder for files that Risorius can make again at any time; it may be missing."""
    folder = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    return folder / "risorius"
