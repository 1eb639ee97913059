"""Paths of heads that lead to no file, to no end, to far too much, or elsewhere."""

from __future__ import annotations

import os
import zlib
from collections.abc import Callable
from functools import partial
from pathlib import Path

from .head_inputs import Brought, Kind, OddHead
from .head_landmarks import head_obj
from .head_obj import TRIANGLE

TEXTURED = f"mtllib a.mtl\n{TRIANGLE.replace('f 1', 'usemtl a' + chr(10) + 'f 1')}"
MATERIAL = "newmtl a\nmap_Kd big.png\n"


def _pipe(path: Path) -> None:
    os.mkfifo(path)


def _loop(path: Path) -> None:
    path.symlink_to(path.name)


def _nothing(path: Path) -> None:
    """No file at all."""


def _sparse(length: int, start: bytes = b"") -> Callable[[Path], None]:
    def write(path: Path) -> None:
        path.write_bytes(start)
        os.truncate(path, length)

    return write


def _device(path: Path) -> None:
    path.symlink_to("/dev/zero")


def _bomb(path: Path) -> None:
    """20 MB of zeros, packed, as a zip file begins."""
    path.write_bytes(b"PK\x03\x04" + zlib.compress(bytes(20_000_000)))


WAYS: dict[str, tuple[Callable[[Path], None], str]] = {
    "missing": (_nothing, "no such {kind} file"),
    "folder": (Path.mkdir, "is a folder; it must be a {kind} file"),
    "pipe": (_pipe, "is a pipe; it must be a {kind} file"),
    "device": (_device, "is a device; it must be a {kind} file"),
    "loop of links": (_loop, "cannot be read: .*; choose another {kind} file"),
    "too long": (_sparse(200_000_000), "has 200 MB; a {kind} file may have .* MB: "),
    "terabyte": (_sparse(10**12), "has 1e.03 GB|has 1000 GB"),
    "zip bomb": (_bomb, r"is packed \(zip\); unpack it"),
}


def _mesh_at(make: Callable[[Path], None], suffix: str, folder: Path) -> Brought:
    path = folder / f"head.{suffix}"
    make(path)
    return Brought(path)


def _landmarks_at(make: Callable[[Path], None], folder: Path) -> Brought:
    brought = Brought(folder / "head.obj", folder / "head.json")
    brought.mesh.write_bytes(head_obj())
    make(folder / "head.json")
    return brought


def _named(name: str, folder: Path) -> Brought:
    (folder / name).write_text(TRIANGLE)
    return Brought(folder / name)


def _with_material(make: Callable[[Path], None], folder: Path) -> Brought:
    """An OBJ file whose materials or picture are odd: they are not to be opened."""
    (folder / "a.obj").write_text(TEXTURED)
    make(folder)
    return Brought(folder / "a.obj")


def _big_image(folder: Path) -> None:
    from PIL import Image

    (folder / "a.mtl").write_text(MATERIAL)
    Image.new("1", (12_000, 12_000)).save(folder / "big.png")


def _table() -> list[OddHead]:
    rows = []
    for name, (make, says) in WAYS.items():
        told = says.format(kind="mesh")
        for suffix in ("obj", "ply", "stl", "off", "glb"):
            write = partial(_mesh_at, make, suffix)
            rows.append(OddHead(f"{name} as {suffix}", write, Kind.REFUSED, told))
        told = says.format(kind="landmark")
        rows.append(
            OddHead(f"{name} as landmarks", partial(_landmarks_at, make), Kind.REFUSED, told)
        )
    for name in ("head", "head.zip", "head.obj.gz", "head.gltf", "head.fbx", "head.json", ".obj"):
        says = r"its name must end in \.obj, \.ply"
        rows.append(OddHead(f"called {name}", partial(_named, name), Kind.REFUSED, says))
    for name in ("HEAD.OBJ", "t\xeate.obj", "two\nlines.obj", "a.b.obj"):
        rows.append(OddHead(f"called {name!r}", partial(_named, name), Kind.MESH))
    rows.append(
        OddHead("picture of 12000", partial(_with_material, _big_image), Kind.MESH),
    )
    pipe = partial(_with_material, lambda folder: os.mkfifo(folder / "a.mtl"))
    rows.append(OddHead("material is a pipe", pipe, Kind.REFUSED, "is a pipe; it must be a"))
    return rows


INPUTS: tuple[OddHead, ...] = tuple(_table())
