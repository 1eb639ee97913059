"""Odd and broken PLY, STL, OFF and GLB files."""

from __future__ import annotations

import json
import struct
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import trimesh

from .head_inputs import Brought, Kind, OddHead, mesh_file
from .head_landmarks import HEAD, NUMBERS, POINTS

BROKEN = "broken, or not what its name says|holds no triangles"

VERTICES = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], np.float32)
FACES = np.array([[0, 1, 2], [0, 2, 3]], np.int32)

PLY = """ply
format ascii 1.0
element vertex 4
property float x
property float y
property float z
element face 2
property list uchar int vertex_indices
end_header
0 0 0
1 0 0
0 1 0
0 0 1
3 0 1 2
3 0 2 3
"""
BINARY = PLY.split("end_header\n")[0].replace("ascii", "binary_little_endian") + "end_header\n"
BODY = VERTICES.tobytes() + b"".join(b"\3" + face.tobytes() for face in FACES)
BIG = BINARY.replace("little", "big").encode() + (
    VERTICES.astype(">f4").tobytes() + b"".join(b"\3" + f.astype(">i4").tobytes() for f in FACES)
)
MIXED = VERTICES.tobytes() + b"\3" + FACES[0].tobytes() + b"\4" + struct.pack("<4i", 0, 1, 2, 3)

PLY_GOOD: dict[str, bytes | str] = {
    "text": PLY,
    "text latin-1": PLY.encode().replace(b"1.0\n", b"1.0\ncomment t\xeate\n"),
    "text mixed polygons": PLY.replace("3 0 2 3", "4 0 1 2 3"),
    "binary": BINARY.encode() + BODY,
    "binary latin-1": BINARY.encode().replace(b"1.0\n", b"1.0\ncomment t\xeate\n") + BODY,
    "big endian": BIG,
    "texture is a device": PLY.replace("1.0\n", "1.0\ncomment TextureFile /dev/zero\n"),
}

PLY_BAD: dict[str, tuple[bytes | str, str]] = {
    "one byte": ("p", BROKEN),
    "no end": (PLY.split("end_header", maxsplit=1)[0], BROKEN),
    "cut binary": (BINARY.encode() + BODY[:-3], "broken, or not what its name says"),
    "binary longer": (BINARY.encode() + BODY + b"x", "broken, or not what its name says"),
    "binary mixed": (BINARY.encode() + MIXED, "broken, .*triangulate it"),
    "property of nothing": (
        BINARY.replace("element vertex 4\n", ""),
        "broken, or not what its name",
    ),
    "no faces": (PLY.replace("face 2", "face 0"), "holds no triangles"),
    "nan": (PLY.replace("1 0 0", "nan 0 0"), "must be finite numbers"),
    "beyond": (PLY.replace("3 0 2 3", "3 0 2 9"), r"\[0, 2, 9\]; there are 0 to 3"),
    "before": (PLY.replace("3 0 2 3", "3 0 2 -1"), r"\[0, 2, -1\]; there are 0 to 3"),
    "list of 255": (BINARY.encode() + BODY.replace(b"\3", b"\xff"), "broken, or not what"),
}

STL = "".join(
    "facet normal 0 0 1\nouter loop\n"
    + "".join(f"vertex {x} {y} {z}\n" for x, y, z in VERTICES[face])
    + "endloop\nendfacet\n"
    for face in FACES
)


def stl_of(corners: Any, count: int | None = None, start: bytes = b"") -> bytes:
    """A binary STL file of triangles (F, 3, 3)."""
    rows = [bytes(12) + np.asarray(c, "<f4").tobytes() + bytes(2) for c in corners]
    head = start.ljust(80, b"\0") + struct.pack("<I", len(rows) if count is None else count)
    return head + b"".join(rows)


STL_GOOD: dict[str, bytes | str] = {
    "text": f"solid a\n{STL}endsolid a\n",
    "text latin-1": f"solid t\xeate\n{STL}endsolid\n".encode("latin-1"),
    "text upper case": f"solid a\n{STL}endsolid a\n".upper(),
    "binary": stl_of(VERTICES[FACES]),
    "binary that says solid": stl_of(VERTICES[FACES], start=b"solid t\xeate"),
}
STL_BAD: dict[str, tuple[bytes | str, str]] = {
    "text cut": (f"solid a\n{STL}", BROKEN),
    "text without facets": ("solid a\nendsolid a\n", "holds no triangles"),
    "text word": (f"solid a\n{STL}endsolid".replace("1.0", "one"), "broken, or not what its name"),
    "text flat": (f"solid a\n{STL}endsolid".replace(" 0.0\n", "\n"), "broken, or not what|finite"),
    "text nan": (f"solid a\n{STL}endsolid".replace("1.0", "nan"), "must be finite numbers"),
    "end first": ("endsolid\nsolid\n" + STL, "broken, or not what its name says|no triangles"),
}

OFF = "OFF\n4 2 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 1 2\n3 0 2 3\n"
OFF_GOOD: dict[str, bytes | str] = {
    "plain": OFF,
    "latin-1 remarks": b"# t\xeate\n" + OFF.encode().replace(b"0 0 0", b"\n0 0 0 # \xe9"),
    "colours": OFF.replace("OFF", "COFF").replace("0 0 0", "0 0 0 1 1 1 1"),
    "polygon": OFF.replace("3 0 2 3", "4 0 1 2 3"),
}
OFF_BAD: dict[str, tuple[bytes | str, str]] = {
    "no counts": ("OFF\n", BROKEN),
    "beyond": (OFF.replace("3 0 2 3", "3 0 2 4"), "broken, .*outside|there are 0 to 3"),
    "word": (OFF.replace("1 0 0", "one 0 0"), "broken, or not what its name says"),
    "infinity": (OFF.replace("1 0 0", "inf 0 0"), "must be finite numbers"),
    "no faces": (OFF.replace("4 2", "4 0"), "broken, or not what|holds no triangles"),
}


def glb(changes: Any = None, *, data: bytes | None = None, text: str | None = None) -> bytes:
    """A GLB file of two triangles; `changes`: keys of its JSON part with other values."""
    body = VERTICES.tobytes() + FACES.astype("<u4").tobytes() if data is None else data
    document: dict[str, Any] = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5125, "count": 6, "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteOffset": 0, "byteLength": 48},
            {"buffer": 0, "byteOffset": 48, "byteLength": 24},
        ],
        "buffers": [{"byteLength": len(body)}],
    }
    document.update(changes or {})
    part = (json.dumps(document) if text is None else text).encode()
    part += b" " * (-len(part) % 4)
    length = 28 + len(part) + len(body)
    head = b"glTF" + struct.pack("<II", 2, length) + struct.pack("<I4s", len(part), b"JSON")
    return head + part + struct.pack("<I4s", len(body), b"BIN\0") + body


PIECE = {"attributes": {"POSITION": 0}, "indices": 1}
VIEW = {"buffer": 0, "byteLength": 48}
FLOATS = {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"}
WHOLE = {"bufferView": 1, "componentType": 5125, "count": 6, "type": "SCALAR"}

GLB_GOOD = {
    "plain": glb(),
    "turned": glb({"nodes": [{"mesh": 0, "rotation": [0, 0, 0.70710678, 0.70710678]}]}),
    "circle of nodes": glb({"nodes": [{"mesh": 0, "children": [1]}, {"children": [0]}]}),
    "picture elsewhere": glb(
        {
            "images": [{"uri": "/dev/zero"}],
            "textures": [{"source": 0}],
            "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
            "meshes": [{"primitives": [{**PIECE, "material": 0}]}],
        }
    ),
}
GLB_BAD = {
    "one byte": (b"g", BROKEN),
    "obj inside": (b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", BROKEN),
    "version 1": (glb().replace(b"glTF\2", b"glTF\1"), BROKEN),
    "node of no number": (glb({"scenes": [{"nodes": [9]}]}), "broken, or not what its name says"),
    "negative count": (
        glb({"accessors": [{**FLOATS, "count": -4}, WHOLE]}),
        "broken|there are 0 to -1",
    ),
    "much of nothing": (
        glb({"accessors": [{"componentType": 5126, "count": 2**30, "type": "VEC3"}, WHOLE]}),
        "MemoryError",
    ),
    "view beyond": (glb({"bufferViews": [{**VIEW, "byteOffset": 999}, VIEW]}), "broken, or not"),
    "draco": (glb({"extensionsRequired": ["KHR_draco_mesh_compression"]}), "is compressed"),
    "nothing": (glb({"meshes": [], "nodes": [], "scenes": [{}]}), "holds no triangles|broken"),
    "points alone": (
        glb({"meshes": [{"primitives": [{**PIECE, "mode": 0}]}]}),
        "no triangles|bro",
    ),
    "corner beyond": (
        glb(data=VERTICES.tobytes() + struct.pack("<6I", 0, 1, 2, 0, 2, 2**32 - 1)),
        "there are 0 to 3|broken",
    ),
    "nan": (glb(data=(VERTICES * np.nan).tobytes() + FACES.tobytes()), "must be finite numbers"),
    "matrix of nan": (
        glb({"nodes": [{"mesh": 0, "matrix": [float("nan")] * 16}]}),
        "finite|broken",
    ),
    "matrix of 1e300": (
        glb({"nodes": [{"mesh": 0, "scale": [1e300] * 3}]}),
        "finite|broken",
    ),
}


def fitted(suffix: str, marks: list[Any], folder: Path) -> Brought:
    """The built-in head in a format, and its landmarks."""
    brought = Brought(folder / f"head.{suffix}", folder / "head.json")
    trimesh.Trimesh(HEAD.vertices, HEAD.faces, process=False).export(brought.mesh)
    (folder / "head.json").write_text(json.dumps(marks))
    return brought


def _table() -> list[OddHead]:
    rows = [
        OddHead(f"head.{suffix}", partial(fitted, suffix, marks), Kind.HEAD)
        for suffix, marks in (("ply", NUMBERS), ("off", NUMBERS), ("glb", NUMBERS), ("stl", POINTS))
    ]
    for suffix, good, bad in (
        ("ply", PLY_GOOD, PLY_BAD),
        ("stl", STL_GOOD, STL_BAD),
        ("off", OFF_GOOD, OFF_BAD),
        ("glb", GLB_GOOD, GLB_BAD),
    ):
        rows += [mesh_file(f"{name}.{suffix}", content) for name, content in good.items()]
        rows += [mesh_file(f"bad/{name}.{suffix}", *row) for name, row in bad.items()]
    return rows


INPUTS: tuple[OddHead, ...] = tuple(_table())
