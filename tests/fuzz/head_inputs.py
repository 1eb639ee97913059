"""Odd and broken heads: mesh files and landmark files, each with what must become of it.

    for odd in head_inputs():
        brought = odd.write(folder)   # an empty folder for each
        open_brought(brought)         # a mesh or a head, or assets.AssetError where kind is REFUSED

Other programs may import the table; test_heads.py runs it.
"""

from __future__ import annotations

from collections.abc import Callable
from enum import Enum
from pathlib import Path
from typing import NamedTuple

from risorius import assets
from risorius.assets.fitting import FittedHead, fit_head
from risorius.assets.meshes import Mesh


class Kind(Enum):
    """What must become of an input."""

    MESH = "a mesh"
    HEAD = "a fitted head"
    REFUSED = "one line"


class Brought(NamedTuple):
    """The files of one input; without landmarks the mesh alone is read."""

    mesh: Path
    landmarks: Path | None = None


class OddHead(NamedTuple):
    """One input. `says` is a regular expression: what the one line must tell."""

    name: str
    write: Callable[[Path], Brought]
    kind: Kind
    says: str = ""


def open_brought(brought: Brought) -> Mesh | FittedHead:
    """Read or fit what was written, as the command does."""
    if brought.landmarks is None:
        return assets.read_mesh(brought.mesh)
    return fit_head(brought.mesh, brought.landmarks)


def mesh_file(name: str, content: bytes | str, expected: str | Kind = Kind.MESH) -> OddHead:
    """A mesh with some content; `expected`: a kind, or what the one line says."""

    def write(folder: Path) -> Brought:
        path = folder / name.rsplit("/", 1)[-1].replace(" ", "_")
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return Brought(path)

    if isinstance(expected, Kind):
        return OddHead(name, write, expected)
    return OddHead(name, write, Kind.REFUSED, expected)


def head_inputs() -> tuple[OddHead, ...]:
    """The whole table; names are unique."""
    from . import head_formats, head_landmarks, head_obj, head_paths

    return (
        *head_obj.INPUTS,
        *head_formats.INPUTS,
        *head_landmarks.INPUTS,
        *head_paths.INPUTS,
    )
