"""A head for fitting: the built-in head made finer, with another shape, unit and orientation."""

import json
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from risorius import assets
from risorius.assets.identities import Person, make_person, sample_identity
from risorius.assets.meshes import Mesh
from risorius.geometry.arrays import Floats64, Integers32
from risorius.geometry.sides import sides_of

TURN_MATRIX = np.array([[-1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]])  # z up, facing y
METRES_PER_MILLIMETRE = 0.001
SHIFT_VECTOR = (3.0, -2.0, 1.6)


@dataclass(frozen=True)
class UserHead:
    """A user's head, in metres, with z up."""

    mesh: Mesh
    landmarks: Integers32

    def write(self, folder: Path, *, points: bool = False, **changes: Any) -> tuple[Path, Path]:
        """Write the mesh file and the landmark file; `changes` replaces vertices or landmarks."""
        vertices = changes.get("vertices", self.mesh.vertices)
        landmarks = changes.get("landmarks", self.landmarks)
        lines = [f"v {x:.9f} {y:.9f} {z:.9f}" for x, y, z in vertices]
        lines += [f"f {a} {b} {c}" for a, b, c in changes.get("faces", self.mesh.faces) + 1]
        mesh = folder / "user_head.obj"
        marks = folder / "user_head.json"
        mesh.write_text("\n".join(lines))
        found = vertices[landmarks].tolist() if points else np.asarray(landmarks).tolist()
        marks.write_text(json.dumps({"landmarks": found}))
        return mesh, marks


@cache
def person_of(number: int) -> Person:
    """The person of a number, in the colours of the built-in head; made once in a process."""
    return make_person(sample_identity(number))


def write_topology(folder: Path, other: UserHead, **changes: Any) -> Path:
    """Write a topology as a user's folder, described by counts alone unless `changes` adds more."""
    file = folder / "risorius" / "topologies" / "mine.json"
    file.parent.mkdir(parents=True, exist_ok=True)
    mine = {
        "name": "mine",
        "counts": [[len(other.mesh.vertices), len(other.mesh.faces)]],
        "landmarks": other.landmarks.tolist(),
    }
    file.write_text(json.dumps(mine | changes))
    return file


def shape(x: Floats64) -> Floats64:
    """A smooth change of shape [mm]: a broader, shorter face with a longer chin and a bent nose."""
    across, up, ahead = x.T
    nose = np.exp(-((across / 18.0) ** 2) - ((up + 25.0) / 25.0) ** 2)
    chin = np.exp(-(((up + 110.0) / 30.0) ** 2))
    broader = across * (1.08 - 0.0006 * up) + 1.5 * nose
    shorter = up * 0.94 - 6.0 * chin
    deeper = ahead * 1.03 + 4.0 * nose * np.sign(ahead) - 3.0 * chin
    return np.stack([broader, shorter, deeper], axis=1)


def user_head(level: int = 1) -> UserHead:
    """The built-in head with 4^level times as many triangles, as a user's head."""
    head = assets.load("head")
    fine = head.finer(level)
    vertices = shape(fine.vertices) @ TURN_MATRIX.T * METRES_PER_MILLIMETRE + SHIFT_VECTOR
    return UserHead(Mesh(vertices, fine.faces), head.landmarks)


def closed(mesh: Mesh, vertices: Integers32) -> Mesh:
    """The mesh with a new vertex in the middle of an opening, and a fan of triangles around it.

    vertices: some vertices on the edge of the opening.
    """
    loop = _edge_around(mesh, vertices)
    centre = mesh.vertices[vertices].mean(axis=0)
    middle = len(mesh.vertices)
    fan = [[after, before, middle] for before, after in zip(loop, np.roll(loop, -1), strict=True)]
    return Mesh(np.vstack([mesh.vertices, centre]), np.vstack([mesh.faces, fan]).astype(np.int32))


def nearly_shut(mesh: Mesh, vertices: Integers32) -> Mesh:
    """The mesh with an eye that opens by a fifth of its height; vertices: some on its edge."""
    centre = mesh.vertices[vertices].mean(axis=0)
    reach = 20.0  # [mm]
    share = np.exp(-((np.linalg.norm(mesh.vertices - centre, axis=1) / reach) ** 4))
    places = mesh.vertices.copy()
    places[:, 1] -= 0.8 * share * (places[:, 1] - centre[1])
    return replace(mesh, vertices=places)


def filled(mesh: Mesh, vertices: Integers32) -> Mesh:
    """The mesh with an opening closed by a strip of triangles between vertices of its edge."""
    left = _edge_around(mesh, vertices)
    strip = []
    while len(left) > 2:
        strip.append([left[1], left[0], left[-1]])
        left = left[1:]
        if len(left) > 2:
            strip.append([left[0], left[-1], left[-2]])
            left = left[:-1]
    return Mesh(mesh.vertices, np.vstack([mesh.faces, strip]).astype(np.int32))


def _edge_around(mesh: Mesh, vertices: Integers32) -> list[int]:
    """Vertices around the edge of an opening, in order, from its right corner."""
    centre = mesh.vertices[vertices].mean(axis=0)
    ways = {tuple(way) for way in sides_of(mesh.faces).tolist()}
    following = {a: b for a, b in ways if (b, a) not in ways}
    border = np.array(list(following))
    off = np.linalg.norm(mesh.vertices[border] - centre, axis=1)
    loop = [int(border[off.argmin()])]
    while following[loop[-1]] != loop[0]:
        loop.append(following[loop[-1]])
    corner = int(mesh.vertices[loop, 0].argmin())
    return [*loop[corner:], *loop[:corner]]


def with_card(mesh: Mesh) -> Mesh:
    """The mesh with a card of hair behind it: two triangles for each side."""
    count = len(mesh.vertices)
    card = mesh.vertices.mean(axis=0) + np.ptp(mesh.vertices) * np.eye(4, 3)
    sides = count + np.array([[0, 1, 2], [0, 2, 3], [0, 2, 1], [0, 3, 2]])
    faces = np.vstack([sides, mesh.faces]).astype(np.int32)
    return Mesh(np.vstack([mesh.vertices, card]), faces)


def sealed() -> UserHead:
    """The built-in head with lips joined along their contact line, without a mouth behind them."""
    head = assets.load("head")
    vertices = head.vertices.copy()
    same = np.arange(len(vertices))
    half = len(head.rings["mouth_2_left"]) // 2
    for side in ("left", "right"):
        ring = head.rings[f"mouth_2_{side}"]
        for upper, lower in zip(ring[:half], ring[:half:-1], strict=True):
            vertices[upper] = 0.5 * (vertices[upper] + vertices[lower])
            same[lower] = upper
    inner = [head.rings[f"mouth_{ring}_{side}"] for ring in (0, 1) for side in ("left", "right")]
    faces = head.faces[~np.isin(head.faces, np.concatenate(inner)).any(axis=1)]
    used, number = np.unique(same[faces], return_inverse=True)
    found = np.searchsorted(used, same[head.landmarks]).astype(np.int32)
    return UserHead(Mesh(vertices[used], number.reshape(-1, 3).astype(np.int32)), found)


def masked() -> UserHead:
    """The built-in head with a slightly open mouth; triangles cover the mouth and the eyes."""
    head = assets.load("head")
    opening = np.array([0.0, -8.0, 0.0])  # [mm]
    lowered = np.clip(1.5 * head.mandible_weight - 0.5, 0.0, 1.0)  # the upper lip stays
    vertices = head.vertices + lowered[:, None] * opening
    behind = ("mouth_0", "mouth_1", "eye_0", "eye_1")  # rings behind edges of lips and lids
    inner = [head.rings[f"{ring}_{side}"] for ring in behind for side in ("left", "right")]
    mesh = Mesh(vertices, head.faces[~np.isin(head.faces, np.concatenate(inner)).any(axis=1)])
    for around in (slice(60, 68), slice(36, 42), slice(42, 48)):
        mesh = filled(mesh, head.landmarks[around])
    return UserHead(mesh, head.landmarks)
