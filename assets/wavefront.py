"""Read the surface of a Wavefront OBJ file: its points and polygons, and where its pictures lie.

trimesh's reader takes relative numbers for places from the end of the file, doubles vertices where
the texture has a seam or the material changes, and opens the files that the materials name. Here a
vertex keeps its number and its neighbours, and nothing is opened.

Source: Wavefront Technologies, "Object Files (.obj)", Advanced Visualizer manual, appendix B1.
Differs from it: free-form surfaces are left away, as is the weight w of a vertex.
"""

from __future__ import annotations

import io
from array import array
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from .errors import AssetError
from .user_files import LONGEST_LINE, plain_text

READ = ([b"v"], [b"vt"], [b"f"], [b"usemtl"], [b"mtllib"])  # how lines begin that are read
EXCERPT = 30  # bytes of what is wrong in a line, at most


@dataclass(frozen=True)
class ObjSurface:
    """What an OBJ file says of a surface.

    vertices: shape (V, 3), in the order of the file. faces: shape (F, 3); polygons become fans.
    uv: texture coordinates, shape (U, 2). face_uv: their numbers, -1 for none, shape (F, 3).
    material: place in `materials` of each triangle, -1 for none, shape (F,).
    libraries: names of files that tell of materials.
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
    coordinates, places, corners, corner_places = array("d"), array("d"), array("q"), array("q")
    material, numbers, libraries = array("q"), dict[bytes, int](), []
    current = -1
    for number, fields in _statements(plain_text(content)):
        try:
            if fields[0] == b"v":
                coordinates.extend(_point(fields))
            elif fields[0] == b"vt":
                places.extend(_place(fields))
            elif fields[0] == b"f":
                count = len(corners)
                _add_fan(corners, _corners(fields, 0, "vertex", len(coordinates) // 3))
                _add_fan(corner_places, _corners(fields, 1, "vt", len(places) // 2))
                material.extend([current] * ((len(corners) - count) // 3))
            elif fields[0] == b"usemtl":
                current = numbers.setdefault(_name(fields), len(numbers))
            else:
                libraries.append(_name(fields))
            if max(len(coordinates), len(corners), len(places)) > 3 * most:
                raise AssetError(
                    f"more than {most} vertices or triangles; reduce it in a modelling program"
                )
        except AssetError as error:
            raise AssetError(f"line {number}: {error}") from None
    return ObjSurface(
        np.frombuffer(coordinates, np.float64).reshape(-1, 3),
        np.frombuffer(corners, np.int64).reshape(-1, 3),
        np.frombuffer(places, np.float64).reshape(-1, 2),
        np.frombuffer(corner_places, np.int64).reshape(-1, 3),
        np.frombuffer(material, np.int64),
        tuple(name.decode() for name in numbers),
        tuple(name.decode() for name in libraries),
    )


def pictures_of(content: bytes) -> dict[str, str]:
    """The names of pictures of colour in a material library (MTL), by material."""
    pictures, material = {}, ""
    for line in plain_text(content).decode().split("\n"):
        word, _, rest = line.strip().partition(" ")
        if word == "newmtl":
            material = rest.strip()
        elif word == "map_Kd":  # options begin with -; then nothing tells where they end
            pictures[material] = rest.split()[-1] if rest.startswith("-") else rest.strip()
    return pictures


def _statements(text: bytes) -> Iterator[tuple[int, list[bytes]]]:
    """Number and fields of each line that is read; a backslash joins lines."""
    parts: list[bytes] = []
    start = length = 0
    for number, line in enumerate(io.BytesIO(text), start=1):
        if not parts:
            if line.split(maxsplit=1)[:1] not in READ:
                continue
            start, length = number, 0
        line = line.split(b"#", 1)[0].rstrip()
        length += len(line)
        if length > LONGEST_LINE:
            raise AssetError(
                f"line {start} has more than {LONGEST_LINE} bytes with what continues it; cut its "
                "polygon into triangles"
            )
        parts.append(line.removesuffix(b"\\"))
        if not line.endswith(b"\\"):
            yield start, b" ".join(parts).split()
            parts = []
    if parts:
        yield start, b" ".join(parts).split()


def _point(fields: list[bytes]) -> tuple[float, float, float]:
    if len(fields) < 4:
        raise AssetError(f"a vertex has {len(fields) - 1} coordinates; it must have 3")
    try:
        return float(fields[1]), float(fields[2]), float(fields[3])
    except ValueError:
        raise AssetError(f"'{_excerpt(fields)}' is no vertex; it must be 'v x y z'") from None


def _place(fields: list[bytes]) -> tuple[float, float]:
    try:
        return float(fields[1]), float(fields[2]) if len(fields) > 2 else 0.0
    except (IndexError, ValueError):
        raise AssetError(f"'{_excerpt(fields)}' is no place; it must be 'vt u v'") from None


def _name(fields: list[bytes]) -> bytes:
    return b" ".join(fields[1:])


def _corners(fields: list[bytes], part: int, what: str, count: int) -> list[int]:
    """Numbers of a polygon's corners: its vertices (0), or their texture coordinates (1).

    In the file they count from 1, or back from the last one; -1 here where there is none.
    """
    if len(fields) < 4:
        raise AssetError(f"a face has {len(fields) - 1} corners; it must have at least 3")
    try:
        words = [word.split(b"/")[part : part + 1] for word in fields[1:]]
        found = [int(word[0]) if word and word[0] else None for word in words]
        if part == 0 and None in found:
            raise ValueError
        return [-1 if number is None else _counted(number, what, count) for number in found]
    except (AssetError, ValueError) as error:
        if part > 0:
            return [-1] * (len(fields) - 1)  # who needs the form alone loses nothing
        if isinstance(error, AssetError):
            raise
        raise AssetError(
            f"'{_excerpt(fields)}' is no face; it must be 'f' and whole vertex numbers"
        ) from None


def _counted(number: int, what: str, count: int) -> int:
    if number == 0 or number < -count or number >= 2**31:
        back = f"-1 to -{count}" if count else "no number below 0"
        raise AssetError(
            f"no {what} has the number {str(number)[:EXCERPT]}; allowed are 1 to the number of "
            f"{'vertices' if what == 'vertex' else what}, and {back} at this line"
        )
    return number - 1 if number > 0 else count + number


def _add_fan(corners: array[int], polygon: list[int]) -> None:
    """Append the triangles of a polygon."""
    first = polygon[0]
    for second, third in pairwise(polygon[1:]):
        corners.extend((first, second, third))


def _excerpt(fields: list[bytes]) -> str:
    line = b" ".join(fields[:8])
    return line.decode() if len(line) <= EXCERPT else line[:EXCERPT].decode() + " ..."
