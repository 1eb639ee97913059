"""Write a binary glTF file (.glb), which has a chunk of JSON and a chunk of binary data.

Source: Khronos Group, "glTF 2.0 Specification", sections 3.6 (buffers, accessors) and 4 (GLB).
"""

from __future__ import annotations

import io
import json
import struct
from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt
import PIL.Image

import risorius
from risorius.geometry.arrays import Floats32, Floats64, Unsigned8

ARRAY_BUFFER = 34962  # target of a buffer view with vertices
ELEMENT_ARRAY_BUFFER = 34963  # target of a buffer view with corners of triangles
COMPONENT_CODES = {"uint8": 5121, "uint16": 5123, "uint32": 5125, "float32": 5126}
ACCESSOR_TYPES: dict[tuple[int, ...], str] = {
    (): "SCALAR", (2,): "VEC2", (3,): "VEC3", (4,): "VEC4", (4, 4): "MAT4",
}  # fmt: skip
CHUNK_ALIGNMENT = 4  # [bytes], of chunks and of arrays in them


class Glb:
    """The content of a file, to which items are added.

    times: times of the keyframes [s], (N,); values between them are interpolated linearly.
    parts: document of an existing file that is extended; None for a new file.
    numbers: binary chunk of this file.
    """

    def __init__(
        self,
        times: Floats64 | None = None,
        parts: dict[str, Any] | None = None,
        numbers: bytes = b"",
    ) -> None:
        self._times = np.zeros(0) if times is None else times
        self._input: int | None = None
        self._tracks: dict[str, list[dict[str, Any]]] = {"channels": [], "samplers": []}
        self.parts: dict[str, Any] = parts or {
            "asset": {"version": "2.0", "generator": f"Risorius {risorius.__version__}"},
            "scene": 0,
        }
        self._numbers = bytearray(numbers)
        self._zeros: dict[int, int] = {}

    def data(self) -> bytes:
        """Return the binary chunk so far."""
        return bytes(self._numbers)

    def add(self, kind: str, item: dict[str, Any]) -> int:
        """Add an item to the list `kind`, such as "nodes" or "meshes"; return its index there."""
        items = self.parts.setdefault(kind, [])
        items.append(item)
        return len(items) - 1

    def use(self, extension: str) -> None:
        """Add an extension to the list of used extensions."""
        used = self.parts.setdefault("extensionsUsed", [])
        if extension not in used:
            used.append(extension)

    def accessor(
        self, values: npt.NDArray[Any], target: int | None = None, *, is_bounded: bool = False
    ) -> int:
        """Add an array whose rows are numbers, vectors or matrices (by columns); return its index.

        target: ARRAY_BUFFER, ELEMENT_ARRAY_BUFFER or None.
        is_bounded: whether to add minima and maxima, which positions and times need.
        """
        accessor: dict[str, Any] = {
            "bufferView": self._view(np.ascontiguousarray(values).tobytes(), target),
            "componentType": COMPONENT_CODES[values.dtype.name],
            "count": len(values),
            "type": ACCESSOR_TYPES[values.shape[1:]],
        }
        if is_bounded:
            accessor["min"] = np.atleast_1d(values.min(axis=0)).tolist()
            accessor["max"] = np.atleast_1d(values.max(axis=0)).tolist()
        return self.add("accessors", accessor)

    def sparse(self, vectors: Floats32) -> int:
        """Add vectors (V, 3) of which most are 0, stored sparsely; return the array's index."""
        count = len(vectors)
        nonzero_rows = np.flatnonzero(vectors.any(axis=1))
        if not len(nonzero_rows):
            return self._nothing(count)
        if len(nonzero_rows) > 0.8 * count:  # with indices, the array would be larger
            return self.accessor(vectors, ARRAY_BUFFER, is_bounded=True)
        short = np.uint16 if count <= 65535 else np.uint32
        numbers = nonzero_rows.astype(short)
        indices = {
            "bufferView": self._view(numbers.tobytes(), None),
            "componentType": COMPONENT_CODES[numbers.dtype.name],
        }
        values = {"bufferView": self._view(vectors[nonzero_rows].tobytes(), None)}
        accessor = {
            "componentType": COMPONENT_CODES["float32"],
            "count": count,
            "type": "VEC3",
            "min": vectors.min(axis=0).tolist(),
            "max": vectors.max(axis=0).tolist(),
            "sparse": {"count": len(nonzero_rows), "indices": indices, "values": values},
        }
        return self.add("accessors", accessor)

    def _nothing(self, count: int) -> int:
        """Add `count` zero vectors, or return the array that was added before."""
        if count not in self._zeros:
            self._zeros[count] = self.add(
                "accessors",
                {
                    "componentType": COMPONENT_CODES["float32"],
                    "count": count,
                    "type": "VEC3",
                    "min": [0.0, 0.0, 0.0],
                    "max": [0.0, 0.0, 0.0],
                },
            )
        return self._zeros[count]

    def texture(self, image: Unsigned8, kind: str = "jpeg") -> dict[str, int]:
        """Add a picture (H, W) or (H, W, 3), top row first, as a texture.

        kind: "jpeg", or "png" for a lossless picture. Returns the reference for a material.
        """
        file = io.BytesIO()
        # The quality is chosen by eye: skin shows no blocks, and the size is a sixth of a PNG's.
        PIL.Image.fromarray(image).save(file, kind, quality=92, subsampling=0)
        source = self.image(file.getvalue(), kind)
        return {"index": self.add("textures", {"source": source})}

    def image(self, content: bytes, kind: str) -> int:
        """Add the content of a picture file, "png" or "jpeg", unchanged; return its index."""
        view = self._view(content, None)
        return self.add("images", {"bufferView": view, "mimeType": f"image/{kind}"})

    def animate(self, node: int, path: str, values: Floats64) -> None:
        """Add keyframes of a node.

        path: "translation", "rotation" or "weights". values: value at each time, (N, ...).
        """
        if self._input is None:
            self._input = self.accessor(self._times.astype(np.float32), is_bounded=True)
        rows = values.ravel() if path == "weights" else values
        sampler = {"input": self._input, "output": self.accessor(rows.astype(np.float32))}
        target = {"node": node, "path": path}
        channel = {"sampler": len(self._tracks["samplers"]), "target": target}
        self._tracks["samplers"].append(sampler)
        self._tracks["channels"].append(channel)

    def to_bytes(self, title: str, roots: Sequence[int]) -> bytes:
        """Return the bytes of the file.

        title: title of the animation. roots: added nodes without a parent.
        """
        if self._input is not None:
            self.add("animations", {"name": title, **self._tracks})
        if "scenes" not in self.parts:
            self.add("scenes", {"nodes": []})
        scene = self.parts["scenes"][self.parts.get("scene", 0)]
        if roots:
            scene["nodes"] = [*scene.get("nodes", []), *roots]
        numbers = _padded_bytes(bytes(self._numbers), b"\0")
        first = self.parts.get("buffers", [{}])[0]
        parts = {**self.parts, "buffers": [{**first, "byteLength": len(numbers)}]}
        text = json.dumps(parts, separators=(",", ":"), allow_nan=False).encode()
        chunks = ((b"JSON", _padded_bytes(text, b" ")), (b"BIN\0", numbers))
        body = b"".join(struct.pack("<I4s", len(data), kind) + data for kind, data in chunks)
        return struct.pack("<4sII", b"glTF", 2, 12 + len(body)) + body

    def _view(self, data: bytes, target: int | None) -> int:
        """Add aligned bytes as a buffer view; return its index."""
        self._numbers += b"\0" * (-len(self._numbers) % CHUNK_ALIGNMENT)
        view = {"buffer": 0, "byteOffset": len(self._numbers), "byteLength": len(data)}
        self._numbers += data
        return self.add("bufferViews", view if target is None else {**view, "target": target})


def picture_kind(content: bytes) -> str | None:
    """Return the kind of a picture by its first bytes, such as "png"; None for other files."""
    if content.startswith(b"RIFF") and content[8:12] == b"WEBP":
        return "webp"
    kinds = {b"\x89PNG": "png", b"\xff\xd8": "jpeg", b"\xabKTX 20": "ktx2"}
    return next((kind for start, kind in kinds.items() if content.startswith(start)), None)


def _padded_bytes(data: bytes, filler: bytes) -> bytes:
    return data + filler * (-len(data) % CHUNK_ALIGNMENT)
