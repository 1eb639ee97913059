"""Read a user's triangle mesh, OBJ, PLY, STL, OFF, glTF or GLB, and its paint.

Every vertex and triangle keeps its index in the file, because landmarks and animation caches
depend on it. trimesh reads STL and OFF; it may merge and reorder vertices, and from other formats
it omits or misreads data that heads have. pictures.py has the paint of OBJ.
"""

import contextlib
import io
import logging
import re
import warnings
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Self

import numpy as np
import numpy.typing as npt

from ..geometry.arrays import Flags, Floats64, Integers32, Integers64, Unsigned8
from ..geometry.numbering import numbered_by_first_use
from ..geometry.read_only import make_read_only
from .errors import AssetError
from .gltf import read_gltf
from .pictures import MeshPictures, texture_of
from .ply import read_ply
from .user_files import MOST_FILE_VERTICES, named, plain_text, read_file
from .wavefront import read_obj

MESH_FORMATS = ("obj", "ply", "stl", "off", "glb", "gltf")  # ends of names
# The greatest coordinate in any unit: far beyond any mesh, and its cube is still finite.
FARTHEST_COORDINATE = 1e9


@dataclass(frozen=True)
class Mesh:
    """A plain triangle mesh: the least that `sim.create` and `refine.create` need.

    - vertices: positions [unit of the file], shape (V, 3), float64.
    - faces: vertex indices, shape (F, 3), int32.
    - texture: texture of the file; None if the file has none.
    - colours: vertex colours, sRGB, shape (V, 3), uint8; None if the file has none.
    - has_colour: whether each vertex has a colour, shape (V,); None: all have.
    - same: for each vertex, the coinciding vertex that `faces` use instead, shape (V,).
    - corners: triangles with the vertex indices of the file, shape (F, 3), if some vertices
      coincide; None: equal to `faces`.
    - notes: lines with remarks for the user.
    """

    vertices: Floats64
    faces: Integers32
    texture: MeshPictures | None = None
    colours: Unsigned8 | None = None
    has_colour: Flags | None = None
    same: npt.NDArray[np.integer[Any]] | None = None
    corners: Integers32 | None = None
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        make_read_only(self)

    @property
    def file_corners(self) -> Integers32:
        """Triangles with the vertex indices of the file, even if vertices coincide, (F, 3)."""
        return self.faces if self.corners is None else self.corners

    @property
    def used_vertices(self) -> Integers64:
        """For each vertex of the file, the vertex that `faces` use for it, (V,)."""
        if self.same is None:
            return np.arange(len(self.vertices))
        return np.asarray(self.same, np.int64)

    def without(self, triangles: npt.NDArray[np.integer[Any]]) -> Self:
        """Return the mesh without the flagged triangles; vertices keep their indices."""
        left = np.delete(np.arange(len(self.faces)), triangles)
        texture = self.texture
        if texture is not None:
            texture = replace(texture, face_uv=texture.face_uv[left], picture=texture.picture[left])
        corners = None if self.corners is None else self.corners[left]
        return replace(self, faces=self.faces[left], corners=corners, texture=texture)


def read_mesh(path: str | Path) -> Mesh:
    """Read one triangle mesh; several in one file become one, polygons become triangles.

    STL has no vertex indices: there, corners in the same place become one vertex.

    Raises AssetError for a file that is missing, of an unknown format, too large, broken, or has no
    triangles.
    """
    suffix = Path(path).suffix.lower().lstrip(".")
    try:
        if suffix not in MESH_FORMATS:
            known = ", ".join(f".{name}" for name in MESH_FORMATS)
            cure = "unpack it" if suffix in ("gz", "zip") else "save the mesh as one of these"
            raise AssetError(f"its name must end in {known}: {cure}")
        most_megabytes = 100
        content = read_file(path, kind="mesh", most=most_megabytes)
        with _broken_files_named():
            mesh = _read(content, suffix, Path(path).parent)
        _check(mesh.vertices, mesh.faces)
    except AssetError as error:
        raise AssetError(f"{named(path)}: {error}") from None
    return mesh


def _read(content: bytes, suffix: str, folder: Path) -> Mesh:
    """Read the mesh in a file of a format. folder: the folder with further files that it names."""
    if suffix == "obj":
        surface = read_obj(content, most=MOST_FILE_VERTICES)
        texture, notes = texture_of(surface, folder)
        return Mesh(surface.vertices, _numbers(surface.faces), texture, notes=notes)
    if suffix == "ply":
        points = read_ply(content)
        return Mesh(points.vertices, _numbers(points.faces), colours=points.colours)
    if suffix in ("glb", "gltf"):
        shown = read_gltf(content, folder)
        return Mesh(
            vertices=shown.vertices,
            faces=_numbers(shown.faces),
            texture=shown.texture,
            colours=shown.colours,
            has_colour=shown.has_colour,
            same=shown.same,
            corners=_numbers(shown.corners),
        )
    vertices, faces = _read_by_trimesh(content, suffix)
    if suffix == "stl":
        vertices = vertices + 0.0  # no zero with a sign
        first, number = numbered_by_first_use(vertices)
        vertices = vertices[first]
        faces = number[faces]
    return Mesh(vertices, _numbers(faces))


def _numbers(faces: npt.NDArray[Any]) -> Integers32:
    """Vertex indices as 32-bit integers, clipped; larger ones are invalid in any mesh."""
    return faces.clip(-1, np.iinfo(np.int32).max).astype(np.int32)


@contextlib.contextmanager
def _broken_files_named() -> Iterator[None]:
    """Raise every error of a reader as an AssetError, because readers raise different kinds."""
    try:
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore")
            # numpy gives this warning at a broken number, and stops reading there
            warnings.filterwarnings("error", category=DeprecationWarning, message="string or file")
            yield
    except AssetError:
        raise
    except Exception as error:
        reason = " ".join(f"{type(error).__name__}: {error}".split())[-200:]
        raise AssetError(
            f"broken, or named as another format ({reason}); open it in a modelling program, "
            "triangulate it and save it anew"
        ) from None


def _check(vertices: npt.NDArray[Any], faces: npt.NDArray[Any]) -> None:
    """Raise AssetError unless there are triangles, between finite vertices within range."""
    if not len(faces):
        raise AssetError("holds no triangles; it must hold the surface of a head, as polygons")
    if max(len(faces), len(vertices)) > MOST_FILE_VERTICES:
        raise AssetError(
            f"has {len(vertices)} vertices and {len(faces)} triangles; allowed are "
            f"{MOST_FILE_VERTICES}: reduce it in a modelling program"
        )
    is_there = ((faces >= 0) & (faces < len(vertices))).all(axis=1)
    if not is_there.all():
        where = int(np.argmin(is_there))
        raise AssetError(
            f"triangle {where} (counted from 0) has the vertices {faces[where].tolist()}; "
            f"allowed are 0 to {len(vertices) - 1}: save the mesh anew"
        )
    is_near = (np.abs(vertices) <= FARTHEST_COORDINATE).all(axis=1)  # False for NaN
    if not is_near.all():
        where = int(np.argmin(is_near))
        raise AssetError(
            f"vertex {where} (counted from 0) is at {vertices[where].tolist()}; it must be finite "
            f"numbers up to {FARTHEST_COORDINATE:g}: remove it, or choose another unit"
        )


def _read_by_trimesh(content: bytes, suffix: str) -> tuple[Any, Any]:
    """Vertices and triangles of a file whose name ends in "stl" or "off"."""
    import trimesh  # imported late, so that loading a head is fast

    logging.getLogger("trimesh").disabled = True
    blank_lines = re.compile(rb"\n\s*\n")
    text = blank_lines.sub(b"\n", plain_text(content)) if b"\0" not in content else content
    scene: Any = trimesh.load_scene(
        io.BytesIO(text), file_type=suffix, process=False, maintain_order=True
    )
    pieces: list[Any] = [each for each in scene.dump() if hasattr(each, "faces")]
    vertices = [np.zeros((0, 3))]
    faces = [np.zeros((0, 3), np.int64)]
    count = 0
    for piece in pieces:
        vertices.append(piece.vertices)
        faces.append(piece.faces.reshape(-1, 3) + count)
        count += len(piece.vertices)
    return np.vstack(vertices), np.vstack(faces)
