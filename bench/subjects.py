"""Faces that are known densely and coarsely, at rest and in expressions: truth to measure against.

Two sources. A folder of scanned motion as `bench motion` takes it, with a decimation beside it:
`face.npz` (vertices, triangles, a displacement field (V, 3) for each expression [cm]) and
`coarse_2029.npz` (triangles, and where each coarse vertex lies on the dense mesh: fine_triangle,
barycentric); and, where they are there, other persons of the same triangles, who are moved alike:
`identities.npz` (vertices of each). And the built-in head: its finer meshes, moved by the
simulation itself, and of their vertices those that the head has.
"""

from __future__ import annotations

import math
import zipfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import numpy.typing as npt

from risorius import assets, sim
from risorius.assets.model import FineMesh

Points = npt.NDArray[np.float64]
Faces = npt.NDArray[np.int32]

MILLIMETRES = 10.0  # per unit of a folder of scans (cm)
COARSE = "coarse_2029.npz"
DENSE = "face.npz"
PERSONS = "identities.npz"
NOT_MOTION = ("vertices", "triangles", "landmarks68")
SETTLE = 90  # frames of 1/60 s until a pose is still
FILM = 90  # frames of 1/30 s in which an expression comes and goes


@dataclass(frozen=True)
class PosePair:
    """One expression, on both meshes [mm]."""

    dense: Points
    coarse: Points


@dataclass(frozen=True)
class Subject:
    """A face as a dense mesh, a coarse one, and expressions of both."""

    name: str
    group: str
    """What it is reported with."""
    dense_faces: Faces
    coarse_faces: Faces
    rest: PosePair
    poses: Mapping[str, PosePair]
    film: Callable[[str], Sequence[Points]] | None = None
    """Moves the coarse mesh through an expression, frames of 1/30 s."""

    def frames(self, expression: str) -> Sequence[Points]:
        """Positions of the coarse mesh while an expression comes, and goes if that is different."""
        if self.film is not None:
            return self.film(expression)
        way = self.poses[expression].coarse - self.rest.coarse
        return [self.rest.coarse + strength(k) * way for k in range(FILM // 2 + 1)]


def strength(frame: int) -> float:
    """How far an expression has come in a frame of a film, 0..1."""
    return math.sin(math.pi * frame / FILM) ** 2


def scanned(folder: str | Path) -> list[Subject]:
    """Read a folder of scans: every person and every expression in it.

    Fields that end in _L and _R are two halves of one expression, and are added.
    Raises ValueError, naming the file, if something is missing in it.
    """
    dense = read_arrays(Path(folder) / DENSE, ("vertices", "triangles"))
    coarse = read_arrays(Path(folder) / COARSE, ("triangles", "fine_triangle", "barycentric"))
    shape = dense["vertices"].shape
    fields: dict[str, Points] = {}
    for name, array in dense.items():
        if name in NOT_MOTION or array.shape != shape:
            continue
        expression = name.removesuffix("_L").removesuffix("_R")
        moved = MILLIMETRES * array.astype(np.float64)
        fields[expression] = fields.get(expression, np.zeros(shape)) + moved
    if not fields:
        raise ValueError(f"{Path(folder) / DENSE}: no displacement field of shape {shape}")
    persons = {"scan": dense["vertices"]}
    others = Path(folder) / PERSONS
    if others.is_file():
        persons |= {name.replace("_", " "): rest for name, rest in read_arrays(others, ()).items()}
    strange = [name for name, rest in persons.items() if rest.shape != shape]
    if strange:
        raise ValueError(f"{others}: '{strange[0]}' has not the {shape[0]} vertices of {DENSE}")

    def subject(name: str, vertices: npt.NDArray[Any]) -> Subject:
        """A person, whose skin moves as that of the scan."""
        rest = MILLIMETRES * vertices.astype(np.float64)
        corners = dense["triangles"][coarse["fine_triangle"]]
        weights = coarse["barycentric"].astype(np.float64)

        def pose(points: Points) -> PosePair:
            return PosePair(points, np.einsum("vi,vij->vj", weights, points[corners]))

        return Subject(
            name,
            "scan" if name == "scan" else "other persons",
            dense["triangles"].astype(np.int32),
            coarse["triangles"].astype(np.int32),
            pose(rest),
            {expression: pose(rest + moved) for expression, moved in fields.items()},
        )

    return [subject(name, vertices) for name, vertices in persons.items()]


def built_in(level: int) -> Subject:
    """Take the built-in head with 4 or 16 times its triangles (level 1 or 2) as the dense mesh.

    The muscles of its rig move the dense mesh; the coarse one goes along, as its first vertices.
    """
    head = assets.load("head")
    fine = head.finer(level)
    simulation = fine_simulation(head, fine)
    count = len(head.vertices)
    poses = {}
    for name, values in head.expressions.items():
        moved = settled_positions(simulation, values, SETTLE)
        poses[name] = PosePair(moved, moved[:count])
    own = sim.create(head)

    def film(expression: str) -> list[Points]:
        """Move the head itself, faster than the fine one and much alike."""
        own.reset()
        frames = []
        for frame in range(FILM + 1):
            share = strength(frame)
            own.set_all({key: share * at for key, at in head.expressions[expression].items()})
            for _ in range(2):
                own.step(1.0 / 60.0)
            frames.append(own.positions.copy())
        return frames

    return Subject(
        f"head x {4**level}",
        "head",
        fine.faces,
        head.faces,
        PosePair(fine.vertices, fine.vertices[:count]),
        poses,
        film,
    )


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
) -> Points:
    """Hold controls from rest for some frames of 1/60 s; a copy of the vertices [mm], (V, 3)."""
    simulation.reset()
    simulation.set_all(values)
    for _ in range(frames):
        simulation.step(1.0 / 60.0)
    return simulation.positions.copy()


def read_arrays(path: Path, needed: tuple[str, ...]) -> dict[str, npt.NDArray[Any]]:
    """All arrays of a file; ValueError where it is broken or one of `needed` is missing."""
    if not path.is_file():
        raise ValueError(f"{path}: is not there; a reference folder has {DENSE} and {COARSE}")
    try:
        with np.load(path) as file:
            arrays = {name: file[name] for name in file.files}
    except (ValueError, AttributeError, EOFError, zipfile.BadZipFile):
        raise ValueError(f"{path}: is broken, or no file of arrays (numpy's .npz)") from None
    missing = [name for name in needed if name not in arrays]
    if missing:
        raise ValueError(f"{path}: has no array {missing[0]!r}; it has {sorted(arrays)}")
    strange = [name for name, array in arrays.items() if array.dtype.kind not in "iuf"]
    if strange:
        raise ValueError(f"{path}: array {strange[0]!r} holds no numbers")
    return arrays
