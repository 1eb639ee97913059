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
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from .errors import AssetError
from .user_files import plain_text

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
    material, materials, libraries = array("q"), dict[str, int](), list[str]()
    current = -1
    text = plain_text(content).replace(b"\\\n", b" ")  # a backslash joins lines
    for number, line in enumerate(io.BytesIO(text), start=1):
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
            elif word == b"usemtl":
                current = materials.setdefault(b" ".join(fields).decode(), len(materials))
            elif word == b"mtllib":
                libraries.append(b" ".join(fields).decode())
        except (ValueError, IndexError, OverflowError):
            shown = line[:EXCERPT].decode().strip()
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
