"""Recognise heads of known topologies, which need no landmark file.

A topology is recognised by its numbers of vertices and triangles, by some edges, and by the lengths
of these edges. The numbers may be those of a whole file or of one piece, so eyes, teeth and helper
objects may be missing. topologies.toml has the included topologies. Users add others in JSON files,
each with one topology:

    {"name": "FLAME", "counts": [[5023, 9976]], "landmarks": [68 vertex indices]}

The built-in head, whose topology all persons have, and the coarse head are recognised, too.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Annotated

import numpy as np

from ...folders import configuration_folder
from ...geometry.arrays import Integers, Integers32
from ...geometry.mesh_graph import pieces_of
from ...geometry.sides import side_lengths, sides_of
from ...schema import Record, Within, parsed_json, read
from ..data_files import read_toml
from ..errors import AssetError
from ..loading import load
from ..meshes import Mesh
from ..user_files import MOST_FILE_VERTICES, named, read_file
from .landmark_file import LANDMARK_COUNT
from .mesh_validation import vertices_of_pieces

Number = Annotated[int, Within(0, MOST_FILE_VERTICES)]
OUTER_EYE_CORNERS = (36, 45)  # landmarks


@dataclass(frozen=True)
class Topology(Record):
    """A known topology.

    counts: pairs of the numbers of vertices and of triangles, in a whole file or in one piece.
    landmarks: 68 vertex indices from 0, in the file or in the piece.
    edges: two vertex indices, and their distance divided by the distance of the outer eye corners.
    """

    name: str
    counts: list[tuple[Number, Number]]
    landmarks: list[Number]
    edges: list[tuple[Number, Number, float]] = field(default_factory=list)

    def check(self, where: str) -> None:
        """Raise AssetError unless there are 68 landmarks, and all vertex indices are in range."""
        fewest = min((vertices for vertices, _ in self.counts), default=0)
        if len(self.landmarks) != LANDMARK_COUNT:
            raise AssetError(
                f"{where}, 'landmarks': has {len(self.landmarks)} vertex indices, must have "
                f"{LANDMARK_COUNT}"
            )
        lists = {
            "landmarks": self.landmarks,
            "edges": [vertex for edge in self.edges for vertex in edge[:2]],
        }
        for key, indices in lists.items():
            highest = max(indices, default=-1)
            if highest >= fewest:
                raise AssetError(
                    f"{where}, '{key}': has vertex {highest}; 'counts' must have more "
                    "vertices than this index, which counts from 0"
                )


@dataclass(frozen=True)
class KnownHead:
    """A topology that was recognised in a mesh; landmarks: vertex indices of the mesh, (68,)."""

    name: str
    landmarks: Integers32


def topologies_folder() -> Path:
    """Return the folder of the user's topologies, which need not exist."""
    return configuration_folder() / "topologies"


def recognised(mesh: Mesh) -> KnownHead | None:
    """Recognise the topology of a mesh or of one of its pieces; None if it is unknown.

    If a file of the user's topologies is unusable, raises AssetError.
    """
    known = [*_own_topologies(), *_built_in_topologies()]
    for indices, triangles in _candidates(mesh):
        for topology in known:
            if (len(indices), triangles) in topology.counts and _has_edges(mesh, indices, topology):
                found = indices[topology.landmarks]
                return KnownHead(topology.name, found.astype(np.int32))
    return None


def _candidates(mesh: Mesh) -> Iterator[tuple[Integers, int]]:
    """Yield vertices and number of triangles of each piece, then of the whole mesh."""
    piece = pieces_of(mesh.faces, len(mesh.vertices))
    triangle_piece = piece[mesh.faces[:, 0]]
    triangles = np.bincount(triangle_piece, minlength=int(piece.max()) + 1)
    groups = vertices_of_pieces(piece, mesh.faces)
    for group in sorted(groups, key=len, reverse=True):
        yield group, int(triangles[piece[group[0]]])
    yield mesh.used_vertices, len(mesh.faces)


def _has_edges(mesh: Mesh, indices: Integers, topology: Topology) -> bool:
    """Whether the mesh has all edges of a topology, with about the expected lengths."""
    if not topology.edges:
        return True
    edges = indices[[edge[:2] for edge in topology.edges]]
    first, second = edges.T
    ratio = np.array([edge[2] for edge in topology.edges])
    right, left = indices[topology.landmarks][list(OUTER_EYE_CORNERS)]
    width = float(np.linalg.norm(mesh.vertices[right] - mesh.vertices[left]))
    length = side_lengths(mesh.vertices, edges)
    most_off = 3.0  # greatest factor between lengths on different faces
    is_like = (length < most_off * ratio * width) & (length * most_off > ratio * width)
    count = len(mesh.vertices)
    sides = sides_of(mesh.faces)
    keys = sides.min(axis=1).astype(np.int64) * count + sides.max(axis=1)
    wanted = np.minimum(first, second).astype(np.int64) * count + np.maximum(first, second)
    return bool(is_like.all() and np.isin(wanted, keys).all())


@cache
def _built_in_topologies() -> tuple[Topology, ...]:
    """Return the included topologies, and that of the built-in head."""
    path = Path(__file__).parents[1] / "topologies.toml"
    rows = read_toml(path)["topology"]
    found = [read(Topology, row, path.name, error=AssetError) for row in rows]
    head = load("head")
    counts = [(len(head.vertices), len(head.faces))]
    return (*found, Topology("the built-in head", counts, head.landmarks.tolist()))


def _own_topologies() -> Iterator[Topology]:
    """Read the user's topologies; an unusable file raises AssetError."""
    for path in sorted(topologies_folder().glob("*.json")):
        try:
            document = parsed_json(read_file(path, kind="topology", most=1))
        except (AssetError, ValueError) as error:
            raise AssetError(f"{named(path)}: {error}") from None
        topology = read(Topology, document, named(path), error=AssetError)
        topology.check(named(path))
        yield topology
