"""Read a triangle mesh that somebody brings, in any format that trimesh reads.

trimesh likes to merge, split and reorder vertices on loading; here every vertex and triangle stays
where the file has it, because landmarks and animation caches count on their numbers.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from .model import AssetError

FARTHEST = (
    1e9  # of a coordinate, in any unit: far beyond all meshes, and its cube is still a number
)


@dataclass(frozen=True)
class Mesh:
    """A bare triangle mesh: what `sim.create` and `refine.create` ask for at least.

    vertices: positions [unit of the file], shape (V, 3), float64.
    faces: vertex numbers, shape (F, 3), int32.
    """

    vertices: npt.NDArray[np.float64]
    faces: npt.NDArray[np.int32]


def read_mesh(path: str | Path) -> Mesh:
    """Read one triangle mesh; several in one file become one, polygons become triangles.

    Raises AssetError for a file that is missing, of an unknown format, broken, or has no triangles.
    """
    import trimesh  # half a second, needed by nothing else here

    path = Path(path)
    if not path.is_file():
        raise AssetError(f"{path}: no such mesh file")
    suffix = path.suffix.lower().lstrip(".")
    if suffix not in trimesh.available_formats():
        known = ", ".join(sorted(name for name in ("glb", "obj", "off", "ply", "stl")))
        raise AssetError(f"{path}: cannot read '.{suffix}' files; among those it can are {known}")
    try:
        loaded = trimesh.load_scene(path, process=False, maintain_order=True)
        mesh = loaded.to_mesh() if len(loaded.geometry) else None
    except Exception as error:  # every reader of trimesh has its own kinds
        reason = " ".join(str(error).split()) or type(error).__name__
        raise AssetError(f"{path}: broken or not what its name says: {reason}") from None
    if mesh is None or not len(mesh.faces):
        raise AssetError(f"{path}: holds no triangles")
    vertices = np.array(mesh.vertices, np.float64)
    if vertices.shape[1] != 3:
        raise AssetError(
            f"{path}: its vertices have {vertices.shape[1]} coordinates; they must have 3"
        )
    is_near = (np.abs(vertices) <= FARTHEST).all(axis=1)  # not so where a number is none
    if not is_near.all():
        where = int(np.argmin(is_near))
        raise AssetError(
            f"{path}: vertex {where} (counted from 0) is at {vertices[where].tolist()}; it must "
            f"be finite numbers up to {FARTHEST:g}"
        )
    return Mesh(vertices, np.array(mesh.faces, np.int32))
