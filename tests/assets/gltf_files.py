"""glTF files for tests, made from arrays in all forms that the specification allows."""

import json
import struct
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

COMPONENTS = {"i1": 5120, "u1": 5121, "i2": 5122, "u2": 5123, "u4": 5125, "f4": 5126}
TYPES = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4", 16: "MAT4"}


class GltfMaker:
    """A glTF file under construction; tests may change its document, `parts`."""

    def __init__(self) -> None:
        self.parts: dict[str, Any] = {"asset": {"version": "2.0"}, "scene": 0}
        self.data = bytearray()

    def add(self, kind: str, entry: dict[str, Any]) -> int:
        """Add an entry to a list of the document; return the entry's number."""
        self.parts.setdefault(kind, []).append(entry)
        return len(self.parts[kind]) - 1

    def view(self, data: bytes, **more: Any) -> int:
        """Add bytes as a buffer view; return the view's number."""
        self.data += bytes(-len(self.data) % 4)
        start = len(self.data)
        self.data += data
        lies = {"buffer": 0, "byteOffset": start, "byteLength": len(data)}
        return self.add("bufferViews", {**lies, **more})

    def accessor(self, rows: npt.ArrayLike, kind: str = "f4", *, gap: int = 0, **more: Any) -> int:
        """Add rows of numbers; return the accessor's number. gap: bytes between two rows."""
        array = np.atleast_2d(np.asarray(rows))
        array = array.T if array.shape[0] == 1 and np.ndim(rows) == 1 else array
        array = array.astype("<" + kind)
        data = array.tobytes()
        view = {}
        if gap:
            data = b"".join(row.tobytes() + b"\x55" * gap for row in array)
            view = {"byteStride": array.shape[1] * array.itemsize + gap}
        shown = {"bufferView": self.view(data, **view), **more}
        return self.described(array.shape, kind, **shown)

    def described(self, shape: tuple[int, int], kind: str, **more: Any) -> int:
        """Add an accessor for rows of this shape, without data."""
        count, width = shape
        known = {"componentType": COMPONENTS[kind], "count": count, "type": TYPES[width]}
        return self.add("accessors", {**known, **more})

    def mesh(self, *primitives: dict[str, Any], **more: Any) -> int:
        """Add a mesh."""
        return self.add("meshes", {"primitives": [*primitives], **more})

    def primitive(
        self, vertices: npt.ArrayLike, faces: npt.ArrayLike | None, **more: Any
    ) -> dict[str, Any]:
        """A primitive with positions and, if there are faces, their indices.

        more: other keys of the primitive; "attributes" are added to the positions.
        """
        attributes = {"POSITION": self.accessor(vertices), **more.pop("attributes", {})}
        made: dict[str, Any] = {"attributes": attributes, **more}
        if faces is not None:
            made["indices"] = self.accessor(np.ravel(faces), "u4")
        return made

    def picture(self, content: bytes, **texture: Any) -> int:
        """Add a picture and a texture that shows it; return the texture's number."""
        image = self.add("images", {"bufferView": self.view(content), "mimeType": "image/png"})
        return self.add("textures", {"source": image, **texture})

    def shown(self, *nodes: dict[str, Any]) -> None:
        """Add nodes, and a scene with these nodes."""
        self.add("scenes", {"nodes": [self.add("nodes", node) for node in nodes]})

    def document(self, **buffer: Any) -> bytes:
        """The document as text; buffer: keys that locate its data."""
        own = [{"byteLength": len(self.data), **buffer}]
        return json.dumps({"buffers": own, **self.parts}).encode()

    def glb(self, version: int = 2) -> bytes:
        """The bytes of the whole GLB file."""
        text = self.document()
        text += b" " * (-len(text) % 4)
        data = bytes(self.data) + bytes(-len(self.data) % 4)
        body = struct.pack("<I4s", len(text), b"JSON") + text
        body += struct.pack("<I4s", len(data), b"BIN\0") + data
        return struct.pack("<4sII", b"glTF", version, 12 + len(body)) + body

    def write(self, path: Path) -> Path:
        """Write the GLB file."""
        path.write_bytes(self.glb())
        return path
