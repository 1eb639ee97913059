"""Read a triangle mesh that somebody brings: OBJ, PLY, STL, OFF or GLB, and what paints it.

trimesh reads all but OBJ. It likes to merge and reorder vertices on loading, and to open the
pictures and materials that a file names; here every vertex and triangle stays where the file has
it, because landmarks and animation caches count on their numbers. What paints OBJ: pictures.py.
"""

import io
import logging
import re
import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from .errors import AssetError
from .pictures import Texture, shrunk, texture_of
from .topology import unique_points
from .user_files import MOST_VERTICES, named, plain_text, read_file
from .wavefront import read_obj

FORMATS = ("obj", "ply", "stl", "off", "glb")  # ends of names
MOST_MEGABYTES = 100
FARTHEST = 1e9  # of a coordinate, in any unit: far beyond all, and its cube is still a number
PACKED = re.compile(  # in which ways trimesh reads no positions
    rb'"extensionsRequired"[^]]*"(KHR_draco_mesh_compression|EXT_meshopt_compression)"'
)
_BLANK_LINES = re.compile(rb"\n\s*\n")


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
            cure = "unpack it" if suffix in ("gz", "zip") else "save the mesh as one of these"
            raise AssetError(f"its name must end in {known}: {cure}")
        content = read_file(path, kind="mesh", most=MOST_MEGABYTES)
        same, colours, notes = None, None, tuple[str, ...]()
        if suffix == "obj":
            surface = read_obj(content, most=MOST_VERTICES)
            vertices, faces = surface.vertices, surface.faces
            texture, notes = texture_of(surface, Path(path).parent)
        else:
            vertices, faces, texture, colours = _read(content, suffix)
        if suffix == "stl":
            vertices = vertices + 0.0  # no zero with a sign
            first, number = unique_points(vertices)
            vertices, faces = vertices[first], number[faces]
        _check(vertices, faces)
        if suffix == "glb" and texture is not None:  # its vertices are doubled along seams
            first, number = unique_points(vertices + 0.0)
            same = first[number]
            faces = same[faces]
    except AssetError as error:
        raise AssetError(f"{named(path)}: {error}") from None
    numbers = faces.astype(np.int32)
    return Mesh(vertices.astype(np.float64), numbers, texture, colours, same, notes)


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


def _read(content: bytes, suffix: str) -> tuple[Any, Any, Texture | None, Any]:
    """Vertices, triangles and what paints them of a file for trimesh; AssetError where it fails.

    suffix: the end of its name, "ply", "stl", "off" or "glb".
    """
    import trimesh  # which to load a head takes no time for

    if packed := PACKED.search(content) if suffix == "glb" else None:
        raise AssetError(f"is compressed ({packed[1].decode()}); export it without compression")
    logging.getLogger("trimesh").disabled = True
    try:
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore")
            # numpy's way to say that a number is none, after which it would read no further
            warnings.filterwarnings("error", category=DeprecationWarning, message="string or file")
            scene: Any = trimesh.load_scene(
                io.BytesIO(_plain(content, suffix)),
                file_type=suffix,
                process=False,
                maintain_order=True,
                skip_materials=suffix != "glb",
                fix_texture=False,
            )
            pieces: list[Any] = [each for each in scene.dump() if hasattr(each, "faces")]
            starts = np.cumsum([0, *(len(each.vertices) for each in pieces)])
            faces = [each.faces.reshape(-1, 3) + n for each, n in zip(pieces, starts, strict=False)]
            joined = np.vstack([np.zeros((0, 3), np.int64), *faces])
            texture, colours = _texture_of(pieces, joined) if suffix == "glb" else None, None
            if pieces and all(each.visual.kind == "vertex" for each in pieces):
                every = [np.asarray(each.visual.vertex_colors)[:, :3] for each in pieces]
                colours = np.vstack(every).astype(np.uint8)
    except Exception as error:  # every reader of trimesh has its own kinds
        reason = " ".join(f"{type(error).__name__}: {error}".split())[-200:]
        raise AssetError(
            f"broken, or not what its name says ({reason}); open it in a modelling program, "
            "triangulate it and save it anew"
        ) from None
    vertices = np.vstack([np.zeros((0, 3)), *(each.vertices for each in pieces)])
    return vertices, joined, texture, colours


def _texture_of(pieces: list[Any], faces: npt.NDArray[np.int64]) -> Texture | None:
    """How the pieces of a GLB file are painted, `faces` those of all; None where they are not."""
    uv, pictures, number = list[Any](), dict[int, npt.NDArray[np.uint8]](), list[Any]()
    for each in pieces:
        found = getattr(each.visual, "uv", None)
        picture = getattr(getattr(each.visual, "material", None), "baseColorTexture", None)
        at, places = -1, np.zeros((len(each.vertices), 2))
        if picture is not None and found is not None and len(found) == len(each.vertices):
            image = shrunk(picture)
            key = hash(image.tobytes())  # each piece has a copy of its own
            pictures.setdefault(key, image)
            at, places = [*pictures].index(key), found[:, :2]
        uv.append(places)
        number.append(np.full(len(each.faces), at))
    if not pictures:
        return None
    return Texture(
        np.vstack(uv).astype(np.float32),
        faces.astype(np.int32),
        np.concatenate(number),
        tuple(pictures.values()),
    )


def _plain(content: bytes, suffix: str) -> bytes:
    """The same with its text as ASCII and without blank lines, over which trimesh would stumble."""
    if suffix == "ply":
        head, mark, body = content.partition(b"end_header")
        return plain_text(head) + mark + (body if b"binary" in head else _lines(body))
    is_text = suffix != "glb" and b"\0" not in content  # else STL of bytes
    return _lines(content) if is_text else content


def _lines(text: bytes) -> bytes:
    return _BLANK_LINES.sub(b"\n", plain_text(text))
