"""Check the vertices in files of avatars, and measure the errors of sums of shapes.

The heads are the built-in head and a made person, and optionally MakeHuman's base mesh and a scan.
Each head becomes an avatar, as with `risorius rig`, and the avatar's file is read again. All 68
landmarks of each head are also guessed from six true ones.
"""

from __future__ import annotations

import json
import tempfile
import time
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from risorius.app.errors import UserError
from risorius.app.performances import built_in_words
from risorius.app.recordings.names import ARKIT_SHAPES
from risorius.app.rig.avatar import Avatar, RigRequest, avatar_of
from risorius.app.rig.gltf_copy import read_document
from risorius.app.rig.linearity import Difference
from risorius.app.rig.surface import METRES_PER_MILLIMETRE
from risorius.app.rig.writing import avatar_glb
from risorius.app.scenes import fit_users_head
from risorius.assets.fitting import FittedHead
from risorius.assets.fitting.landmark_file import read_landmarks
from risorius.assets.identities import person_called
from risorius.assets.meshes import Mesh, read_mesh

from .guesses import Guess, guessed, lines_of
from .report import Target, at_least, processor, table
from .subjects import Scans

Points = npt.NDArray[np.floating]
PERSON_NUMBER = 7


class HeadFile(NamedTuple):
    """The mesh file of a head, and the file of its landmarks."""

    name: str
    mesh: Path
    landmarks: Path


class AvatarRow(NamedTuple):
    """One avatar.

    vertices: number in the head's file, or in its skin if it has no file. in_place: number of these
    vertices that have the same index and position in the avatar. shapes: number of ARKit's names in
    Apple's order. guess: the guess of the head's landmarks.
    """

    name: str
    vertices: int
    in_place: int
    shapes: int
    megabytes: float
    seconds: float
    sums: tuple[Difference, ...]
    guess: Guess


def makehuman(folder: Path) -> HeadFile:
    """MakeHuman's base mesh from a folder; raises UserError if it is missing."""
    head = HeadFile("MakeHuman hm08", folder / "base.obj", folder / "base.json")
    for path in (head.mesh, head.landmarks):
        if not path.is_file():
            raise UserError(f"{path}: is not there; the folder needs base.obj and base.json")
    return head


def scan(scans: Scans, folder: Path) -> HeadFile:
    """Write the neutral face of scans into a folder, as a mesh file and a landmark file."""
    head = HeadFile("ICT-FaceKit", folder / "scan.obj", folder / "scan.json")
    lines = [f"v {x:.9g} {y:.9g} {z:.9g}" for x, y, z in scans.mesh.vertices]
    lines += [f"f {a} {b} {c}" for a, b, c in scans.mesh.faces + 1]
    head.mesh.write_text("\n".join(lines), encoding="utf-8")
    landmarks = json.dumps({"landmarks": scans.landmarks.tolist()})
    head.landmarks.write_text(landmarks, encoding="utf-8")
    return head


def measure(folder: Path | None, reference: Path | None) -> Iterator[AvatarRow]:
    """Make an avatar of each head, one after the other.

    folder: holds MakeHuman's base mesh. reference: holds scans. A head whose folder is None is left
    out.
    """
    avatar_of(None, _request(), _quiet)  # compilation is not timed
    yield measured(None)
    yield measured(person_called(PERSON_NUMBER), f"person {PERSON_NUMBER}")
    if folder is not None:
        yield measured_file(makehuman(folder))
    if reference is not None:
        with tempfile.TemporaryDirectory() as scratch:
            yield measured_file(scan(Scans.read(reference), Path(scratch)))


def measured(head: FittedHead | None, name: str = "built-in") -> AvatarRow:
    """Measure the avatar of the built-in head or a person."""
    begin = time.perf_counter()
    avatar = avatar_of(head, _request(), _quiet)
    content = avatar_glb(avatar, name)
    seconds = time.perf_counter() - begin
    points, names = mesh_called("skin", content)
    # At seams of texture coordinates, a vertex is followed by its copies.
    is_copy = (np.diff(points, axis=0) == 0.0).all(axis=1)
    points = points[~np.append(False, is_copy)]
    scene = avatar.scene
    rest = scene.rest_positions
    guess = guessed(name, Mesh(rest, scene.faces), rest[scene.landmarks])
    return _row(guess, METRES_PER_MILLIMETRE * rest, points, names, content, seconds, avatar)


def measured_file(head: HeadFile) -> AvatarRow:
    """Measure the avatar of a head from a file."""
    begin = time.perf_counter()
    avatar = avatar_of(fit_users_head(head.mesh, head.landmarks), _request(), _quiet)
    content = avatar_glb(avatar, head.name)
    seconds = time.perf_counter() - begin
    points, names = mesh_called("head", content)
    mesh = read_mesh(head.mesh)
    indices, landmark_points = read_landmarks(head.landmarks, mesh)
    guess = guessed(
        head.name, mesh, mesh.vertices[indices] if landmark_points is None else landmark_points
    )
    return _row(guess, mesh.vertices, points, names, content, seconds, avatar)


def _row(
    guess: Guess,
    own: Points,
    points: Points,
    names: Sequence[str],
    content: bytes,
    seconds: float,
    avatar: Avatar,
) -> AvatarRow:
    shapes = sum(found == expected for found, expected in zip(names, ARKIT_SHAPES, strict=False))
    count = in_place(own, points)
    size = len(content) / 1e6
    return AvatarRow(
        name=guess.name,
        vertices=len(own),
        in_place=count,
        shapes=shapes,
        megabytes=size,
        seconds=seconds,
        sums=avatar.sums,
        guess=guess,
    )


def in_place(own: Points, points: Points) -> int:
    """Number of a file's vertices (V, 3) that have the same index in an avatar's mesh (n, 3)."""
    count = min(len(own), len(points))
    same = own[:count].astype(np.float32) == points[:count].astype(np.float32)
    return int(same.all(axis=1).sum())


def mesh_called(name: str, content: bytes) -> tuple[Points, list[str]]:
    """The vertices of a mesh of a binary glTF file, (n, 3), and the names of its shapes."""
    document, numbers = read_document(content, Path())
    mesh: dict[str, Any] = next(each for each in document["meshes"] if each["name"] == name)
    attributes = mesh["primitives"][0]["attributes"]
    accessor = document["accessors"][attributes["POSITION"]]
    view = document["bufferViews"][accessor["bufferView"]]
    start = view["byteOffset"]
    points = np.frombuffer(numbers, np.float32, 3 * accessor["count"], start)
    return points.reshape(-1, 3), list(mesh["extras"]["targetNames"])


def _request() -> RigRequest:
    return RigRequest(progress=False, take=built_in_words())


def _quiet(_: str) -> None:
    """Ignore progress lines."""


def report(rows: Sequence[AvatarRow], guesses: Sequence[Guess] = ()) -> str:
    """The text to print. guesses: landmark guesses of further heads."""
    files = [
        (row.name, row.vertices, row.in_place, row.shapes, row.megabytes, row.seconds)
        for row in rows
    ]
    sums = [
        (row.name, f" {' + '.join(each.names)}", each.most, each.mean)
        for row in rows
        for each in row.sums
    ]
    return "\n".join(
        [
            "Heads as avatars with ARKit's shapes, as `risorius rig` writes them.",
            f"Processor: {processor()}",
            "",
            *table("head:<15|vertices:8d|in place:8d|shapes:6d|MB:6.1f|seconds:7.1f", files),
            "",
            "Sums of shapes against the simulation [mm]: pairs at 1, and a take.",
            "",
            *table("head:<15| sum:<46|at most:7.1f|RMS:5.1f", sums),
            "",
            *lines_of([*(row.guess for row in rows), *guesses]),
        ]
    )


def targets(rows: Sequence[AvatarRow]) -> list[Target]:
    """The targets: all vertices in place, and all names."""
    found = []
    for row in rows:
        found.append(at_least(f"{row.name}, vertices in place", row.in_place, row.vertices))
        found.append(at_least(f"{row.name}, names", row.shapes, len(ARKIT_SHAPES)))
    return found
