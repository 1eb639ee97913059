"""Scans of one face in several expressions, and our rig on that face.

Read is a folder with a neutral face and displacement fields under ARKit-like names as `face.npz`
(ICT-FaceKit's layout): `vertices` (V, 3), `triangles` (F, 3), `landmarks68` (68,), then one (V, 3)
field per shape. Other persons of the same triangles, moved alike, may lie beside it as
`identities.npz`: vertices (V, 3) of each.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from risorius.assets.fitting import FittedHead, fit
from risorius.assets.meshes import Mesh

from ..subjects import DENSE, PERSONS, read_arrays

NOT_SHAPES = ("vertices", "triangles", "landmarks68")


@dataclass(frozen=True)
class Scans:
    """A folder of scans, and the head that was fitted to the neutral one of them."""

    directory: str | Path
    head: FittedHead
    arrays: Mapping[str, npt.NDArray[Any]]

    @property
    def names(self) -> tuple[str, ...]:
        """What the fields are called."""
        return tuple(name for name in self.arrays if name not in NOT_SHAPES)

    def field(self, name: str) -> npt.NDArray[np.float64]:
        """How far the scan moved the head's vertices [mm], shape (V, 3).

        Raises ValueError, naming the file, where it is no motion of them.
        """
        field = self.arrays[name]
        if field.shape != self.arrays["vertices"].shape or not np.isfinite(field).all():
            raise ValueError(
                f"{self.directory}: {name} in {DENSE} must be finite displacements of all vertices"
            )
        return self.head.to_millimetres.vectors(field[self.head.file_vertices])

    def persons(self) -> Iterator[tuple[str, Scans]]:
        """Other persons in the folder, each with a head of their own that moves alike."""
        file = Path(self.directory) / PERSONS
        if file.is_file():
            for name, vertices in read_arrays(file, ()).items():
                yield name, _scans(self.directory, {**self.arrays, "vertices": vertices}, PERSONS)


def read_scans(directory: str | Path) -> Scans:
    """The scans in a folder. Raises ValueError, naming the file, if it is broken."""
    return _scans(directory, read_arrays(Path(directory) / DENSE, NOT_SHAPES), DENSE)


def _scans(directory: str | Path, arrays: Mapping[str, npt.NDArray[Any]], file: str) -> Scans:
    """Fit the rig to the head in some arrays; `file`: where its vertices are from."""
    mesh = Mesh(arrays["vertices"].astype(np.float64), arrays["triangles"].astype(np.int32))
    landmarks = arrays["landmarks68"].astype(np.int32)
    if not _is_sound(mesh, landmarks):
        raise ValueError(
            f"{directory}: in {file}, vertices must be finite, (V, 3), triangles (F, 3) and "
            "landmarks68 (68,) numbers of them"
        )
    return Scans(directory, fit(mesh, landmarks), arrays)


def _is_sound(mesh: Mesh, landmarks: npt.NDArray[np.int32]) -> bool:
    """Whether vertices, triangles and landmarks have their shapes and name vertices there are."""
    return (
        mesh.vertices.ndim == mesh.faces.ndim == 2
        and mesh.vertices.shape[1] == mesh.faces.shape[1] == 3
        and landmarks.shape == (68,)
        and bool(np.isfinite(mesh.vertices).all())
        and all(
            bool(((numbers >= 0) & (numbers < len(mesh.vertices))).all())
            for numbers in (mesh.faces, landmarks)
        )
    )
