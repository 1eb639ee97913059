"""The files of this checkout that git tracks, without files left by an editor."""

import functools
import subprocess
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]


def tracked(folder: str | Path = ROOT, pattern: str = "*") -> list[Path]:
    """The tracked files in a folder of the checkout and below it, with matching names."""
    top = ROOT / folder
    return [path for path in _files() if path.is_relative_to(top) and path.match(pattern)]


@functools.cache
def _files() -> tuple[Path, ...]:
    """All tracked files, or all files of an unpacked source distribution, which has no git."""
    git = ["git", "-C", str(ROOT), "ls-files", "-z", "--cached"]
    try:
        if not (ROOT / ".git").exists():
            raise FileNotFoundError
        listed = subprocess.run(git, check=True, capture_output=True).stdout.decode().split("\0")
        paths = [ROOT / name for name in listed if name]
    except (OSError, subprocess.CalledProcessError):
        paths = [path for path in ROOT.rglob("*") if not _is_made(path)]
    return tuple(sorted(path for path in paths if path.is_file()))


def _is_made(path: Path) -> bool:
    """Whether a path is in a folder made by programs: compiled modules, environments, caches."""
    return any(
        name == "__pycache__" or name.endswith(".egg-info") or name.startswith((".venv", "build"))
        for name in path.relative_to(ROOT).parts
    )
