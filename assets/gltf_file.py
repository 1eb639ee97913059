"""Access to a glTF file: its document, the values of accessors, the files of pictures.

pygltflib reads the document. The data are in the GLB file itself, in text within the document, or
in files beside it; gltf_content.py decompresses them. Numbers are returned decoded: normalized
integers become fractions, sparse rows are filled in, and interleaved rows are separated.

Source: Khronos Group, "glTF 2.0 Specification", sections 3.6 and 4, and its registry of extensions.
Differs from it: an accessor of matrices holds only matrices of 4 x 4 floats.
"""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from ..geometry.arrays import Floats64
from .errors import AssetError
from .gltf_content import TYPE_OF_COMPONENT, Buffers, content_of, decompressed_chunks
from .user_files import MOST_FILE_VERTICES, named


class GltfFile:
    """A glTF file; if it is broken, methods may raise any error, not only AssetError.

    document: a pygltflib document, without animations and extras.
    """

    def __init__(self, content: bytes, folder: Path) -> None:
        """content: bytes of the file. folder: its folder, which may hold files that it names.

        Raises AssetError with the names of required extensions that are not supported.
        """
        import pygltflib  # imported late, so that loading the built-in head is fast

        text, data = decompressed_chunks(content, folder)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # pygltflib would print them
            self.document = pygltflib.GLTF2.from_json(
                text.decode("utf-8-sig"), infer_missing=True, object_hook=_for_pygltflib
            )
        self._folder = folder
        self._buffers = Buffers([each.uri for each in self.document.buffers or []], data, folder)
        version = str(self.document.asset.version)
        if not version.startswith("2."):
            raise AssetError(f"is glTF {named(version)}; export it as glTF 2.0")
        # Extensions that a file may require: for numbers, and for looks only, by beginnings of
        # names.
        readable = (
            *("KHR_mesh_quantization", "KHR_texture_", "EXT_texture_", "MSFT_texture_"),
            *("KHR_materials_", "KHR_lights_", "EXT_lights_", "KHR_xmp"),
        )
        for name in self.document.extensionsRequired or []:
            if not str(name).startswith(readable):
                raise AssetError(
                    f"needs the extension {named(name)}, which is not read here; export it without"
                )

    def values(self, number: int) -> npt.NDArray[Any]:
        """Return an accessor's rows (count, width); normalized integers and floats as float64."""
        accessor = self.document.accessors[number]
        kind = np.dtype(TYPE_OF_COMPONENT[accessor.componentType])
        widths = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}
        width = widths[accessor.type]
        most_rows = 3 * MOST_FILE_VERTICES
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
        return fractions(rows) if accessor.normalized else rows

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
        indices = sparse.indices
        kind = np.dtype(TYPE_OF_COMPONENT[indices.componentType])
        where = self._rows(indices.bufferView, indices.byteOffset, kind, (sparse.count, 1))[:, 0]
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
        return self._buffers.part(view.buffer, view.byteOffset or 0, view.byteLength)


def entry(part: Any, name: str) -> Any:
    """An entry of a part of the document: an object of pygltflib or, in extensions, a mapping."""
    return part.get(name) if isinstance(part, Mapping) else getattr(part, name, None)


def fractions(rows: npt.NDArray[Any]) -> Floats64:
    """Integers as fractions of their greatest value: 0 to 1, or signed -1 to 1."""
    greatest = np.iinfo(rows.dtype).max
    return np.maximum(rows.astype(np.float64) / greatest, -1.0)


def _for_pygltflib(entries: Mapping[str, Any]) -> dict[str, Any]:
    """An object of the document in a form that pygltflib can hold.

    pygltflib takes extras only as objects, and has no weights of nodes, which are put into the
    extras. Animations are not read: there may be thousands.
    """
    kept = {key: value for key, value in entries.items() if key not in ("extras", "animations")}
    if "mesh" in entries and "weights" in entries:
        kept["extras"] = {"weights": entries["weights"]}
    return kept
