"""Read a mesh file with its whole appearance, for conversion to another format.

`read_mesh` omits data that a simulation does not need: the file's normals, texture coordinates
without a picture, materials, the bytes of pictures.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ..geometry.arrays import Floats64, Integers64
from .meshes import Mesh, read_mesh
from .pictures import libraries_of, material_key
from .user_files import MOST_FILE_VERTICES, path_beside, read_file
from .wavefront import MaterialLook, ObjSurface, Placing, looks_of, pictures_of, read_obj


@dataclass(frozen=True)
class Material:
    """The appearance of a part of a surface.

    picture: the content of its file, and its name; None without a picture.
    placing: position and size of the picture in texture coordinates.
    """

    name: str
    look: MaterialLook
    picture: tuple[bytes, str] | None
    placing: Placing


@dataclass(frozen=True)
class PaintedMesh:
    """A mesh file with its whole appearance.

    mesh: the result of `read_mesh`; V vertices in the file's order, F triangles.
    uv: texture coordinates, v up, shape (U, 2). face_uv: their indices, -1 for none, shape (F, 3).
    normals: shape (N, 3). face_normals: their indices, -1 for none, shape (F, 3).
    material: index into `materials` of each triangle, -1 for none, shape (F,).
    part: index into `parts` of each triangle, -1 for none, shape (F,). parts: names of the file's
    objects or groups, or of materials in a file without these.
    libraries: names of the files that define materials.
    """

    mesh: Mesh
    uv: Floats64
    face_uv: Integers64
    normals: Floats64
    face_normals: Integers64
    material: Integers64
    materials: tuple[Material, ...]
    part: Integers64
    parts: tuple[str, ...]
    libraries: tuple[str, ...] = ()


def read_painted(path: Path) -> PaintedMesh:
    """Read a mesh file other than glTF: OBJ with its materials, PLY with its colours, STL or OFF.

    Raises AssetError as `read_mesh` does.
    """
    mesh = read_mesh(path)
    if path.suffix.lower() == ".obj":
        surface = read_obj(read_file(path, kind="mesh", most=100), most=MOST_FILE_VERTICES)
        return PaintedMesh(
            mesh=mesh,
            uv=surface.uv,
            face_uv=_valid_indices(surface.face_uv, len(surface.uv)),
            normals=surface.normals,
            face_normals=_valid_indices(surface.face_normals, len(surface.normals)),
            material=surface.material,
            materials=tuple(_materials(surface, path.parent)),
            part=surface.part if surface.parts else surface.material,
            parts=surface.parts or surface.materials,
            libraries=tuple(libraries_of(surface.libraries, path.parent)),
        )
    none = np.full(mesh.faces.shape, -1, np.int64)
    of_triangles = none[:, 0]
    return PaintedMesh(
        mesh=mesh,
        uv=np.zeros((0, 2)),
        face_uv=none,
        normals=np.zeros((0, 3)),
        face_normals=none,
        material=of_triangles,
        materials=(),
        part=of_triangles,
        parts=(),
    )


def _valid_indices(numbers: Integers64, count: int) -> Integers64:
    """Replace indices that are not below `count` by -1."""
    return np.where(numbers < count, numbers, -1)


def _materials(surface: ObjSurface, folder: Path) -> list[Material]:
    """The materials of a surface, from its existing libraries."""
    looks: dict[str, MaterialLook] = {}
    pictures: dict[str, Any] = {}
    for name in libraries_of(surface.libraries, folder):
        library = path_beside(folder, name)
        if library.exists():
            content = read_file(library, kind="material", most=1)
            looks.update(looks_of(content))
            pictures.update(pictures_of(content))
    found = []
    for name in surface.materials:
        painted = pictures.get(material_key(name, pictures))
        look = looks.get(material_key(name, looks), MaterialLook())
        picture = None
        if painted is not None:
            path = path_beside(folder, painted.name)
            if path.exists():
                picture = (read_file(path, kind="picture", most=100), path.name)
        placing = Placing() if painted is None else painted.placing
        found.append(Material(name, look, picture, placing))
    return found
