"""Read the surface of a Wavefront OBJ file: points, polygons, and the layout of its pictures.

trimesh's reader counts relative indices from the end of the file, doubles vertices where the
texture has a seam or the material changes, and opens the files that materials name. Here a vertex
keeps its index and its neighbours, and no other file is opened.

Source: Wavefront Technologies, "Object Files (.obj)", Advanced Visualizer manual, appendix B1.
Differs from it: free-form surfaces are left out, and so is the weight w of a vertex.
"""

from __future__ import annotations

import io
import math
import re
from array import array
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from ..geometry.arrays import Floats64, Integers64
from .errors import AssetError
from .user_files import named, text_with_names

# Options of maps in a material library with up to three numbers.
PLACING_OPTIONS = ("-o", "-s", "-t")


@dataclass(frozen=True)
class ObjSurface:
    """The surface that an OBJ file describes.

    vertices: shape (V, 3), in the order of the file. faces: shape (F, 3); polygons become fans.
    uv: texture coordinates, shape (U, 2). face_uv: their indices, -1 for none, shape (F, 3).
    normals: as in the file, shape (N, 3). face_normals: their indices, -1 for none, shape (F, 3).
    material: index into `materials` of each triangle, -1 for none, shape (F,).
    libraries: names of files that define materials.
    part: index into `parts`, the names of objects and groups, of each triangle, -1 for none, (F,).
    """

    vertices: Floats64
    faces: Integers64
    uv: Floats64
    face_uv: Integers64
    normals: Floats64
    face_normals: Integers64
    material: Integers64
    materials: tuple[str, ...]
    libraries: tuple[str, ...]
    part: Integers64
    parts: tuple[str, ...]


def read_obj(content: bytes, *, most: int) -> ObjSurface:
    """The surface in a file.

    most: largest allowed number of vertices and of triangles. Raises AssetError, which names the
    line.
    """
    coordinates = array("d")
    places = array("d")
    normals = array("d")
    corners = array("q")  # vertex, texture coordinates and normal of each corner
    labels = array("q")  # material and part of each triangle
    materials: dict[str, int] = {}
    libraries: list[str] = []
    parts: dict[str, int] = {}
    current = [-1, -1]  # material and part
    for number, line in enumerate(io.BytesIO(joined_lines(content)), start=1):
        word, *fields = line.split(b"#", 1)[0].split() or [b""]
        try:
            if word == b"v":
                x, y, z = fields[:3]
                coordinates.extend((float(x), float(y), float(z)))
            elif word == b"vt":
                places.extend((float(fields[0]), float(fields[1]) if fields[1:] else 0.0))
            elif word == b"vn":
                x, y, z = fields[:3]
                normals.extend((float(x), float(y), float(z)))
            elif word == b"f":
                counts = (len(coordinates) // 3, len(places) // 2, len(normals) // 3)
                polygon = _polygon(fields, counts)
                for second, third in pairwise(polygon[1:]):
                    for corner in (polygon[0], second, third):
                        corners.extend(corner)
                    labels.extend(current)
            elif word == b"usemtl":  # names may hold blanks and number signs
                current[0] = materials.setdefault(_first_word(line.decode())[1], len(materials))
            elif word in (b"o", b"g"):
                current[1] = parts.setdefault(_first_word(line.decode())[1], len(parts))
            elif word == b"mtllib":
                libraries.append(_first_word(line.decode())[1])
        except (ValueError, IndexError, OverflowError):
            raise _error_about_line(number, line) from None
        if max(len(coordinates), len(normals), len(corners) // 3, len(places)) > 3 * most:
            raise AssetError(
                f"line {number}: more than {most} vertices or triangles; reduce it in a modelling "
                "program"
            )
    numbers = np.frombuffer(corners, np.int64).reshape(-1, 3, 3)
    return ObjSurface(
        vertices=np.frombuffer(coordinates, np.float64).reshape(-1, 3),
        faces=np.ascontiguousarray(numbers[:, :, 0]),
        uv=np.frombuffer(places, np.float64).reshape(-1, 2),
        face_uv=np.ascontiguousarray(numbers[:, :, 1]),
        normals=np.frombuffer(normals, np.float64).reshape(-1, 3),
        face_normals=np.ascontiguousarray(numbers[:, :, 2]),
        material=np.frombuffer(labels, np.int64)[::2],
        materials=tuple(materials),
        libraries=tuple(libraries),
        part=np.frombuffer(labels, np.int64)[1::2],
        parts=tuple(parts),
    )


def _error_about_line(number: int, line: bytes) -> AssetError:
    """The error about a line, with its number."""
    excerpt_length = 30  # bytes
    shown = line[:excerpt_length].decode(errors="ignore").strip()
    return AssetError(
        f"line {number}: '{named(shown)}' cannot be used; allowed are 'v x y z', 'vt u v', and 'f' "
        "with three or more vertex indices, from 1 on, or from -1 back"
    )


def _polygon(fields: list[bytes], counts: tuple[int, int, int]) -> list[tuple[int, int, int]]:
    """For each corner, the indices of its vertex, texture coordinates and normal; -1 for none.

    counts: how many of each the file has defined so far. The file counts from 1, or from the last
    defined entry backwards. Raises ValueError for other indices.
    """
    if len(fields) < 3:
        raise ValueError
    polygon = []
    for field in fields:
        written = [*field.split(b"/"), b"", b""][:3]
        vertex, place, normal = (int(part or 0) for part in written)
        if not vertex or vertex < -counts[0]:
            raise ValueError
        vertex = vertex - 1 if vertex > 0 else counts[0] + vertex
        polygon.append(
            (vertex, _optional_index(place, counts[1]), _optional_index(normal, counts[2]))
        )
    return polygon


def _optional_index(number: int, count: int) -> int:
    """The index of texture coordinates or of a normal, from 0; -1 for none."""
    return number - 1 if number >= 0 else max(count + number, -1)


@dataclass(frozen=True, order=True)
class Placing:
    """Position and size of a picture in texture coordinates.

    scale, offset: for coordinates along u and v, in this order. is_clamped: whether the picture's
    edge continues beyond it; else the picture repeats.
    """

    scale: tuple[float, float] = (1.0, 1.0)
    offset: tuple[float, float] = (0.0, 0.0)
    is_clamped: bool = False

    def placed(self, uv: Floats64) -> Floats64:
        """The file's texture coordinates (U, 2), converted to this picture's."""
        placed = uv * self.scale + self.offset
        return placed.clip(0.0, 1.0) if self.is_clamped else placed


@dataclass(frozen=True)
class MaterialLook:
    """Colour of a material in linear light, 0 to 1, and its opacity."""

    colour: tuple[float, float, float] = (1.0, 1.0, 1.0)
    opacity: float = 1.0


def looks_of(content: bytes) -> dict[str, MaterialLook]:
    """The colours and opacities in a material library (MTL), by material; invalid ones are 1."""
    looks: dict[str, MaterialLook] = {}
    material = ""
    for line in joined_lines(content).decode().split("\n"):
        word, rest = _first_word(line)
        numbers = [float(each) for each in rest.split() if _is_number(each)]
        look = looks.get(material, MaterialLook())
        if word == "newmtl":
            material = rest
            looks[material] = MaterialLook()
        elif word == "Kd" and len(numbers) >= 3:
            red, green, blue = (_fraction(each) for each in numbers[:3])
            looks[material] = replace(look, colour=(red, green, blue))
        elif word == "d" and numbers:
            looks[material] = replace(look, opacity=_fraction(numbers[-1]))
    return looks


def _fraction(value: float) -> float:
    """Bound a number to 0 to 1."""
    return min(max(value, 0.0), 1.0)


@dataclass(frozen=True, order=True)
class MaterialPicture:
    """The picture of a material's colour: the name of its file, and its place."""

    name: str
    placing: Placing


def pictures_of(content: bytes) -> dict[str, MaterialPicture]:
    """The colour pictures in a material library (MTL), by material."""
    pictures = {}
    material = ""
    for line in joined_lines(content).decode().split("\n"):
        word, rest = _first_word(line)
        if word == "newmtl":
            material = rest
        elif word.lower() == "map_kd" and rest:
            pictures[material] = _picture_of(rest)
    return pictures


def maps_of(content: bytes) -> list[str]:
    """The names of all picture files in a material library (MTL), including bumps and gloss."""
    kinds = ("map_", "bump", "disp", "decal", "refl", "norm")
    names = []
    for line in joined_lines(content).decode().split("\n"):
        word, rest = _first_word(line)
        if word.lower().startswith(kinds) and rest:
            names.append(_picture_of(rest).name)
    return names


def _picture_of(rest: str) -> MaterialPicture:
    """The picture of a map: options, and then a name, which may hold blanks and be quoted."""
    values: dict[str, list[str]] = {}
    option, after = _first_word(rest)
    option_words = {  # numbers of words after each option, including these
        **dict.fromkeys(PLACING_OPTIONS, 3),
        "-mm": 2,
        **dict.fromkeys(("-blendu", "-blendv", "-cc", "-clamp", "-texres", "-bm", "-boost"), 1),
        **dict.fromkeys(("-imfchan", "-type", "-colorspace"), 1),
    }
    while option in option_words and after:
        rest = after
        values[option] = []
        for _ in range(option_words[option]):
            value, after = _first_word(rest)
            if not after or (option in PLACING_OPTIONS and not _is_number(value)):
                break  # two of three numbers may be missing, and the last word is the name
            values[option].append(value)
            rest = after
        option, after = _first_word(rest)
    is_quoted = len(rest) > 2 and rest[0] == rest[-1] == '"'
    placing = Placing(
        _along_u_and_v(values.get("-s", []), 1.0),
        _along_u_and_v(values.get("-o", []), 0.0),
        values.get("-clamp") == ["on"],
    )
    return MaterialPicture(rest[1:-1] if is_quoted else rest, placing)


def _along_u_and_v(values: list[str], default: float) -> tuple[float, float]:
    """Read the two numbers of an option; `default` replaces a missing number."""
    u = float(values[0]) if values else default
    v = float(values[1]) if len(values) > 1 else default
    return u, v


def _is_number(word: str) -> bool:
    try:
        return math.isfinite(float(word))
    except ValueError:
        return False


def _first_word(line: str) -> tuple[str, str]:
    """The first word of a line, and the rest, without surrounding blanks and tabs.

    Other blanks, such as Japanese ones, belong to names.
    """
    word, *rest = re.split(r"[ \t\r\n]+", line.strip(" \t\r\n"), maxsplit=1)
    return word, rest[0] if rest else ""


def joined_lines(content: bytes) -> bytes:
    """Join each line that ends in a backslash to the next line; text: see `text_with_names`.

    Comment lines are never joined, because a path in a comment may end in a backslash.
    """
    remarks = re.compile(rb"(?m)^[ \t]*#[^\n]*")
    text = remarks.sub(b"", text_with_names(content))
    continued = re.compile(rb"\\[ \t]*\n")
    return continued.sub(b" ", text)
