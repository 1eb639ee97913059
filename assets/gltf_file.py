"""Access to a glTF file: its document, the numbers of accessors, the files of pictures.

pygltflib reads the document. The data are in the GLB file itself, in text within the document, or
in files beside it. Numbers are returned decoded: normalized integers become fractions, sparse rows
are filled in, and interleaved rows are separated.

Source: Khronos Group, "glTF 2.0 Specification", sections 3.6 and 4, and its registry of extensions.
Differs from it: an accessor of matrices holds only matrices of 4 x 4 floats.
"""

from __future__ import annotations

import base64
import struct
import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import Any
from urllib.parse import unquote_to_bytes

import numpy as np
import numpy.typing as npt

from ..geometry.arrays import Floats64
from .errors import AssetError
from .user_files import MOST_VERTICES, beside, named, read_file, text_with_names

COMPONENTS = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
DRACO = "KHR_draco_mesh_compression"
MESHOPT = ("EXT_meshopt_compression", "KHR_meshopt_compression")


class GltfFile:
    """One file. If the file is broken, each method may raise any error, not only AssetError.

    document: a pygltflib document, without animations and extras.
    """

    def __init__(self, content: bytes, folder: Path) -> None:
        """content: that of the file. folder: the file's own, which may hold further files of it.

        Raises AssetError with the names of required extensions that are not supported.
        """
        import pygltflib  # imported late, so that loading the built-in head is fast

        text, self._data = chunks_of(content)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # pygltflib would print them
            self.document = pygltflib.GLTF2.from_json(
                text.decode("utf-8-sig"), infer_missing=True, object_hook=_tidied
            )
        self._folder = folder
        self._buffers: dict[int, bytes] = {}
        version = str(self.document.asset.version)
        if not version.startswith("2."):
            raise AssetError(f"is glTF {named(version)}; export it as glTF 2.0")
        # Extensions that a file may require: for numbers, and for looks only, by beginnings of
        # names.
        readable = (
            *("KHR_mesh_quantization", "KHR_texture_", "EXT_texture_", "MSFT_texture_"),
            *("KHR_materials_", "KHR_lights_", "EXT_lights_", "KHR_xmp"),
        )
        packed_kinds = (DRACO, *MESHOPT)
        for name in self.document.extensionsRequired or []:
            if name in packed_kinds:
                raise packed(name)
            if not str(name).startswith(readable):
                raise AssetError(
                    f"needs the extension {named(name)}, which is not read here; export it without"
                )

    def values(self, number: int) -> npt.NDArray[Any]:
        """Return an accessor's rows (count, width); normalized integers and floats as float64."""
        accessor = self.document.accessors[number]
        kind = np.dtype(COMPONENTS[accessor.componentType])
        widths = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}
        width = widths[accessor.type]
        most_rows = 3 * MOST_VERTICES
        if not 0 <= accessor.count <= most_rows:
            raise AssetError(
                f"has an accessor of {accessor.count} rows; allowed are {most_rows}: reduce the "
                "mesh in a modelling program"
            )
        shape = (accessor.count, width)
        if accessor.bufferView is None:
            rows = np.zeros(shape, kind)
        else:
            rows = self._rows(accessor.bufferView, accessor.byteOffset, kind, shape)
        if accessor.sparse is not None:
            rows = self._filled_in(rows, accessor.sparse)
        if kind.kind == "f":
            return rows.astype(np.float64)
        return shares(rows) if accessor.normalized else rows

    def picture(self, number: int) -> tuple[bytes, str]:
        """The content of a picture's file, and its name."""
        image = self.document.images[number]
        if image.uri is None:
            return bytes(self._view(image.bufferView)), str(image.name or number)
        is_inside = image.uri.startswith("data:")
        name = image.name or (number if is_inside else image.uri)
        return content_of(image.uri, self._folder, "picture"), str(name)

    def _filled_in(self, rows: npt.NDArray[Any], sparse: Any) -> npt.NDArray[Any]:
        """Rows with the replacements of a sparse accessor."""
        places = sparse.indices
        kind = np.dtype(COMPONENTS[places.componentType])
        where = self._rows(places.bufferView, places.byteOffset, kind, (sparse.count, 1))[:, 0]
        shape = (sparse.count, rows.shape[1])
        filled = rows.copy()
        filled[where] = self._rows(
            sparse.values.bufferView, sparse.values.byteOffset, rows.dtype, shape
        )
        return filled

    def _rows(
        self, view: int, offset: int | None, kind: np.dtype[Any], shape: tuple[int, int]
    ) -> npt.NDArray[Any]:
        """Rows in a part of a buffer, one after another or with other data between."""
        count, width = shape
        stride = self.document.bufferViews[view].byteStride or width * kind.itemsize
        if not count:
            return np.zeros(shape, kind)
        strides = (stride, kind.itemsize)
        return np.ndarray(shape, kind, self._view(view), offset or 0, strides)

    def _view(self, number: int) -> memoryview:
        """A part of a buffer."""
        view = self.document.bufferViews[number]
        compressed = [name for name in MESHOPT if name in (view.extensions or {})]
        start = view.byteOffset or 0
        data = self._buffer(view.buffer, compressed)
        if start < 0 or start + view.byteLength > len(data):
            raise ValueError(f"buffer {view.buffer} ends before its data do")
        return memoryview(data)[start : start + view.byteLength]

    def _buffer(self, number: int, compressed: list[str]) -> bytes:
        """The bytes of a buffer; compressed: extensions that may explain their absence."""
        if number not in self._buffers:
            uri = self.document.buffers[number].uri
            if uri is not None:
                self._buffers[number] = content_of(uri, self._folder, "buffer")
            elif number == 0 and self._data is not None:
                self._buffers[number] = self._data
            elif compressed:
                raise packed(compressed[0])
            else:
                raise AssetError(f"its buffer {number} is missing; export it as one file, GLB")
        return self._buffers[number]


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
    path = beside(folder, name)
    try:
        most_megabytes = 100
        return read_file(path, kind=kind, most=most_megabytes)
    except AssetError as error:
        raise AssetError(f"its {kind} {named(name)}: {error}") from None


def entry(part: Any, name: str) -> Any:
    """An entry of a part of the document: an object of pygltflib or, in extensions, a mapping."""
    return part.get(name) if isinstance(part, Mapping) else getattr(part, name, None)


def shares(rows: npt.NDArray[Any]) -> Floats64:
    """Integers as fractions of their greatest value: 0 to 1, or signed -1 to 1."""
    greatest = np.iinfo(rows.dtype).max
    return np.maximum(rows.astype(np.float64) / greatest, -1.0)


def packed(name: str) -> AssetError:
    """Return the error for a mesh that an extension compresses."""
    return AssetError(f"is compressed ({name}); export it without compression")


def chunks_of(content: bytes) -> tuple[bytes, bytes | None]:
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


def _tidied(entries: Mapping[str, Any]) -> dict[str, Any]:
    """An object of the document in a form that pygltflib can hold.

    pygltflib takes extras only as objects, and has no weights of nodes, which are put into the
    extras. Animations are not read: there may be thousands.
    """
    kept = {key: value for key, value in entries.items() if key not in ("extras", "animations")}
    if "mesh" in entries and "weights" in entries:
        kept["extras"] = {"weights": entries["weights"]}
    return kept
