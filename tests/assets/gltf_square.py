"""A square with a picture, as a glTF file."""

import io
from pathlib import Path
from typing import Any

import numpy as np
import PIL.Image

from risorius import assets
from risorius.assets.meshes import Mesh
from risorius.geometry.arrays import Floats64
from tests.assets.gltf_files import GltfMaker

SQUARE = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], np.float64)
FACES = np.array([[0, 1, 2], [0, 2, 3]])
UV = np.array([[0.125, 0.75], [0.5, 0.75], [0.5, 0.25], [0.125, 0.25]])  # v grows downward
UP_UV = UV * [1, -1] + [0, 1]
RED = (250, 10, 20)
GREEN = (10, 240, 30)


def png(colour: tuple[int, ...] = RED, form: str = "PNG") -> bytes:
    """The bytes of a picture with one colour."""
    content = io.BytesIO()
    PIL.Image.new("RGBA" if len(colour) == 4 else "RGB", (4, 4), colour).save(content, form)
    return content.getvalue()


def material(maker: GltfMaker, texture: dict[str, Any], **more: Any) -> int:
    """Add a material with a picture; return the material's number."""
    pbr = {"baseColorTexture": texture, **more}
    return maker.add("materials", {"pbrMetallicRoughness": pbr})


def read(maker: GltfMaker, folder: Path) -> Mesh:
    """Write the file, and read its mesh."""
    return assets.read_mesh(maker.write(folder / "a.glb"))


def shape_of(mesh: Mesh) -> Floats64:
    """The corners of the mesh's triangles, (F, 3, 3)."""
    return mesh.vertices[mesh.faces]


def uv_of(mesh: Mesh) -> Floats64:
    """Texture coordinates of the corners, (F, 3, 2)."""
    return mesh.texture.uv[mesh.texture.face_uv]


def show_square(maker: GltfMaker, attributes: dict[str, int] | None = None, **more: Any) -> None:
    """Add the square as the file's scene; more: other keys of its primitive."""
    square = maker.primitive(SQUARE, FACES, attributes=attributes or {}, **more)
    maker.shown({"mesh": maker.mesh(square)})


def painted(maker: GltfMaker, uv: int, texture: dict[str, Any] | None = None, **more: int) -> None:
    """Add a square with a picture."""
    number = material(maker, {"index": maker.picture(png()), **(texture or {})})
    show_square(maker, {"TEXCOORD_0": uv, **more}, material=number)
