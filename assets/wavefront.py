"""Read the surface of a Wavefront OBJ file: its points and polygons, and where its pictures lie.

trimesh's reader takes relative numbers for places from the end of the file, doubles vertices where
the texture has a seam or the material changes, and opens the files that the materials name. Here a
vertex keeps its number and its neighbours, and nothing is opened.

Source: Wavefront Technologies, "Object Files (.obj)", Advanced Visualizer manual, appendix B1.
Differs from it: free-form surfaces are left away, as is the weight w of a vertex.
"""

from __future__ import annotations

import io
import math
import re
from array import array
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from .errors import AssetError
from .user_files import plain_text

PLACING = ("-o", "-s", "-t")  # options of maps in a material library with up to three numbers
OPTIONS = {  # and how many words follow each, those included
    **dict.fromkeys(PLACING, 3),
    "-mm": 2,
    **dict.fromkeys(("-blendu", "-blendv", "-cc", "-clamp", "-texres", "-bm", "-boost"), 1),
    **dict.fromkeys(("-imfchan", "-type", "-colorspace"), 1),
}
_REMARKS = re.compile(rb"(?m)^[ \t]*#[^\n]*")
_CONTINUED = re.compile(rb"\\[ \t]*\n")


@dataclass(frozen=True)
class ObjSurface:
    """What an OBJ file says of a surface.

    vertices: shape (V, 3), in the order of the file. faces: shape (F, 3); polygons become fans.
    uv: texture coordinates, shape (U, 2). face_uv: their numbers, -1 for none, shape (F, 3).
    material: place in `materials` of each triangle, -1 for none, shape (F,).
    libraries: names of files that define materials.
    """

    vertices: npt.NDArray[np.float64]
    faces: npt.NDArray[np.int64]
    uv: npt.NDArray[np.float64]
    face_uv: npt.NDArray[np.int64]
    material: npt.NDArray[np.int64]
    materials: tuple[str, ...]
    libraries: tuple[str, ...]


def read_obj(content: bytes, *, most: int) -> ObjSurface:
    """The surface in a file.

    most: vertices and triangles that are allowed. Raises AssetError, which names the line.
    """
    coordinates = array("d")
    places = array("d")
    corners = array("q")
    corner_places = array("q")
    material = array("q")
    materials = dict[str, int]()
    libraries = list[str]()
    current = -1
    excerpt_length = 30  # bytes of a faulty line in a message
    for number, line in enumerate(io.BytesIO(_joined(content)), start=1):
        word, *fields = line.split(b"#", 1)[0].split() or [b""]
        try:
            if word == b"v":
                x, y, z = fields[:3]
                coordinates.extend((float(x), float(y), float(z)))
            elif word == b"vt":
                places.extend((float(fields[0]), float(fields[1]) if fields[1:] else 0.0))
            elif word == b"f":
                polygon = _polygon(fields, len(coordinates) // 3, len(places) // 2)
                for second, third in pairwise(polygon[1:]):
                    for vertex, place in (polygon[0], second, third):
                        corners.append(vertex)
                        corner_places.append(place)
                    material.append(current)
            elif word == b"usemtl":  # names may hold blanks and number signs
                current = materials.setdefault(_parted(line.decode())[1], len(materials))
            elif word == b"mtllib":
                libraries.append(_parted(line.decode())[1])
        except (ValueError, IndexError, OverflowError):
            shown = line[:excerpt_length].decode().strip()
            raise AssetError(
                f"line {number}: '{shown}' cannot be used; right are 'v x y z', 'vt u v', and 'f' "
                "with three or more vertex numbers, from 1 on, or from -1 back"
            ) from None
        if max(len(coordinates), len(corners), len(places)) > 3 * most:
            raise AssetError(
                f"line {number}: more than {most} vertices or triangles; reduce it in a modelling "
                "program"
            )
    return ObjSurface(
        np.frombuffer(coordinates, np.float64).reshape(-1, 3),
        np.frombuffer(corners, np.int64).reshape(-1, 3),
        np.frombuffer(places, np.float64).reshape(-1, 2),
        np.frombuffer(corner_places, np.int64).reshape(-1, 3),
        np.frombuffer(material, np.int64),
        tuple(materials),
        tuple(libraries),
    )


def _polygon(fields: list[bytes], vertices: int, places: int) -> list[tuple[int, int]]:
    """Each corner's numbers of its vertex and, -1 for none, of its texture coordinates.

    In the file they count from 1, or back from the last of so many. Raises ValueError for others.
    """
    if len(fields) < 3:
        raise ValueError
    polygon = []
    for field in fields:
        vertex, place = (int(part or 0) for part in (*field.split(b"/"), b"")[:2])
        if not vertex or vertex < -vertices:
            raise ValueError
        vertex = vertex - 1 if vertex > 0 else vertices + vertex
        place = place - 1 if place >= 0 else max(places + place, -1)
        polygon.append((vertex, place))
    return polygon


@dataclass(frozen=True, order=True)
class Placing:
    """How a picture lies in texture coordinates.

    scale, offset: of coordinates along u and v, in this order. is_clamped: whether the picture's
    edge goes on beyond it; else it repeats.
    """

    scale: tuple[float, float] = (1.0, 1.0)
    offset: tuple[float, float] = (0.0, 0.0)
    is_clamped: bool = False

    def placed(self, uv: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        """Texture coordinates (U, 2) of the file in this picture."""
        placed = uv * self.scale + self.offset
        return placed.clip(0.0, 1.0) if self.is_clamped else placed


@dataclass(frozen=True, order=True)
class MaterialPicture:
    """The picture of a material's colour: the name of its file, and how it lies."""

    name: str
    placing: Placing


def pictures_of(content: bytes) -> dict[str, MaterialPicture]:
    """The pictures of colour in a material library (MTL), by material."""
    pictures = {}
    material = ""
    for line in _joined(content).decode().split("\n"):
        word, rest = _parted(line)
        if word == "newmtl":
            material = rest
        elif word.lower() == "map_kd" and rest:
            pictures[material] = _picture_of(rest)
    return pictures


def _picture_of(rest: str) -> MaterialPicture:
    """The picture of a map: options, and then a name, which may hold blanks and be quoted."""
    values: dict[str, list[str]] = {}
    option, after = _parted(rest)
    while option in OPTIONS and after:
        rest = after
        values[option] = []
        for _ in range(OPTIONS[option]):
            value, after = _parted(rest)
            if not after or (option in PLACING and not _is_number(value)):
                break  # of three numbers two may be missing, and the last word is the name
            values[option].append(value)
            rest = after
        option, after = _parted(rest)
    is_quoted = len(rest) > 2 and rest[0] == rest[-1] == '"'
    placing = Placing(
        _along_u_and_v(values.get("-s", []), 1.0),
        _along_u_and_v(values.get("-o", []), 0.0),
        values.get("-clamp") == ["on"],
    )
    return MaterialPicture(rest[1:-1] if is_quoted else rest, placing)


def _along_u_and_v(values: list[str], default: float) -> tuple[float, float]:
    """The first two of some numbers."""
    u = float(values[0]) if values else default
    v = float(values[1]) if len(values) > 1 else default
    return u, v


def _is_number(word: str) -> bool:
    try:
        return math.isfinite(float(word))
    except ValueError:
        return False


def _parted(line: str) -> tuple[str, str]:
    """The first word of a line and the rest of it, without blanks and tabs around."""
    words = [*line.split(maxsplit=1), "", ""]
    return words[0], words[1].strip()


def _joined(content: bytes) -> bytes:
    """Plain text in which a backslash at the end of a line joins it with the next.

    A remark ends with its line: a path in it may end in a backslash.
    """
    text = _REMARKS.sub(b"", plain_text(content))
    return _CONTINUED.sub(b" ", text)
