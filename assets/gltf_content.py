"""The document and the data of a glTF file, decompressed where the file is compressed.

meshopt compresses parts of buffers, and Draco compresses primitives. A compressed file becomes the
same file without compression, so its readers need no other code for it. Uncompressed data that lie
beside compressed data are taken as they are.

Source: Khronos Group, "glTF 2.0 Specification", section 4, and the extensions
EXT_meshopt_compression, KHR_meshopt_compression and KHR_draco_mesh_compression.
"""

from __future__ import annotations

import base64
import json
import struct
from collections.abc import Sequence
from importlib import import_module
from pathlib import Path
from typing import Any
from urllib.parse import unquote_to_bytes

import numpy as np
import numpy.typing as npt

from .errors import AssetError
from .user_files import MOST_FILE_VERTICES, named, path_beside, read_file, text_with_names

TYPE_OF_COMPONENT = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
DRACO_EXTENSION = "KHR_draco_mesh_compression"
MESHOPT_EXTENSIONS = ("EXT_meshopt_compression", "KHR_meshopt_compression")
MOST_MEGABYTES = 100  # of one file that a document names


def decompressed_chunks(content: bytes, folder: Path) -> tuple[bytes, bytes | None]:
    """Return the document of a glTF or GLB file and its binary data, both without compression.

    folder: that of the file. A compressed file has all its data in the binary data that are
    returned, and its pictures in files stay there. Raises AssetError if a package that decompresses
    them is missing.
    """
    text, data = _chunks_of(content)
    if not any(name.encode() in text for name in (DRACO_EXTENSION, *MESHOPT_EXTENSIONS)):
        return text, data
    return _Decompression(json.loads(text.decode("utf-8-sig")), data, folder).result()


def content_of(uri: str, folder: Path, kind: str) -> bytes:
    """The data of a URI, or of the file that it names.

    folder: the folder of the document. kind: kind of the data, for messages. Raises AssetError for
    an unreadable file.
    """
    if uri.startswith("data:"):
        head, _, data = uri.partition(",")
        plain = unquote_to_bytes(data)
        return base64.b64decode(plain) if head.endswith(";base64") else plain
    name = text_with_names(unquote_to_bytes(uri)).decode()
    path = path_beside(folder, name)
    try:
        return read_file(path, kind=kind, most=MOST_MEGABYTES)
    except AssetError as error:
        raise AssetError(f"its {kind} {named(name)}: {error}") from None


class Buffers:
    """The buffers of a glTF file: its binary data, data in its text, and other files."""

    def __init__(self, uris: Sequence[str | None], data: bytes | None, folder: Path) -> None:
        """uris: of each buffer. data: binary data of a GLB file. folder: that of the file."""
        self._uris = uris
        self._data = data
        self._folder = folder
        self._known: dict[int, bytes] = {}

    def has(self, number: int) -> bool:
        """Whether the file has a buffer's data; placeholders for decompressed data have none."""
        return self._uris[number] is not None or (number == 0 and self._data is not None)

    def part(self, number: int, start: int, length: int) -> memoryview:
        """Return bytes of a buffer; ValueError if it ends before, AssetError if it is missing."""
        data = self._bytes(number)
        if start < 0 or start + length > len(data):
            raise ValueError(f"buffer {number} ends before its data do")
        return memoryview(data)[start : start + length]

    def _bytes(self, number: int) -> bytes:
        """The bytes of a buffer."""
        uri = self._uris[number]
        if uri is not None:
            if number not in self._known:
                self._known[number] = content_of(uri, self._folder, "buffer")
            return self._known[number]
        if number == 0 and self._data is not None:
            return self._data
        raise AssetError(f"its buffer {number} is missing; export it as one file, GLB")


def _chunks_of(content: bytes) -> tuple[bytes, bytes | None]:
    """The document of a glTF or GLB file and its binary data, None if it has none."""
    if not content.startswith(b"glTF"):  # the first bytes of a GLB file
        return content, None
    version, length = struct.unpack_from("<II", content, 4)
    if version != 2:
        raise AssetError(f"is glTF {version}; export it as glTF 2.0")
    found: dict[bytes, bytes] = {}
    place = 12
    while place + 8 <= min(length, len(content)):
        size, kind = struct.unpack_from("<I4s", content, place)
        place += 8
        if place + size > len(content):
            raise ValueError("the file ends too early")
        found.setdefault(kind, content[place : place + size])  # a second chunk of a kind is ignored
        place += size
    return found[b"JSON"], found.get(b"BIN\0")


class _Decompression:
    """Decompresses the data of a document, and changes the document."""

    def __init__(self, document: dict[str, Any], data: bytes | None, folder: Path) -> None:
        self._document = document
        uris = [buffer.get("uri") for buffer in document.get("buffers", [])]
        self._buffers = Buffers(uris, data, folder)
        self._plain = bytearray()

    def result(self) -> tuple[bytes, bytes]:
        """Return the document with one buffer, and the data of this buffer."""
        for view in self._document.get("bufferViews", []):
            self._store(view, self._rows_of(view))
        for mesh in self._document.get("meshes", []):
            for primitive in mesh["primitives"]:
                self._decompress(primitive)
        self._document["buffers"] = [{"byteLength": len(self._plain)}]
        for key in ("extensionsUsed", "extensionsRequired"):
            names = self._document.pop(key, [])
            left = [name for name in names if name not in (DRACO_EXTENSION, *MESHOPT_EXTENSIONS)]
            if left:
                self._document[key] = left
        return json.dumps(self._document).encode(), bytes(self._plain)

    def _store(self, view: dict[str, Any], rows: bytes) -> None:
        """Add bytes to the buffer of the result, and make a buffer view refer to them."""
        self._plain += b"\0" * (-len(self._plain) % 4)
        view.update(buffer=0, byteOffset=len(self._plain), byteLength=len(rows))
        self._plain += rows

    def _rows_of(self, view: dict[str, Any]) -> bytes:
        """The bytes of a buffer view, without the compression by meshopt."""
        name = next(
            (each for each in MESHOPT_EXTENSIONS if each in view.get("extensions", {})), None
        )
        if name is None:
            return self._stored(view)
        packed = view["extensions"].pop(name)
        if self._buffers.has(view["buffer"]):
            return self._stored(view)
        decoder = _package("meshopt", name)
        count = packed["count"]
        stride = packed["byteStride"]
        most_bytes = 400_000_000  # of all data: small files may contain endless zeros
        if min(count, stride) < 0 or len(self._plain) + count * stride > most_bytes:
            raise AssetError(
                f"has more than {most_bytes // 1_000_000} MB of data that are compressed ({name}); "
                "reduce the mesh in a modelling program"
            )
        if not count:
            return b""
        decoded: npt.NDArray[Any] = decoder.decode_gltf_buffer(
            self._stored(packed), count, stride, packed["mode"], packed.get("filter")
        )
        return decoded.tobytes()

    def _stored(self, view: dict[str, Any]) -> bytes:
        """The bytes to which a buffer view, or its compression, refers."""
        start = view.get("byteOffset", 0)
        return bytes(self._buffers.part(view["buffer"], start, view["byteLength"]))

    def _decompress(self, primitive: dict[str, Any]) -> None:
        """Decompress a primitive that Draco compresses, unless it has uncompressed data, too."""
        packed = primitive.get("extensions", {}).pop(DRACO_EXTENSION, None)
        if packed is None:
            return
        accessors = self._document["accessors"]
        missing = {}
        for name in packed["attributes"]:
            accessor = accessors[primitive["attributes"][name]]
            if "bufferView" not in accessor:
                missing[name] = accessor
        indices = accessors[primitive["indices"]] if "indices" in primitive else None
        if indices is not None and "bufferView" in indices:
            indices = None
        if not missing and indices is None:
            return
        decoder = _package("DracoPy", DRACO_EXTENSION)
        view = self._document["bufferViews"][packed["bufferView"]]
        start = view["byteOffset"]
        mesh = decoder.decode(bytes(self._plain[start : start + view["byteLength"]]))
        rows = {each["unique_id"]: each["data"] for each in mesh.attributes}
        for name, accessor in missing.items():
            self._fill(accessor, rows[packed["attributes"][name]])
        if indices is not None:
            primitive["mode"] = 4  # triangles, also if the file has a strip
            self._fill(indices, mesh.faces.reshape(-1, 1))

    def _fill(self, accessor: dict[str, Any], rows: npt.NDArray[Any]) -> None:
        """Store the rows of an accessor (n, width), each in a multiple of four bytes."""
        if len(rows) > 3 * MOST_FILE_VERTICES:
            raise AssetError(f"has {len(rows)} compressed rows; reduce it in a modelling program")
        kind = np.dtype(TYPE_OF_COMPONENT[accessor["componentType"]])
        stored = np.ascontiguousarray(rows.reshape(len(rows), -1).astype(kind))
        if "min" in accessor and len(stored):  # Draco rounds places, and so moves their bounds
            accessor["min"] = stored.min(axis=0).tolist()
            accessor["max"] = stored.max(axis=0).tolist()
        width = stored.shape[1] * kind.itemsize
        view: dict[str, Any] = {}
        if stored.shape[1] > 1 and width % 4:
            bytes_of = stored.view(np.uint8)
            stored = np.pad(bytes_of, ((0, 0), (0, -width % 4)))
            view["byteStride"] = stored.shape[1]
        self._store(view, stored.tobytes())
        views = self._document["bufferViews"]
        views.append(view)
        accessor.pop("byteOffset", None)
        accessor.update(bufferView=len(views) - 1, count=len(rows))


def _package(module: str, extension: str) -> Any:
    """Import the package that decompresses an extension's data."""
    try:
        return import_module(module)
    except ModuleNotFoundError:
        raise AssetError(
            f"is compressed ({extension}), which needs {module}; install it in the checkout: pip "
            "install '.[compression]', or export it without compression"
        ) from None
