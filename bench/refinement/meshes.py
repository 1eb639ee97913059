"""Meshes of all kinds, as they lie about in a folder: does any of them crack when it is refined.

Every file that trimesh reads is bound by each method and bent into four poses, from rest to noise
as large as its triangles. Each frame is looked at by `refine.check`, which believes a refiner which
edges the mesh has; so these are found again here. Neither the mesh nor the pose may have changed.
"""

from __future__ import annotations

import os
import time
import zlib
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from risorius import assets, refine
from risorius.assets.subdivision import quarter

Points = npt.NDArray[np.float64]
Faces = npt.NDArray[np.int32]

SEED = 2003
SECONDS = 20.0  # for each mesh
MOST_TRIANGLES = 200_000
LARGEST_FILE = 2**26  # [bytes]
METHODS: Mapping[str, tuple[str, Mapping[str, Any]]] = {
    "kahler": ("kahler", {}),
    "cubic": ("kahler", {"scheme": "cubic", "blend": False}),
    "blend": ("kahler", {"scheme": "cubic", "blend": True}),
    "coherent": ("kahler", {"coherent": True}),
    "seams": ("kahler", {"criterion": "normal+rest"}),
    "detail": ("kahler", {"scheme": "detail"}),
    "loop": ("loop", {"levels": 2}),
}
NOISE = (0.0, 0.03, 0.3, 1.0)  # of each pose [median edge]
WAVE = 3.0  # [median edges] of its height, as long as a third of the mesh
BUMP = 0.2  # [of an edge] on the finer mesh that detail is taken from


@dataclass(frozen=True)
class MeshResult:
    """What was found on one file."""

    name: str
    triangles: int = 0
    frames: int = 0
    broken: tuple[str, ...] = ()  # a line for each frame or method that is
    left_out: str = ""  # why it was not refined at all
    is_cut_short: bool = False  # by the time a mesh has


def measure(
    folder: Path,
    *,
    seed: int = SEED,
    seconds: float = SECONDS,
    most_triangles: int = MOST_TRIANGLES,
    progress: Callable[[str], object] = lambda _: None,
) -> list[MeshResult]:
    """Look at every mesh in a folder and those below it; ValueError where there is none."""
    found = []
    for path in _mesh_files(folder):
        name = str(path.relative_to(folder))
        progress(name)
        found.append(_measure_file(path, name, seed, seconds, most_triangles))
    if not found:
        raise ValueError(f"{folder}: holds no file that could be a mesh (.obj, .ply, .stl, ...)")
    return found


def refined(
    vertices: Points,
    faces: Faces,
    *,
    seed: int = SEED,
    seconds: float = SECONDS,
    create: Callable[..., refine.Refiner] = refine.create,
) -> tuple[int, list[str], bool]:
    """Refine one mesh by every method: how many frames, what is broken, whether time ran out.

    create: in place of `refine.create`. Raises ValueError where it refuses the mesh.
    """
    frames, end = 0, time.perf_counter() + seconds
    broken: list[str] = []
    poses = _poses(vertices, faces, np.random.default_rng(seed))
    for method, (name, options) in METHODS.items():
        generator = np.random.default_rng(seed)
        added = dict(options)
        if method == "detail":
            added["detail"] = _finer(vertices, faces, generator)
        elif method == "seams":
            added["uv"] = generator.uniform(size=(max(len(vertices), 1), 2))
            added["face_uv"] = generator.integers(len(added["uv"]), size=faces.shape)
        refiner = create(name, faces, vertices, **added)
        for number, pose in enumerate(poses):
            if time.perf_counter() > end:
                return frames, broken, True
            wrong = _fault_in_pose(refiner, vertices, faces, pose)
            frames += 1
            if wrong:
                broken.append(f"{method}, pose {number}: {wrong}")
    return frames, broken, False


def _fault_in_pose(refiner: refine.Refiner, vertices: Points, faces: Faces, pose: Points) -> str:
    """Refine one pose: what is wrong with it, "" if nothing."""
    before = [array.tobytes() for array in (vertices, faces, pose)]
    mesh = refiner.refine(pose)
    if before != [array.tobytes() for array in (vertices, faces, pose)]:
        return "the mesh that was lent has changed"
    if not _are_edges_of(faces, refiner):
        return "edges of the refiner are not those of the mesh"
    try:
        refine.check(refiner, mesh, pose)
    except refine.BrokenMeshError as error:
        return str(error)
    return ""


def _are_edges_of(faces: Faces, refiner: refine.Refiner) -> bool:
    """Whether a refiner knows every edge of the mesh, and none twice."""
    ends = np.sort(np.stack([faces, np.roll(faces, -1, axis=1)], axis=2), axis=2)
    has_area = (ends[:, :, 0] != ends[:, :, 1]).all(axis=1)
    edges = np.sort(refiner.edges, axis=1)
    named = edges[refiner.triangle_edges[has_area]]
    return len(np.unique(edges, axis=0)) == len(edges) and np.array_equal(named, ends[has_area])


def _mesh_files(folder: Path) -> Iterator[Path]:
    """Files of a format that trimesh knows, in the order of their names."""
    import trimesh  # half a second

    formats = trimesh.available_formats()
    for parent, folders, names in os.walk(folder):
        folders.sort()
        for name in sorted(names):
            if Path(name).suffix.lower().lstrip(".") in formats:
                yield Path(parent) / name


def _measure_file(
    path: Path, name: str, seed: int, seconds: float, most_triangles: int
) -> MeshResult:
    try:
        if path.is_file() and path.stat().st_size > LARGEST_FILE:
            return MeshResult(name, left_out=f"has more than {LARGEST_FILE >> 20} MB")
        mesh = assets.read_mesh(path)
        count = len(mesh.faces)
        if count > most_triangles:
            return MeshResult(name, count, left_out=f"has more than {most_triangles} triangles")
        own_seed = zlib.crc32(f"{seed} {name}".encode())
        frames, broken, is_cut_short = refined(
            mesh.vertices, mesh.faces, seed=own_seed, seconds=seconds
        )
    except (assets.AssetError, OSError) as error:
        return MeshResult(name, left_out=str(error).removeprefix(f"{path}: "))
    except ValueError as error:  # of refine.create and refine
        return MeshResult(name, count, left_out=f"refused: {error}")
    return MeshResult(name, count, frames, tuple(broken), is_cut_short=is_cut_short)


def _poses(vertices: Points, faces: Faces, generator: np.random.Generator) -> list[Points]:
    """The mesh at rest, and under waves with more and more noise."""
    edge = _median_edge(vertices, faces)
    size = max(float(np.ptp(vertices, axis=0).max(initial=0.0)), edge)
    poses = []
    for noise in NOISE:
        direction, turn = generator.normal(size=(2, 3))
        phase = vertices @ direction * (6.0 * np.pi / size / np.linalg.norm(direction))
        wave = np.sin(phase)[:, None] * (turn / np.linalg.norm(turn))
        height = WAVE * edge if noise > 0.0 else 0.0
        moved = vertices + height * wave + noise * edge * generator.normal(size=vertices.shape)
        poses.append(moved)
    return poses


def _median_edge(vertices: Points, faces: Faces) -> float:
    """The usual length of an edge; 1 where all are at one place."""
    ends = vertices[faces]
    length = float(np.median(np.linalg.norm(ends - np.roll(ends, 1, axis=1), axis=2)))
    return length if length > 0.0 else 1.0


def _finer(vertices: Points, faces: Faces, generator: np.random.Generator) -> tuple[Points, Faces]:
    """The mesh with four times its triangles, and bumps in the middle of its edges."""
    finer = quarter(faces, len(vertices))
    bumps = BUMP * _median_edge(vertices, faces) * generator.normal(size=(len(finer.edges), 3))
    return np.concatenate([vertices, vertices[finer.edges].mean(axis=1) + bumps]), finer.faces


def report(found: Sequence[MeshResult]) -> str:
    """The text to print."""
    refined = [each for each in found if not each.left_out]
    lines = [f"{'triangles':>9} {'frames':>6} {'broken':>6}  mesh"]
    for each in found:
        note = f": left out, {each.left_out}" if each.left_out else ""
        note += ": cut short" if each.is_cut_short else ""
        lines.append(
            f"{each.triangles:9d} {each.frames:6d} {len(each.broken):6d}  {each.name}{note}"
        )
        lines += [f"{'':25}{line}" for line in each.broken]
    return "\n".join(
        [
            *lines,
            "",
            f"{len(found)} files: {len(refined)} refined, {len(found) - len(refined)} left out, "
            f"{sum(each.is_cut_short for each in found)} cut short;",
            f"{sum(each.triangles for each in refined)} triangles, "
            f"{sum(each.frames for each in found)} frames, "
            f"{sum(len(each.broken) for each in found)} of them broken",
        ]
    )
