"""Read a triangle mesh that somebody brings: OBJ, PLY, STL, OFF or GLB, and what paints it.

trimesh reads all but OBJ, in a process of its own (foreign.py). It likes to merge and reorder
vertices on loading, and to open the pictures and materials that a file names; here every vertex and
triangle stays where the file has it, because landmarks and animation caches count on their numbers.
What paints an OBJ file is in files beside it; see pictures.py.
"""

from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from .errors import AssetError
from .foreign import Arrays, read_arrays_apart
from .pictures import Texture, libraries_missing, texture_of
from .topology import unique_points
from .user_files import MOST_VERTICES, named, read_file
from .wavefront import read_obj

FORMATS = ("obj", "ply", "stl", "off", "glb")  # ends of names
MOST_BYTES = 100_000_000
FARTHEST = (
    1e9  # of a coordinate, in any unit: far beyond all meshes, and its cube is still a number
)


@dataclass(frozen=True)
class Mesh:
    """A bare triangle mesh: what `sim.create` and `refine.create` ask for at least.

    vertices: positions [unit of the file], shape (V, 3), float64.
    faces: vertex numbers, shape (F, 3), int32.
    texture: how the file itself paints it, where it does.
    colours: of its vertices, sRGB, shape (V, 3), uint8, where the file has such.
    same: of vertices that the file doubles, the one that `faces` name, shape (V,).
    notes: what its bringer should know, a line each.
    """

    vertices: npt.NDArray[np.float64]
    faces: npt.NDArray[np.int32]
    texture: Texture | None = None
    colours: npt.NDArray[np.uint8] | None = None
    same: npt.NDArray[np.integer[Any]] | None = None
    notes: tuple[str, ...] = ()


def read_mesh(path: str | Path) -> Mesh:
    """Read one triangle mesh; several in one file become one, polygons become triangles.

    STL has no vertex numbers: there, corners in the same place become one vertex.

    Raises AssetError for a file that is missing, of an unknown format, too large, broken, or has no
    triangles.
    """
    suffix = Path(path).suffix.lower().lstrip(".")
    try:
        if suffix not in FORMATS:
            known = ", ".join(f".{name}" for name in FORMATS)
            raise AssetError(f"its name must end in {known}: save the mesh in one of these formats")
        content = read_file(
            path,
            kind="mesh",
            most_bytes=MOST_BYTES,
            cure="reduce it in a modelling program, or save it without pictures",
        )
        texture = colours = None
        notes: tuple[str, ...] = ()
        if suffix == "obj":
            surface = read_obj(content, most=MOST_VERTICES)
            vertices, faces = surface.vertices, surface.faces
            texture = texture_of(surface, Path(path).parent)
            notes = libraries_missing(surface, Path(path).parent)
        else:
            arrays = read_arrays_apart(content, suffix)
            vertices, faces, colours = arrays["vertices"], arrays["faces"], arrays.get("colours")
            texture = _texture(arrays) if "uv" in arrays else None
        if suffix == "stl":
            vertices = vertices + 0.0  # no zero with a sign
            first, number = unique_points(vertices)
            vertices, faces = vertices[first], number[faces]
        _check(vertices, faces)
        same = None
        if suffix == "glb" and texture is not None:  # its vertices are doubled along seams
            first, number = unique_points(vertices + 0.0)
            same = first[number]
            faces = same[faces]
    except AssetError as error:
        raise AssetError(f"{named(path)}: {error}") from None
    return Mesh(vertices.astype(np.float64), faces.astype(np.int32), texture, colours, same, notes)


def _texture(arrays: Arrays) -> Texture:
    """How a GLB file, the only one of these that holds pictures itself, paints its mesh."""
    count = sum(name.startswith("picture_") for name in arrays)
    return Texture(
        arrays["uv"].astype(np.float32),
        arrays["faces"].astype(np.int32),
        arrays["picture"],
        tuple(partial(arrays.__getitem__, f"picture_{number}") for number in range(count)),
    )


def _check(vertices: npt.NDArray[Any], faces: npt.NDArray[Any]) -> None:
    """AssetError unless there are triangles between vertices that are numbers within range."""
    if not len(faces):
        raise AssetError("holds no triangles; it must hold the surface of a head, as polygons")
    if max(len(faces), len(vertices)) > MOST_VERTICES:
        raise AssetError(
            f"has {len(vertices)} vertices and {len(faces)} triangles; allowed are "
            f"{MOST_VERTICES}: reduce it in a modelling program"
        )
    is_there = ((faces >= 0) & (faces < len(vertices))).all(axis=1)
    if not is_there.all():
        where = int(np.argmin(is_there))
        raise AssetError(
            f"triangle {where} (counted from 0) has the vertices {faces[where].tolist()}; there "
            f"are 0 to {len(vertices) - 1}: save the mesh anew"
        )
    is_near = (np.abs(vertices) <= FARTHEST).all(axis=1)  # not so where a number is none
    if not is_near.all():
        where = int(np.argmin(is_near))
        raise AssetError(
            f"vertex {where} (counted from 0) is at {vertices[where].tolist()}; it must be finite "
            f"numbers up to {FARTHEST:g}: remove it, or choose another unit"
        )
