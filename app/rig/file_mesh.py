"""Write the mesh of a file, such as OBJ or PLY, as glTF, and keep the order of its vertices.

A vertex with several texture coordinates or normals becomes several vertices in glTF. The first of
them keeps the number; the others come after the last vertex of the file. Coordinates are copied,
and the root node converts them to metres, y up. Polygons are written as triangles.
"""

from __future__ import annotations

import io
from dataclasses import dataclass
from typing import Any

import numpy as np

from risorius.assets.fitting.warp import Similarity
from risorius.assets.painted import Material, PaintedMesh
from risorius.assets.pictures import decoded
from risorius.geometry.arrays import Flags, Floats32, Floats64, Integers
from risorius.geometry.colour import to_linear
from risorius.geometry.directions import unit_vectors

from .bodies import Shaped
from .glb import ARRAY_BUFFER, ELEMENT_ARRAY_BUFFER, Glb, picture_kind
from .surface import METRES_PER_MILLIMETRE

# Usual units of files [mm], and the greatest factor between a face's size and the usual size.
UNIT_LENGTHS = (1.0, 10.0, 25.4, 100.0, 304.8, 1000.0)
UNIT_TOLERANCE = 1.25
CLAMP_TO_EDGE = 33071
LARGEST_SHORT = 65535  # greatest number of 16 bits, which glTF forbids as a vertex index


@dataclass(frozen=True)
class SplitVertices:
    """The n glTF vertices of a file; the first V are the vertices of the file.

    vertex: vertex index in the file, (n,).
    uv: row of the texture coordinates, or -1, (n,).
    normal: row of the normal, or -1, (n,).
    corners: glTF vertices of the triangles, (F, 3).
    """

    vertex: Integers
    uv: Integers
    normal: Integers
    corners: Integers


def split_vertices(painted: PaintedMesh) -> SplitVertices:
    """Split vertices whose texture coordinates or normals differ."""
    mesh = painted.mesh
    count = len(mesh.vertices)
    corners = np.column_stack(
        [mesh.faces.ravel(), painted.face_uv.ravel(), painted.face_normals.ravel()]
    )
    found, number = np.unique(corners, axis=0, return_inverse=True)
    is_first = np.diff(found[:, 0], prepend=-1) > 0
    slot = np.where(is_first, found[:, 0], count - 1 + np.cumsum(~is_first))
    total = count + np.count_nonzero(~is_first)
    vertex = np.arange(total)
    uv = np.full(total, -1)
    normal = np.full(total, -1)
    vertex[slot] = found[:, 0]
    uv[slot] = found[:, 1]
    normal[slot] = found[:, 2]
    return SplitVertices(vertex, uv, normal, slot[number.reshape(-1, 3)])


class FileMeshWriter:
    """Adds the mesh of a file to a glTF file."""

    def __init__(
        self, glb: Glb, painted: PaintedMesh, to_millimetres: Similarity, shaped: Shaped
    ) -> None:
        self._glb = glb
        self._painted = painted
        self._shaped = shaped
        self._split = split_vertices(painted)
        self._to_file = to_millimetres.inverse
        self._materials: dict[int, int] = {}

    def add(self, names: tuple[str, ...], chosen: Flags) -> int:
        """Add the mesh with those triangles whose flag in `chosen` (F,) is set; return its index.

        names: names of the shapes.
        """
        attributes = self._attributes()
        targets = self._targets()
        more = {"targets": targets} if targets else {}
        primitives = self._primitives(attributes, self._split.corners[chosen], chosen, more)
        mesh: dict[str, Any] = {"name": self._shaped.body.name, "primitives": primitives}
        if targets:
            mesh["weights"] = [0.0] * len(targets)
            mesh["extras"] = {"targetNames": list(names)}
        return self._glb.add("meshes", mesh)

    def add_rigid(self, name: str, chosen: Flags, pivot: Floats64) -> int:
        """Add a mesh without shapes of the triangles whose flag in `chosen` (F,) is set.

        pivot: origin of the mesh, in the file's coordinates, (3,). Returns the mesh's index.
        """
        split = self._split
        corners = split.corners[chosen]
        used, number = np.unique(corners, return_inverse=True)
        normals = self._painted_normals()[used]
        points = self._painted.mesh.vertices[split.vertex[used]] - pivot
        attributes = {
            "POSITION": self._glb.accessor(_singles(points), ARRAY_BUFFER, is_bounded=True),
            "NORMAL": self._glb.accessor(_singles(normals), ARRAY_BUFFER),
        }
        attributes.update(self._paint(used))
        primitives = self._primitives(attributes, number.reshape(-1, 3), chosen, {})
        return self._glb.add("meshes", {"name": name, "primitives": primitives})

    def _primitives(
        self,
        attributes: dict[str, int],
        corners: Integers,
        chosen: Flags,
        more: dict[str, Any],
    ) -> list[dict[str, Any]]:
        """Make a primitive for each material of the n chosen triangles; corners: (n, 3)."""
        short = np.uint16 if corners.max(initial=0) < LARGEST_SHORT else np.uint32
        materials = self._painted.material[chosen]
        primitives = []
        for material in np.unique(materials):
            indices = corners[materials == material].astype(short).ravel()
            number = self._glb.accessor(indices, ELEMENT_ARRAY_BUFFER)
            own = {"indices": number, "material": self._material(int(material)), **more}
            primitives.append({"attributes": attributes, **own})
        return primitives

    def _attributes(self) -> dict[str, int]:
        """Add the vertices at rest: positions, normals, texture coordinates and colours."""
        split = self._split
        points = self._painted.mesh.vertices[split.vertex]
        return {
            "POSITION": self._glb.accessor(_singles(points), ARRAY_BUFFER, is_bounded=True),
            "NORMAL": self._glb.accessor(_singles(self._painted_normals()), ARRAY_BUFFER),
            **self._paint(np.arange(len(split.vertex))),
        }

    def _painted_normals(self) -> Floats64:
        """Return unit normals at rest, (n, 3); they are smooth where the file has none."""
        split = self._split
        normals = (self._shaped.normals @ self._to_file.rotation.T)[split.vertex]
        has_own = split.normal >= 0
        if has_own.any():
            own = self._painted.normals[split.normal[has_own]]
            length = np.linalg.norm(own, axis=1, keepdims=True)
            own_unit = own / np.maximum(length, 1e-6)
            normals[has_own] = np.where(length > 1e-6, own_unit, normals[has_own])
        length = np.linalg.norm(normals, axis=1)
        normals[length < 0.5] = (0.0, 0.0, 1.0)  # for vertices without a triangle
        return unit_vectors(normals)

    def _paint(self, chosen: Integers) -> dict[str, int]:
        """Add texture coordinates and colours of some glTF vertices, if the file has any."""
        painted = self._painted
        split = self._split
        found = {}
        if len(painted.uv):
            uv = painted.uv[np.maximum(split.uv[chosen], 0)]
            uv[split.uv[chosen] < 0] = 0.0
            top_down = np.column_stack([uv[:, 0], 1.0 - uv[:, 1]])
            found["TEXCOORD_0"] = self._glb.accessor(_singles(top_down), ARRAY_BUFFER)
        if painted.mesh.colours is not None:
            colours = to_linear(painted.mesh.colours[split.vertex[chosen]] / 255.0)
            found["COLOR_0"] = self._glb.accessor(_singles(colours), ARRAY_BUFFER)
        return found

    def _targets(self) -> list[dict[str, int]]:
        """Add the shapes, in the file's unit and axes."""
        vertex = self._split.vertex
        turn = self._to_file.rotation.astype(np.float32)
        scale = np.float32(self._to_file.scale)
        return [
            {
                "POSITION": self._glb.sparse((scale * (moved @ turn.T))[vertex]),
                "NORMAL": self._glb.sparse((bent @ turn.T)[vertex]),
            }
            for moved, bent in zip(self._shaped.targets, self._shaped.bends, strict=True)
        ]

    def _material(self, number: int) -> int:
        """Add a material of the file to the glTF file; return its index there, -1 for none."""
        if number not in self._materials:
            rough: dict[str, Any] = {"metallicFactor": 0.0, "roughnessFactor": 0.6}
            material: dict[str, Any] = {"name": "skin", "pbrMetallicRoughness": rough}
            material["doubleSided"] = True
            if number >= 0:
                self._write_appearance(self._painted.materials[number], material)
            self._materials[number] = self._glb.add("materials", material)
        return self._materials[number]

    def _write_appearance(self, source: Material, material: dict[str, Any]) -> None:
        """Write colour, opacity and texture of a file's material into a glTF material."""
        rough = material["pbrMetallicRoughness"]
        material["name"] = source.name
        if source.look.opacity < 1.0:
            material["alphaMode"] = "BLEND"
        rough["baseColorFactor"] = [*source.look.colour, source.look.opacity]
        if source.picture is None:
            return
        # Colours beside a texture are ignored, because some old programs write black.
        rough["baseColorFactor"] = [1.0, 1.0, 1.0, source.look.opacity]
        content, name = source.picture
        kind = picture_kind(content)
        if kind not in ("png", "jpeg"):
            file = io.BytesIO()
            import PIL.Image

            PIL.Image.fromarray(decoded(content, name)).save(file, "png")
            content = file.getvalue()
            kind = "png"
        texture: dict[str, Any] = {"source": self._glb.image(content, kind)}
        if source.placing.is_clamped:
            clamped = {"wrapS": CLAMP_TO_EDGE, "wrapT": CLAMP_TO_EDGE}
            texture["sampler"] = self._glb.add("samplers", clamped)
        info: dict[str, Any] = {"index": self._glb.add("textures", texture)}
        scale = source.placing.scale
        offset = source.placing.offset
        if scale != (1.0, 1.0) or offset != (0.0, 0.0):
            # In the file, v points up.
            down = 1.0 - scale[1] - offset[1]
            placing = {"scale": list(scale), "offset": [offset[0], down]}
            info["extensions"] = {"KHR_texture_transform": placing}
            self._glb.use("KHR_texture_transform")
        rough["baseColorTexture"] = info


def root_matrix(to_millimetres: Similarity) -> Floats64:
    """Return the matrix (4, 4) from coordinates of a file to metres, y up, face along z.

    Axes are rotated by right angles only. A usual unit near the measured unit replaces it.
    """
    rotation = to_millimetres.rotation
    axes = np.zeros((3, 3))
    axes[np.abs(rotation).argmax(axis=0), np.arange(3)] = 1.0
    axes *= np.sign(rotation)
    is_turn = abs(np.linalg.det(axes)) > 0.5
    unit = unit_of(to_millimetres.scale)
    matrix = np.eye(4)
    matrix[:3, :3] = METRES_PER_MILLIMETRE * unit * (axes if is_turn else rotation)
    return matrix


def unit_of(scale: float) -> float:
    """Return the unit of a file [mm]; scale: the unit for which a face has the usual size [mm]."""
    unit = min(UNIT_LENGTHS, key=lambda each: abs(np.log(scale / each)))
    return unit if max(scale / unit, unit / scale) < UNIT_TOLERANCE else scale


def _singles(values: Floats64) -> Floats32:
    return values.astype(np.float32)
