"""Reference faces: a folder of scans, and the built-in head with its finer meshes.

A folder of scans holds `face.npz`: vertices (V, 3), triangles (F, 3), landmarks68 (68,), and for
each expression a displacement field (V, 3); all in centimetres. `risorius bench reference` makes
such a folder from ICT-FaceKit. Fields that end in _L and _R are two halves of one expression, and
are added.
"""

from __future__ import annotations

import zipfile
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import numpy.typing as npt

from risorius import assets, sim
from risorius.app.errors import UserError
from risorius.assets.fitting import FittedHead, fit
from risorius.assets.meshes import Mesh
from risorius.assets.model import FineMesh
from risorius.assets.topology import collapsed, is_manifold
from risorius.geometry.arrays import Floats64, Integers32
from risorius.geometry.closest import closest_points

MILLIMETRES_PER_CENTIMETRE = 10.0  # per centimetre, the unit of a folder of scans
DENSE_FILE = "face.npz"
MODES_FILE = "identity_modes.npz"
SETTLING_FRAMES = 90  # frames of 1/60 s until a pose is still
COARSE_TRIANGLES = 2029  # of a decimated scan, about as many as in the built-in head
# Landmarks by region of the face.
LANDMARK_GROUPS = {
    "jaw": slice(0, 17),
    "brows": slice(17, 27),
    "nose": slice(27, 36),
    "lids": slice(36, 48),
    "lips": slice(48, 68),
    "all": slice(0, 68),
}


@dataclass(frozen=True)
class Scans:
    """A scanned neutral face, and its displacement in each expression [mm]."""

    mesh: Mesh
    landmarks: Integers32
    """Vertex indices of the 68 landmarks."""
    fields: Mapping[str, Floats64]
    """Expression -> displacement of all vertices, shape (V, 3)."""

    @classmethod
    def read(cls, directory: Path) -> Scans:
        """Read a folder. Raises UserError, which names the file, if it is broken."""
        other_arrays = ("vertices", "triangles", "landmarks68")
        arrays = read_arrays(directory / DENSE_FILE, other_arrays)
        vertices, triangles, landmarks = (arrays.pop(name) for name in other_arrays)
        has_triples = vertices.shape[1:] == triangles.shape[1:] == (3,)
        is_mesh = has_triples and landmarks.shape == (68,)
        if not is_mesh or max(triangles.max(), landmarks.max()) >= len(vertices):
            raise UserError(f"{directory / DENSE_FILE}: holds no mesh with 68 of its vertices")
        fields: dict[str, Floats64] = {}
        side_names = {"_L": "Left", "_R": "Right"}
        for name, array in arrays.items():
            if array.shape != vertices.shape:
                raise UserError(f"{directory / DENSE_FILE}: {name} must move all vertices")
            stem = name[:-2]
            end = name[-2:]
            if end in side_names:
                is_whole = all(f"{stem}{each}" in arrays for each in side_names)
                name = stem if is_whole else stem + side_names[end]
            moved = MILLIMETRES_PER_CENTIMETRE * array.astype(np.float64)
            fields[name] = fields.get(name, np.zeros_like(moved)) + moved
        mesh = Mesh(
            MILLIMETRES_PER_CENTIMETRE * vertices.astype(np.float64), triangles.astype(np.int32)
        )
        return cls(mesh, landmarks.astype(np.int32), fields)

    @cached_property
    def head(self) -> FittedHead:
        """The rig, fitted to the neutral face by its 68 landmarks, like to any face."""
        return fit(self.mesh, self.landmarks)

    def field(self, name: str) -> Floats64:
        """Displacement of the vertices of `head` by an expression [mm], shape (V, 3)."""
        return self.head.to_millimetres.vectors(self.fields[name][self.head.file_vertices])


@dataclass(frozen=True)
class PosePair:
    """Positions of both meshes in one expression [mm]."""

    dense: Floats64
    coarse: Floats64


@dataclass(frozen=True)
class Subject:
    """A face as a dense mesh, a coarse one, and expressions of both."""

    dense_faces: Integers32
    coarse_faces: Integers32
    rest: PosePair
    poses: Mapping[str, PosePair]


def scanned(scans: Scans) -> Subject:
    """A scan and its decimation; each coarse vertex moves like the nearest point of the scan."""
    mesh = scans.mesh
    points, faces = decimated(mesh.vertices, mesh.faces, COARSE_TRIANGLES)
    place = closest_points(points, mesh.vertices, mesh.faces)
    poses = {"": mesh.vertices, **{name: mesh.vertices + by for name, by in scans.fields.items()}}
    pairs = {name: PosePair(moved, place.interpolate(moved)) for name, moved in poses.items()}
    return Subject(mesh.faces, faces, pairs.pop(""), pairs)


def built_in(level: int = 2) -> Subject:
    """The built-in head, and as the dense mesh its finer mesh of a level (1 or 2).

    The rig's muscles move the dense mesh; its first vertices are the coarse mesh's vertices.
    """
    head = assets.load("head")
    fine = head.finer(level)
    count = len(head.vertices)
    simulation = fine_simulation(head, fine)
    poses = {}
    for name, values in head.expressions.items():
        moved = settled_positions(simulation, values, SETTLING_FRAMES)
        poses[name] = PosePair(moved, moved[:count])
    rest = PosePair(fine.vertices, fine.vertices[:count])
    return Subject(fine.faces, head.faces, rest, poses)


def fine_simulation(head: assets.Head, fine: FineMesh) -> sim.Simulation:
    """The simulation of a finer mesh of a head, with the muscles of its rig."""
    return sim.create(
        SimpleNamespace(
            vertices=fine.vertices,
            faces=fine.faces,
            landmarks=head.landmarks,
            rig=head.rig,
            layers=head.layers,
            bone_depth=fine.interpolate(head.bone_depth),
            mandible_weight=fine.interpolate(head.mandible_weight),
            jaw_axis=head.jaw_axis,
            eyes=head.eyes,
        )
    )


def settled_positions(
    simulation: sim.Simulation, values: Mapping[str, float], frames: int
) -> Floats64:
    """Vertices [mm], (V, 3), after controls were held from rest for some frames of 1/60 s."""
    simulation.reset()
    simulation.controls.set_all(values)
    for _ in range(frames):
        simulation.step(1.0 / 60.0)
    return simulation.positions.copy()


def read_arrays(path: Path, needed: tuple[str, ...]) -> dict[str, npt.NDArray[Any]]:
    """All arrays of a file; raises UserError if it is broken or one of `needed` is missing."""
    if not path.is_file():
        raise UserError(f"{path}: is not there; `risorius bench reference` makes such a folder")
    try:
        with np.load(path) as file:
            arrays = {name: file[name] for name in file.files}
    except (ValueError, AttributeError, EOFError, zipfile.BadZipFile):
        raise UserError(f"{path}: is broken, or no file of arrays (numpy's .npz)") from None
    missing = [name for name in needed if name not in arrays]
    if missing:
        raise UserError(f"{path}: has no array {missing[0]!r}; it has {sorted(arrays)}")
    return arrays


def decimated(vertices: Floats64, faces: Integers32, count: int) -> tuple[Floats64, Integers32]:
    """Return a simplified mesh of about `count` triangles; the edges of openings stay in place.

    A manifold mesh stays manifold: if every attempt would pinch it, more triangles are left.
    """
    most_attempts = 8  # at one number of triangles
    while count < len(faces):
        for attempt in range(most_attempts):
            points, triangles = collapsed(vertices, faces, count, attempt)
            if len(triangles) and is_manifold(triangles):
                return points, triangles
        count *= 2
    return vertices, faces
