"""A binary glTF file (.glb): one chunk of JSON, one of numbers, and how numbers are named in it.

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

ARRAY_BUFFER = 34962  # a buffer view for vertices
ELEMENT_ARRAY_BUFFER = 34963  # a buffer view for corners
COMPONENT_TYPES = {"uint8": 5121, "uint16": 5123, "uint32": 5125, "float32": 5126}
TYPES: dict[tuple[int, ...], str] = {
    (): "SCALAR", (2,): "VEC2", (3,): "VEC3", (4,): "VEC4", (4, 4): "MAT4",
}  # fmt: skip
ALIGNMENT = 4  # [bytes] of chunks, and of the arrays in them


class Glb:
    """The content of one file, in the order in which it is added."""

    def __init__(self, times: npt.NDArray[np.float64]) -> None:
        """Times of the keyframes [s], shape (N,); between them values change evenly."""
        self._times = times
        self._input: int | None = None
        self._tracks: dict[str, list[dict[str, Any]]] = {"channels": [], "samplers": []}
        self._parts: dict[str, Any] = {
            "asset": {"version": "2.0", "generator": f"Risorius {risorius.__version__}"},
            "scene": 0,
        }
        self._numbers = bytearray()

    def add(self, kind: str, item: dict[str, Any]) -> int:
        """Add a node, mesh, material, ... to the list called `kind`; return its number there."""
        items = self._parts.setdefault(kind, [])
        items.append(item)
        return len(items) - 1

    def accessor(
        self, values: npt.NDArray[Any], target: int | None = None, *, is_bounded: bool = False
    ) -> int:
        """Add an array whose rows are numbers, vectors or matrices (their columns first).

        is_bounded: add the least and greatest values, which positions and times need.
        """
        accessor: dict[str, Any] = {
            "bufferView": self._view(np.ascontiguousarray(values).tobytes(), target),
            "componentType": COMPONENT_TYPES[values.dtype.name],
            "count": len(values),
            "type": TYPES[values.shape[1:]],
        }
        if is_bounded:
            accessor["min"] = np.atleast_1d(values.min(axis=0)).tolist()
            accessor["max"] = np.atleast_1d(values.max(axis=0)).tolist()
        return self.add("accessors", accessor)

    def texture(self, image: npt.NDArray[np.uint8], kind: str = "jpeg") -> dict[str, int]:
        """Add a picture (H, W) or (H, W, 3), top row first, as a texture.

        Returns the reference to it for a material.

        kind: "png" where every bit counts.
        """
        file = io.BytesIO()
        # Quality by eye: no blocks in skin, a sixth of the PNG.
        PIL.Image.fromarray(image).save(file, kind, quality=92, subsampling=0)
        view = self._view(file.getvalue(), None)
        source = self.add("images", {"bufferView": view, "mimeType": f"image/{kind}"})
        return {"index": self.add("textures", {"source": source})}

    def animate(self, node: int, path: str, values: npt.NDArray[np.float64]) -> None:
        """Add the "translation", "rotation" or "weights" of a node at each time, first axis N."""
        if self._input is None:
            self._input = self.accessor(self._times.astype(np.float32), is_bounded=True)
        rows = values.ravel() if path == "weights" else values
        sampler = {"input": self._input, "output": self.accessor(rows.astype(np.float32))}
        target = {"node": node, "path": path}
        channel = {"sampler": len(self._tracks["samplers"]), "target": target}
        self._tracks["samplers"].append(sampler)
        self._tracks["channels"].append(channel)

    def to_bytes(self, title: str, roots: Sequence[int]) -> bytes:
        """The whole file; title: of its motion. roots: nodes that hang on no other."""
        if self._input is not None:
            self.add("animations", {"name": title, **self._tracks})
        self.add("scenes", {"nodes": roots})
        numbers = _padded(bytes(self._numbers), b"\0")
        parts = {**self._parts, "buffers": [{"byteLength": len(numbers)}]}
        text = json.dumps(parts, separators=(",", ":"), allow_nan=False).encode()
        chunks = ((b"JSON", _padded(text, b" ")), (b"BIN\0", numbers))
        body = b"".join(struct.pack("<I4s", len(data), kind) + data for kind, data in chunks)
        return struct.pack("<4sII", b"glTF", 2, 12 + len(body)) + body

    def _view(self, data: bytes, target: int | None) -> int:
        """Add bytes, aligned."""
        self._numbers += b"\0" * (-len(self._numbers) % ALIGNMENT)
        view = {"buffer": 0, "byteOffset": len(self._numbers), "byteLength": len(data)}
        self._numbers += data
        return self.add("bufferViews", view if target is None else {**view, "target": target})


def _padded(data: bytes, filler: bytes) -> bytes:
    return data + filler * (-len(data) % ALIGNMENT)
