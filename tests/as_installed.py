"""Arrange the folders of this checkout as installed: `python tests/as_installed.py FOLDER`.

Python itself finds `risorius.refine` in `refine/` by a note of `pip install --editable`. Tools that
only search for files, like mypy and import-linter, get a tree of links.
"""

import os
import shutil
import sys
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]


def lay(target: Path) -> None:
    """Make the folder `risorius` in `target` again, from links to every source file."""
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["setuptools"]
    folders = {"risorius": "risorius", **settings["package-dir"]}
    shutil.rmtree(target / "risorius", ignore_errors=True)
    for package, folder in folders.items():
        shutil.copytree(
            ROOT / folder,
            target / package.replace(".", os.sep),
            copy_function=os.symlink,
            ignore=shutil.ignore_patterns("__pycache__", ".*"),
        )
    for folder in sorted(target.rglob("*/"), reverse=True):  # of removed sources
        if folder.is_dir() and not any(folder.iterdir()):
            folder.rmdir()


if __name__ == "__main__":
    lay(Path(sys.argv[1]))
