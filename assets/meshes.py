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
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from .errors import AssetError
from .mesh_claims import CHECKS
from .pictures import Texture, texture_of
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
    """

    vertices: npt.NDArray[np.float64]
    faces: npt.NDArray[np.int32]
    texture: Texture | None = None
    colours: npt.NDArray[np.uint8] | None = None


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
        if suffix == "obj":
            surface = read_obj(content, most=MOST_VERTICES)
            vertices, faces = surface.vertices, surface.faces
            texture = texture_of(surface, Path(path).parent)
        else:
            vertices, faces, colours = _read_by_trimesh(CHECKS[suffix](content), suffix)
        if suffix == "stl":
            vertices = vertices + 0.0  # no zero with a sign
            first, number = unique_points(vertices)
            vertices, faces = vertices[first], number[faces]
        _check(vertices, faces)
    except AssetError as error:
        raise AssetError(f"{named(path)}: {error}") from None
    return Mesh(vertices.astype(np.float64), faces.astype(np.int32), texture, colours)


def _read_by_trimesh(
    content: bytes, suffix: str
) -> tuple[npt.NDArray[Any], npt.NDArray[Any], npt.NDArray[np.uint8] | None]:
    """Vertices, triangles, and colours if all have one; AssetError for whatever trimesh raises."""
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
                skip_materials=True,
                fix_texture=False,
            )
            mesh = scene.to_mesh() if len(scene.geometry) else None
    except Exception as error:  # every reader of trimesh has its own kinds
        reason = " ".join(str(error).split())[:200]
        raise AssetError(
            f"broken, or not what its name says ({type(error).__name__}: {reason}); open it in a "
            "modelling program, triangulate it and save it anew"
        ) from None
    if mesh is None:
        return np.zeros((0, 3)), np.zeros((0, 3), np.int64), None
    vertices, colours = np.array(mesh.vertices), None
    if suffix in ("ply", "glb") and mesh.visual.kind == "vertex":
        found = np.asarray(mesh.visual.vertex_colors)
        if found.shape == (len(vertices), 4) and found.dtype == np.uint8:
            colours = found[:, :3].copy()
    return vertices, np.array(mesh.faces), colours


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
