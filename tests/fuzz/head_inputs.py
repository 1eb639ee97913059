"""Odd and broken heads: mesh files and landmark files, each with its expected result.

Only a few examples have headers with wrong sizes.
"""

import json
import os
from collections.abc import Callable
from enum import Enum
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import trimesh

from risorius import assets
from risorius.assets.fitting import FittedHead, fit_head
from risorius.assets.meshes import Mesh

HEAD = assets.load("head")
NUMBERS = HEAD.landmarks.tolist()
POINTS = HEAD.vertices[HEAD.landmarks].tolist()
HINDMOST_VERTEX = int(np.argmin(HEAD.vertices[:, 2]))
BROKEN_MESSAGE = "broken, or named as another format|holds no triangles"
WRONG_KIND = "all landmarks must be vertex indices, or all must be points"


class Kind(Enum):
    """The expected result of an input.

    A text instead of a Kind must occur in the one-line error.
    """

    MESH = "a mesh"
    HEAD = "a fitted head"


class HeadFiles(NamedTuple):
    """The files of one input; without landmarks only the mesh is read."""

    mesh: Path
    landmarks: Path | None = None


class OddHead(NamedTuple):
    """One odd or broken head."""

    name: str
    write: Callable[[Path], HeadFiles]
    expected: Kind | str


def open_head_files(brought: HeadFiles) -> Mesh | FittedHead:
    """Read, or fit, the written files as the command does."""
    if brought.landmarks is None:
        return assets.read_mesh(brought.mesh)
    return fit_head(brought.mesh, brought.landmarks)


VERTEX_LINES = "v 0 0 0\nv 1 0 0\nv 0 1 0\n"
TRIANGLE_FILE = f"{VERTEX_LINES}f 1 2 3\n"
VERTICES = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], np.float32)
FACES = np.array([[0, 1, 2], [0, 2, 3]], np.int32)
PLY_FILE = (
    "ply\nformat ascii 1.0\nelement vertex 4\n"
    "property float x\nproperty float y\nproperty float z\n"
    "element face 2\nproperty list uchar int vertex_indices\nend_header\n"
    "0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 1 2\n3 0 2 3\n"
)
BINARY_HEADER = (
    PLY_FILE.split("end_header\n")[0].replace("ascii", "binary_little_endian")
).encode()
BINARY_BODY = (
    b"end_header\n" + VERTICES.tobytes() + b"".join(b"\3" + face.tobytes() for face in FACES)
)
MESH_FILES: dict[str, tuple[bytes | str, Kind | str]] = {
    "latin-1.obj": (TRIANGLE_FILE.encode().replace(b"f 1", b"o t\xeate\ng a\xa0g\nf 1"), Kind.MESH),
    "utf-16.obj": (TRIANGLE_FILE.encode("utf-16"), Kind.MESH),
    "big polygon.obj": (VERTEX_LINES + "f" + " 1 2 3" * 10_000 + "\n", Kind.MESH),
    "unknown words.obj": (
        f"hello world\n{TRIANGLE_FILE}call a.obj\ncsh rm\nl 1 2\np 1\n",
        Kind.MESH,
    ),
    "device.obj": (
        f"mtllib /dev/zero\n{VERTEX_LINES}usemtl a\nf 1 2 3\n",
        "lie in the mesh's folder",
    ),
    "empty.obj": ("", "is empty; it must be a mesh file"),
    "picture.obj": (b"\x89PNG\r\n\x1a\n" + bytes(64), "binary data"),
    "cut.obj": (f"{VERTEX_LINES}f 1 2", "line 4: 'f 1 2' cannot be used; .*three or more"),
    "comma.obj": (TRIANGLE_FILE.replace("1 0 0", "1,5 0 0"), "line 2: 'v 1,5 0 0' cannot be used"),
    "long number.obj": (
        TRIANGLE_FILE.replace("1 0 0", "9" * 5000 + " 0 0"),
        "must be finite numbers",
    ),
    "corner beyond.obj": (f"{VERTEX_LINES}f 1 2 {10**30}\n", "line 4: 'f 1 2 1000"),
    "long line.obj": (VERTEX_LINES + "f" + " 1" * 600_000, "line 4: more than 500000 vertices or"),
    "many vertices.obj": (b"v 0 0 0\n" * 510_000, "line 500001: more than 500000 vertices or"),
    "gzip.obj": (b"\x1f\x8b\x08\x00" + bytes(40), "is compressed"),
    "binary cut.ply": (BINARY_HEADER + BINARY_BODY[:-3], BROKEN_MESSAGE),
    "many.ply": (
        BINARY_HEADER.replace(b"vertex 4", b"vertex 4000000000") + BINARY_BODY,
        "broken|MemoryError",
    ),
}


def _mesh(name: str, content: bytes | str, folder: Path) -> HeadFiles:
    path = folder / name.replace(" ", "_")
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return HeadFiles(path)


def _obj(where: Any = 0, to: Any = None, scale: float = 1.0, shift: float = 0.0) -> bytes:
    """The built-in head as an OBJ file, with some moved vertices."""
    vertices = HEAD.vertices * scale + shift
    if to is not None:
        vertices[where] = to
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in vertices.tolist()]
    lines += [f"f {a} {b} {c}" for a, b, c in (HEAD.faces + 1).tolist()]
    return "\n".join(lines).encode()


def _head(mesh: Callable[[], bytes], marks: Any, folder: Path) -> HeadFiles:
    """A mesh file, made by `write`, and a landmark file."""
    brought = HeadFiles(folder / "head.obj", folder / "head.json")
    brought.mesh.write_bytes(mesh())
    text = marks if isinstance(marks, bytes | str) else json.dumps(marks)
    (folder / "head.json").write_bytes(text if isinstance(text, bytes) else text.encode())
    return brought


def _with(entries: list[Any], place: int, entry: Any) -> list[Any]:
    return [*entries[:place], entry, *entries[place + 1 :]]


LANDMARK_FILES: dict[str, tuple[Any, Kind | str]] = {
    "numbers": ({"landmarks": NUMBERS}, Kind.HEAD),
    "points": ({"landmarks": POINTS}, Kind.HEAD),
    "utf-16": (json.dumps(NUMBERS).encode("utf-16"), Kind.HEAD),
    "cut": (json.dumps(NUMBERS)[:50], "not valid JSON: .*; it must be"),
    "deep": ("[" * 100_000, "not valid JSON: brackets are nested too deep"),
    "long": (json.dumps(NUMBERS) + " " * 1_000_000, "has 1 MB; a landmark file may have 1 MB"),
    "beyond": (_with(NUMBERS, 5, 10**7), "'landmark 5': was 10000000, must be a whole"),
    "null": ([None] * 68, "landmark 0 is null: 68 of 68 are not marked yet"),
    "mixed": (_with(POINTS, 67, 5), f"'landmark 67': was 5, .*{WRONG_KIND}"),
    "point at 1e8": (_with(POINTS, 8, [1e8, 0.0, 0.0]), "landmark 8 lies 1e.08 units off the mesh"),
    "mouth corners alike": (_with(NUMBERS, 54, NUMBERS[48]), "landmarks 48 and 54 are 0 mm apart"),
    "other order": (NUMBERS[::-1], "head.obj: (the landmarks form no face|left and right)"),
}
HEAD_FILES: dict[str, tuple[Callable[[], bytes], Kind | str]] = {
    "in micrometres": (partial(_obj, scale=1e3), Kind.HEAD),
    "far away": (partial(_obj, scale=1e-3, shift=1e7), Kind.HEAD),
    "no size": (partial(_obj, scale=1e-300), "landmarks lie within .*; allowed are 1e-09"),
    "vertex at 1e8": (
        partial(_obj, HINDMOST_VERTEX, 1e8),
        r"lies 1.73e\+05 m off the face; allowed",
    ),
}


def _truncated(path: Path, length: int) -> None:
    path.touch()
    os.truncate(path, length)


DAMAGED_PATHS: dict[str, tuple[Callable[[Path], object], str]] = {
    "missing": (lambda _: None, "no such {kind} file"),
    "folder": (Path.mkdir, "is a folder; it must be a {kind} file"),
    "pipe": (os.mkfifo, "is a pipe or a device; it must be a {kind} file"),
    "loop of links": (lambda path: path.symlink_to(path.name), "cannot be read: .*; choose"),
    "terabyte": (lambda path: _truncated(path, 10**12), "has 1e.06 MB; a {kind} file may have"),
}


def _at(make: Callable[[Path], object], name: str, folder: Path) -> HeadFiles:
    """Make an odd path in place of the mesh file, or in place of a good mesh's landmark file."""
    if name == "head.json":
        brought = _head(_obj, "", folder)
        (folder / name).unlink()
    else:
        brought = HeadFiles(folder / name)
    make(folder / name)
    return brought


def _exported(suffix: str, marks: Any, folder: Path) -> HeadFiles:
    """The built-in head as exported by trimesh."""
    brought = _head(lambda: b"", marks, folder)._replace(mesh=folder / f"head.{suffix}")
    trimesh.Trimesh(HEAD.vertices, HEAD.faces, process=False).export(brought.mesh)
    return brought


def head_inputs() -> list[OddHead]:
    """The whole table; names are unique."""
    table = []
    for name, (content, expected) in MESH_FILES.items():
        table.append(OddHead(f"a {name}", partial(_mesh, name, content), expected))
    for name, (marks, expected) in LANDMARK_FILES.items():
        table.append(OddHead(f"marks {name}", partial(_head, _obj, marks), expected))
    for name, (mesh, expected) in HEAD_FILES.items():
        table.append(OddHead(f"head {name}", partial(_head, mesh, NUMBERS), expected))
    for way, (make, message) in DAMAGED_PATHS.items():
        for name, kind in (("h.obj", "mesh"), ("h.glb", "mesh"), ("head.json", "landmark")):
            expected = message.format(kind=kind)
            table.append(OddHead(f"{way} as {name}", partial(_at, make, name), expected))
    for name in ("head", "head.obj.gz", "head.fbx", ".obj"):
        message = r"its name must end in \.obj, \.p"
        table.append(OddHead(f"called {name}", partial(_mesh, name, TRIANGLE_FILE), message))
    for name in ("HEAD.OBJ", "t\xeate.obj", "two\nlines.obj"):
        table.append(OddHead(f"called {name!r}", partial(_mesh, name, TRIANGLE_FILE), Kind.MESH))
    for suffix, marks in (("ply", NUMBERS), ("glb", NUMBERS), ("stl", POINTS)):
        table.append(OddHead(f"head.{suffix}", partial(_exported, suffix, marks), Kind.HEAD))
    return table
