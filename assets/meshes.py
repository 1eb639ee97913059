"""Read a triangle mesh that somebody brings: OBJ, PLY, STL, OFF or GLB, and what paints it.

trimesh reads all but OBJ. It likes to merge, split and reorder vertices on loading, and to open the
pictures and materials that a file names; here every vertex and triangle stays where the file has
it, because landmarks and animation caches count on their numbers. What paints an OBJ file is in
files beside it; see pictures.py.
"""

import io
import logging
import warnings
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from .errors import AssetError
from .glb_claims import pictures_apart
from .mesh_claims import CHECKS
from .pictures import Texture, libraries_missing, read_packed, texture_of
from .topology import unique_points
from .user_files import MOST_VERTICES, named, read_file
from .wavefront import read_obj

FORMATS = ("obj", "ply", "stl", "off", "glb")  # ends of names
MOST_BYTES = 100_000_000
FARTHEST = (
    1e9  # of a coordinate, in any unit: far beyond all meshes, and its cube is still a number
)

# What trimesh warns of is told by our one line, or does not concern the surface.
logging.getLogger("trimesh").addHandler(logging.NullHandler())


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
            content = CHECKS[suffix](content)
            if suffix == "glb":
                content, pictures = pictures_apart(content)
            pieces = _read_by_trimesh(content, suffix)
            vertices, faces = _joined(pieces)
            colours = _colours(pieces)
            if suffix == "glb":  # the only one of these that holds the pictures themselves
                texture = _texture(pieces, pictures)
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


def _read_by_trimesh(content: bytes, suffix: str) -> list[Any]:
    """The pieces of a mesh, in their places; AssetError for whatever trimesh may raise."""
    import trimesh  # half a second, needed by nothing else here

    try:
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            # numpy's way to say that a number is none, after which it would read no further
            warnings.filterwarnings("error", category=DeprecationWarning, message="string or file")
            scene = trimesh.load_scene(
                io.BytesIO(content),
                file_type=suffix,
                process=False,
                maintain_order=True,
                skip_materials=suffix != "glb",  # whose pictures were taken out
                fix_texture=False,
            )
            return [each for each in scene.dump() if hasattr(each, "faces")]
    except Exception as error:  # every reader of trimesh has its own kinds
        reason = " ".join(str(error).split())[:200]
        raise AssetError(
            f"broken, or not what its name says ({type(error).__name__}: {reason}); open it in a "
            "modelling program, triangulate it and save it anew"
        ) from None


def _joined(pieces: list[Any]) -> tuple[npt.NDArray[Any], npt.NDArray[Any]]:
    """Vertices and triangles of all pieces, one after the other."""
    starts = np.cumsum([0, *(len(each.vertices) for each in pieces)])
    faces = [each.faces.reshape(-1, 3) + start for each, start in zip(pieces, starts, strict=False)]
    vertices = [each.vertices for each in pieces]
    return np.vstack([np.zeros((0, 3)), *vertices]), np.vstack([np.zeros((0, 3), np.int64), *faces])


def _colours(pieces: list[Any]) -> npt.NDArray[np.uint8] | None:
    """The colours of all vertices; None where a piece has none."""
    if not pieces or any(each.visual.kind != "vertex" for each in pieces):
        return None
    found = [np.asarray(each.visual.vertex_colors)[:, :3] for each in pieces]
    return np.vstack(found).astype(np.uint8)


def _texture(pieces: list[Any], pictures: list[bytes | None]) -> Texture | None:
    """What pictures the pieces of a GLB file have, and where; None where there are none."""
    uv, picture, is_painted = [], [], False
    for each in pieces:
        material, found = -1, getattr(each.visual, "uv", None)
        if found is not None and len(found) == len(each.vertices):
            name = each.visual.material.name
            material = int(name) if pictures[int(name)] is not None else -1
        else:
            found = np.zeros((len(each.vertices), 2))
        uv.append(np.asarray(found, np.float32)[:, :2])
        picture.append(np.full(len(each.faces), material))
        is_painted |= material >= 0
    if not is_painted:
        return None
    readers = tuple(partial(read_packed, each) for each in pictures if each is not None)
    place = np.cumsum([each is not None for each in pictures]) - 1
    numbers = np.concatenate(picture)
    return Texture(
        np.vstack(uv),
        _joined(pieces)[1].astype(np.int32),
        np.where(numbers < 0, -1, place[numbers]),
        readers,
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
