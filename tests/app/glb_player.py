"""A simple player of glTF files, after the specification: all vertices at any time."""

import json
import struct
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pygltflib

Array = npt.NDArray[Any]
COMPONENTS = {5121: np.uint8, 5123: np.uint16, 5125: np.uint32, 5126: np.float32}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}


def document(path: Path) -> dict[str, Any]:
    """The JSON document of a GLB file."""
    data = path.read_bytes()
    (length,) = struct.unpack_from("<I", data, 12)
    found: dict[str, Any] = json.loads(data[20 : 20 + length])
    return found


class Player:
    """One file, read by pygltflib."""

    def __init__(self, path: Path) -> None:
        self.file = pygltflib.GLTF2().load_binary(str(path))
        self.blob = self.file.binary_blob()
        nodes = self.file.nodes
        self.numbers = {node.name: index for index, node in enumerate(nodes)}
        self.parents = {child: index for index, node in enumerate(nodes) for child in node.children}
        self.animation = self.file.animations[0] if self.file.animations else None

    def values(self, number: int) -> Array:
        """The rows of an accessor."""
        accessor = self.file.accessors[number]
        width = WIDTHS[accessor.type]
        kind = COMPONENTS[accessor.componentType]
        shape = (accessor.count, width) if width > 1 else (accessor.count,)
        rows = np.zeros(shape, kind)
        if accessor.bufferView is not None:
            rows = self._rows(accessor.bufferView, accessor.byteOffset, kind, shape)
        if accessor.sparse is not None:
            sparse = accessor.sparse
            count = sparse.count
            numbers = COMPONENTS[sparse.indices.componentType]
            view = sparse.indices.bufferView
            where = self._rows(view, sparse.indices.byteOffset, numbers, (count,))
            assert (np.diff(where.astype(int)) > 0).all()
            view = sparse.values.bufferView
            rows = rows.copy()
            rows[where] = self._rows(view, sparse.values.byteOffset, kind, (count, *shape[1:]))
        return rows

    def _rows(self, view: int, offset: int | None, kind: Any, shape: tuple[int, ...]) -> Array:
        """Numbers in a part of the buffer, as rows."""
        start = (self.file.bufferViews[view].byteOffset or 0) + (offset or 0)
        return np.frombuffer(self.blob, kind, int(np.prod(shape)), start).reshape(shape)

    def shapes(self, name: str) -> dict[str, Array]:
        """Displacements of a node's vertices by the named targets of its mesh."""
        mesh = self.file.meshes[self.file.nodes[self.numbers[name]].mesh]
        targets = mesh.primitives[0].targets or []
        names = (mesh.extras or {}).get("targetNames", [])
        return {
            each: self.values(target["POSITION"])
            for each, target in zip(names, targets, strict=True)
        }

    @property
    def times(self) -> Array:
        """Times of the keyframes [s]."""
        assert self.animation is not None
        inputs = {sampler.input for sampler in self.animation.samplers}
        assert len(inputs) == 1
        return self.values(inputs.pop())

    def track(self, node: int, path: str) -> Array | None:
        """Values of one property of a node at each keyframe, (N, k); None without a track."""
        for channel in [] if self.animation is None else self.animation.channels:
            if (channel.target.node, channel.target.path) == (node, path):
                assert self.animation is not None
                sampler = self.animation.samplers[channel.sampler]
                assert sampler.interpolation == "LINEAR"
                return self.values(sampler.output).reshape(len(self.times), -1)
        return None

    def primitive(self, name: str) -> Any:
        """The first primitive of a node's mesh; all primitives share its vertices."""
        mesh = self.file.meshes[self.file.nodes[self.numbers[name]].mesh]
        first = mesh.primitives[0].attributes.POSITION
        assert {each.attributes.POSITION for each in mesh.primitives} == {first}
        return mesh.primitives[0]

    def attribute(self, name: str, attribute: str) -> Array:
        """An attribute of a node's vertices."""
        return self.values(getattr(self.primitive(name).attributes, attribute))

    def target_names(self, name: str) -> list[str]:
        """The names of the morph targets of a node's mesh."""
        mesh = self.file.meshes[self.file.nodes[self.numbers[name]].mesh]
        return list(mesh.extras.get("targetNames", []))

    def target(self, name: str, number: int, attribute: str = "POSITION") -> Array:
        """The displacements of a morph target."""
        added = self.primitive(name).targets[number]
        index = added[attribute] if isinstance(added, dict) else getattr(added, attribute)
        return self.values(index).astype(np.float64)

    def weights(self, name: str) -> Array:
        """Weights of the morph targets at each keyframe, (N, K)."""
        track = self.track(self.numbers[name], "weights")
        assert track is not None
        return track

    def matrix(self, node: int, frame: int) -> Array:
        """The matrix from a node's coordinates to the scene's."""
        local = np.eye(4)
        turn = self._at(node, "rotation", frame, self.file.nodes[node].rotation or [0, 0, 0, 1])
        shift = self._at(node, "translation", frame, self.file.nodes[node].translation or [0, 0, 0])
        assert self.file.nodes[node].scale is None
        assert self.file.nodes[node].matrix is None
        x, y, z, w = turn
        assert abs(x * x + y * y + z * z + w * w - 1.0) < 1e-5
        local[:3, :3] = [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
        local[:3, 3] = shift
        parent = self.parents.get(node)
        return local if parent is None else self.matrix(parent, frame) @ local

    def shape(self, name: str, frame: int, attribute: str = "POSITION") -> Array:
        """Positions or normals of a node's vertices with morph targets, before skinning."""
        points = self.attribute(name, attribute).astype(np.float64)
        weights = self.weights(name)[frame] if self.primitive(name).targets else []
        for number, weight in enumerate(weights):
            points = points + weight * self.target(name, number, attribute)
        return points

    def positions(self, name: str, frame: int) -> Array:
        """Positions of a node's vertices at a keyframe [m], (V, 3)."""
        node = self.numbers[name]
        points = np.column_stack([self.shape(name, frame), np.ones(self._count(name))])
        if self.file.nodes[node].skin is None:
            return np.asarray((points @ self.matrix(node, frame).T)[:, :3])
        skin = self.file.skins[self.file.nodes[node].skin]
        columns = self.values(skin.inverseBindMatrices).astype(np.float64)
        to_bones = columns.reshape(-1, 4, 4).transpose(0, 2, 1)
        motions = [
            self.matrix(joint, frame) @ to_bone
            for joint, to_bone in zip(skin.joints, to_bones, strict=True)
        ]
        joints = self.attribute(name, "JOINTS_0")
        shares = self.attribute(name, "WEIGHTS_0")
        moved = np.zeros_like(points)
        for slot in range(4):
            each = np.array(motions)[joints[:, slot]]
            moved += shares[:, slot, None] * np.einsum("vij,vj->vi", each, points)
        return moved[:, :3]

    def _count(self, name: str) -> int:
        return len(self.attribute(name, "POSITION"))

    def _at(self, node: int, path: str, frame: int, still: list[float]) -> Array:
        track = self.track(node, path)
        return np.array(still, np.float64) if track is None else track[frame].astype(np.float64)
