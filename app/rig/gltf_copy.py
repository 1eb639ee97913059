"""Copy a glTF file, and append named shapes to its meshes.

Nodes, skins, materials, other meshes, animations, extras and extensions stay unchanged. Data from
other files, or from text, are moved into the binary chunk. Where the file has weights of shapes,
the weight 0 is added for each new shape.

Source: Khronos Group, "glTF 2.0 Specification", sections 3.7.2.2 (morph targets) and 4 (GLB).
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from risorius.assets.fitting.lips import LipCut
from risorius.assets.fitting.warp import Similarity
from risorius.assets.gltf import StoredPiece
from risorius.assets.gltf_content import TYPE_OF_COMPONENT, content_of, decompressed_chunks
from risorius.geometry.arrays import Floats32, Integers

from .bodies import Shaped
from .glb import Glb, picture_kind

NAME_SUFFIX = ".risorius"  # appended to the name of a shape if the file already has it


def read_document(content: bytes, folder: Path) -> tuple[dict[str, Any], bytes]:
    """Return the document of a glTF file, and one buffer with all its data.

    folder: folder of other files that the document names. A missing file raises AssetError.
    """
    text, data = decompressed_chunks(content, folder)
    document: dict[str, Any] = json.loads(text.decode("utf-8-sig"))
    binary = data or b""
    buffers = document.get("buffers", [])
    images = document.get("images", [])
    if len(buffers) == 1 and not any("uri" in each for each in (*buffers, *images)):
        return document, binary[: buffers[0]["byteLength"]]
    return document, _gathered(document, binary, folder)


def _gathered(document: dict[str, Any], binary: bytes, folder: Path) -> bytes:
    """Join all data of a document into one buffer, and make the document refer to it."""
    data = bytearray()
    starts = []
    for buffer in document.get("buffers", []):
        data += b"\0" * (-len(data) % 4)
        starts.append(len(data))
        found = content_of(buffer["uri"], folder, "buffer") if "uri" in buffer else binary
        data += found[: buffer["byteLength"]]
    for view in document.get("bufferViews", []):
        view["byteOffset"] = view.get("byteOffset", 0) + starts[view["buffer"]]
        view["buffer"] = 0
    for image in document.get("images", []):
        if "uri" not in image:
            continue
        picture = content_of(image.pop("uri"), folder, "picture")
        data += b"\0" * (-len(data) % 4)
        view = {"buffer": 0, "byteOffset": len(data), "byteLength": len(picture)}
        document.setdefault("bufferViews", []).append(view)
        image["bufferView"] = len(document["bufferViews"]) - 1
        kind = picture_kind(picture)
        if kind is not None:
            image["mimeType"] = f"image/{kind}"
        data += picture
    document["buffers"] = [{"byteLength": len(data)}]
    return bytes(data)


@dataclass(frozen=True)
class _Changes:
    """Changes of a primitive's n vertices by K shapes, in its coordinates, (K, n, 3)."""

    places: Floats32
    normals: Floats32


class GltfShapes:
    """Appends shapes to the meshes of a file."""

    def __init__(
        self, glb: Glb, shaped: Shaped, to_millimetres: Similarity, cut: LipCut | None
    ) -> None:
        """cut: the cut between the lips; its doubled vertices are vertices of `shaped`, too."""
        doubled = np.zeros(0, np.int64) if cut is None else cut.sources
        count = len(shaped.body.rest) - len(doubled)
        self._sources = np.append(np.arange(count), doubled)  # the file's vertex for each vertex
        self._glb = glb
        self._document = glb.parts
        self._shaped = shaped
        self._to_file = to_millimetres.inverse

    def append(
        self,
        pieces: Sequence[StoredPiece],
        vertices: Sequence[Integers],
        names: Sequence[str],
        extras: Mapping[str, Any],
    ) -> None:
        """Add the shapes to all meshes that they move.

        pieces: meshes of the file. vertices: vertex indices of each piece, see `vertices_of`.
        names: names of the shapes. extras: added to the extras of these meshes.
        """
        changes: dict[int, dict[int, _Changes]] = {}
        for piece, own in zip(pieces, vertices, strict=True):
            # If several nodes show a mesh, it gets the shapes of the first node.
            of_mesh = changes.setdefault(piece.mesh, {})
            if piece.primitive not in of_mesh and self._shaped.targets[:, own].any():
                of_mesh[piece.primitive] = self._changes(piece, own)
        for mesh, of_mesh in changes.items():
            if of_mesh:
                self._append_to(mesh, of_mesh, names, extras)

    def _changes(self, piece: StoredPiece, own: Integers) -> _Changes:
        """Return the changes of a piece with the vertices `own`, in its primitive's coordinates."""
        turn = self._to_file.rotation
        matrices = np.broadcast_to(piece.to_scene, (piece.count, 3, 3))
        matrices = matrices[self._sources[own] - own[0]]
        back = np.linalg.pinv(matrices)
        scale = np.cbrt(np.abs(np.linalg.det(matrices)))[:, None, None]
        # The scene's normal is M^-T times the stored normal.
        unturn = matrices.swapaxes(1, 2) / np.maximum(scale, 1e-12)
        moved = self._to_file.scale * (self._shaped.targets[:, own] @ turn.T)
        bent = self._shaped.bends[:, own] @ turn.T
        return _Changes(
            np.einsum("nij,knj->kni", back, moved).astype(np.float32),
            np.einsum("nij,knj->kni", unturn, bent).astype(np.float32),
        )

    def _append_to(
        self,
        number: int,
        changes: Mapping[int, _Changes],
        names: Sequence[str],
        extras: Mapping[str, Any],
    ) -> None:
        """Add the shapes to all primitives of a mesh; glTF requires equal numbers of shapes."""
        mesh = self._document["meshes"][number]
        old = max(len(each.get("targets", [])) for each in mesh["primitives"])
        for place, primitive in enumerate(mesh["primitives"]):
            targets = primitive.setdefault("targets", [])
            has_normals = "NORMAL" in primitive["attributes"]
            if targets:
                has_normals = has_normals and "NORMAL" in targets[0]
            count = self._document["accessors"][primitive["attributes"]["POSITION"]]["count"]
            none = np.zeros((len(names), count, 3), np.float32)
            own = changes.get(place, _Changes(none, none))
            for moved, bent in zip(own.places, own.normals, strict=True):
                target = {"POSITION": self._glb.sparse(moved)}
                if has_normals:
                    target["NORMAL"] = self._glb.sparse(bent)
                targets.append(target)
        written = mesh.setdefault("extras", {})
        known = list(written.get("targetNames", []))
        known += [f"target_{place}" for place in range(len(known), old)]
        added = [name + NAME_SUFFIX if name in known else name for name in names]
        written["targetNames"] = [*known, *added]
        written.update(extras)
        old_weights = mesh.get("weights", [0.0] * old)
        new_weights = [0.0] * len(names)
        mesh["weights"] = [*old_weights, *new_weights]
        self._weigh_nodes(number, old, len(names))

    def _weigh_nodes(self, mesh: int, old: int, added: int) -> None:
        """Add weights 0 of new shapes to nodes and animations that have weights of a mesh."""
        nodes = [
            place for place, node in enumerate(self._document["nodes"]) if node.get("mesh") == mesh
        ]
        for place in nodes:
            node = self._document["nodes"][place]
            if "weights" in node:
                node["weights"] = [*node["weights"], *[0.0] * added]
        for animation in self._document.get("animations", []):
            channels = animation["channels"]
            used = [channel["sampler"] for channel in channels]
            for channel in channels:
                target = channel["target"]
                if target.get("path") != "weights" or target.get("node") not in nodes:
                    continue
                sampler = animation["samplers"][channel["sampler"]]
                wide = self._widened(sampler["output"], old, added)
                if used.count(channel["sampler"]) > 1:  # another mesh also uses it
                    animation["samplers"].append({**sampler, "output": wide})
                    channel["sampler"] = len(animation["samplers"]) - 1
                else:
                    sampler["output"] = wide

    def _widened(self, accessor: int, old: int, added: int) -> int:
        """Copy an array with weights of `old` shapes, and add `added` zeros at each time."""
        found = self._document["accessors"][accessor]
        view = self._document["bufferViews"][found["bufferView"]]
        kind = np.dtype(TYPE_OF_COMPONENT[found["componentType"]])
        start = view.get("byteOffset", 0) + found.get("byteOffset", 0)
        values = np.frombuffer(self._glb.data(), kind, found["count"], start)
        rows = values.reshape(-1, max(old, 1))
        if kind.kind != "f":
            rows = rows / np.iinfo(kind).max
        wide = np.hstack([rows, np.zeros((len(rows), added))])
        return self._glb.accessor(wide.astype(np.float32).ravel())
