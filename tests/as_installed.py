"""Arrange the folders of this checkout as if installed: `python tests/as_installed.py FOLDER`.

Python finds `risorius.refine` in `refine/` through a file that `pip install --editable` writes.
Tools that only search for files, such as mypy and import-linter, need this tree of links.
"""

import os
import shutil
import sys
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]


def lay(target: Path) -> None:
    """Make the folder `risorius` in `target` anew, with a link to every source file."""
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
