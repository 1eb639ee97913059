"""Read the surface of a Wavefront OBJ file: its points and polygons, and nothing else.

trimesh's reader takes relative numbers for places from the end of the file, doubles vertices where
the texture has a seam or the material changes, and opens the files that the materials name. Here
`v` and `f` are read and the rest is left alone, so a vertex keeps its number and its neighbours.

Source: Wavefront Technologies, "Object Files (.obj)", Advanced Visualizer manual, appendix B1.
Differs from it: free-form surfaces are left away, as is the weight w of a vertex.
"""

from __future__ import annotations

import io
from array import array
from collections.abc import Iterator
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from .errors import AssetError
from .user_files import LONGEST_LINE, plain_text

EXCERPT = 30  # bytes of what is wrong in a line, at most


def read_obj(content: bytes, *, most: int) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.int64]]:
    """Vertices (V, 3) in the order of the file, and triangles (F, 3); polygons become fans.

    most: vertices and triangles that are allowed. Raises AssetError, which names the line.
    """
    coordinates, corners = array("d"), array("q")
    for number, fields in _statements(plain_text(content)):
        try:
            if fields[0] == b"v":
                coordinates.extend(_point(fields))
            else:
                _add_fan(corners, fields, len(coordinates) // 3)
            if max(len(coordinates), len(corners)) > 3 * most:
                raise AssetError(
                    f"more than {most} vertices or triangles; reduce it in a modelling program"
                )
        except AssetError as error:
            raise AssetError(f"line {number}: {error}") from None
    return (
        np.frombuffer(coordinates, np.float64).reshape(-1, 3),
        np.frombuffer(corners, np.int64).reshape(-1, 3),
    )


def _statements(text: bytes) -> Iterator[tuple[int, list[bytes]]]:
    """Number and fields of each line that tells a vertex or a face; a backslash joins lines."""
    parts: list[bytes] = []
    start = length = 0
    for number, line in enumerate(io.BytesIO(text), start=1):
        if not parts:
            if not line.lstrip(b" \t").startswith((b"v ", b"v\t", b"f ", b"f\t")):
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


def _add_fan(corners: array[int], fields: list[bytes], vertex_count: int) -> None:
    """Append the triangles of a polygon; numbers count from 1, or back from the last vertex."""
    if len(fields) < 4:
        raise AssetError(f"a face has {len(fields) - 1} corners; it must have at least 3")
    try:
        found = [int(word.split(b"/", 1)[0]) for word in fields[1:]]
    except ValueError:
        raise AssetError(
            f"'{_excerpt(fields)}' is no face; it must be 'f' and whole vertex numbers"
        ) from None
    for place, number in enumerate(found):
        if number == 0 or number < -vertex_count or number >= 2**31:
            back = f"-1 to -{vertex_count}" if vertex_count else "no number below 0"
            raise AssetError(
                f"no vertex has the number {fields[place + 1][:EXCERPT].decode()}; allowed are 1 "
                f"to the number of vertices, and {back} at this line"
            )
        found[place] = number - 1 if number > 0 else vertex_count + number
    first = found[0]
    for second, third in pairwise(found[1:]):
        corners.extend((first, second, third))


def _excerpt(fields: list[bytes]) -> str:
    line = b" ".join(fields[:8])
    return line.decode() if len(line) <= EXCERPT else line[:EXCERPT].decode() + " ..."
