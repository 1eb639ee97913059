"""What a GLB file claims in its JSON part, checked before trimesh allocates and copies by it.

One piece of data may be named by many accessors, one mesh by many nodes, and an accessor may have
no data at all: a file of a kilobyte can ask for all memory there is.

Source: Khronos 2021, "glTF 2.0 Specification", sections 3.6 (data), 3.7 (meshes), 4 (GLB).
"""

import json
import struct
from operator import mul
from types import MappingProxyType
from typing import Any

from .errors import AssetError
from .user_files import MOST_VERTICES, size_text

LONGEST_JSON = 4_000_000  # [bytes]
MOST_ENTRIES = 10_000  # of nodes, meshes, accessors and so on, each
MOST_PIECES = 1000  # meshes placed in the scene, each piece of them counted
# Overlapping views are allowed, but what is named twice over is copied twice over.
MOST_COPIES = 4  # of the length of the file
BYTES = MappingProxyType({5120: 1, 5121: 1, 5122: 2, 5123: 2, 5125: 4, 5126: 4})  # of a number
NUMBERS = MappingProxyType(  # of an item
    {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT3": 9, "MAT4": 16}
)
NOT_READ = ("KHR_draco_mesh_compression", "EXT_meshopt_compression")


def check_glb(content: bytes) -> bytes:
    """GLB: sizes must be those of the file, and what is to come out must be allowed."""
    document = _document(content)
    packed = [name for name in NOT_READ if name in _names(document, "extensionsRequired")]
    if packed:
        raise AssetError(f"is compressed ({packed[0]}); export it without compression")
    for row in _rows(document, "buffers"):
        uri = row.get("uri", "data:")
        if not (isinstance(uri, str) and uri.startswith("data:")):
            raise AssetError("has its data in other files; export it as one GLB file")
    views = _rows(document, "bufferViews")
    _check_copies(sum(_count(row, "byteLength") for row in views), len(content))
    accessors = _rows(document, "accessors")
    for row in accessors:
        if "bufferView" not in row:
            raise AssetError("has an accessor without data; export it without compression")
    counts = [_count(row, "count") for row in accessors]
    _check_copies(sum(map(mul, counts, map(_item_size, accessors))), len(content))
    _check_pieces(document, counts)
    return content


def _document(content: bytes) -> dict[str, Any]:
    """The JSON part."""
    if len(content) < 20 or content[:4] != b"glTF":
        raise AssetError("is no GLB file: it must begin with 'glTF'; export it as GLB")
    version, length, size = struct.unpack_from("<III", content, 4)
    if version != 2:
        raise AssetError(f"is glTF of version {version}; it must be version 2")
    if length > len(content) or 20 + size > len(content):
        raise AssetError(
            f"has {size_text(len(content))} of {size_text(max(length, 20 + size))}: it was cut "
            "off; export it anew"
        )
    if size > LONGEST_JSON:
        raise AssetError(
            f"has {size_text(size)} of JSON; allowed are {size_text(LONGEST_JSON)}: keep data in "
            "the binary part"
        )
    try:
        document = json.loads(content[20 : 20 + size])
    except (ValueError, RecursionError) as error:
        raise AssetError(f"its JSON part is broken ({error}); export it anew") from None
    if not isinstance(document, dict):
        raise AssetError("its JSON part is broken (no object); export it anew")
    return document


def _names(document: dict[str, Any], key: str) -> list[Any]:
    found = document.get(key, [])
    if not isinstance(found, list) or len(found) > MOST_ENTRIES:
        raise AssetError(f"its '{key}' must be a list of at most {MOST_ENTRIES}; export it anew")
    return found


def _rows(document: dict[str, Any], key: str) -> list[dict[str, Any]]:
    rows = _names(document, key)
    if not all(isinstance(row, dict) for row in rows):
        raise AssetError(f"its '{key}' must be a list of objects; export it anew")
    return rows


def _count(row: dict[str, Any], key: str) -> int:
    number = row.get(key)
    if not isinstance(number, int) or isinstance(number, bool) or not 0 <= number < 2**31:
        raise AssetError(f"has a '{key}' that is no count; export it anew")
    return number


def _item_size(accessor: dict[str, Any]) -> int:
    """Bytes of one item."""
    try:
        return BYTES[accessor["componentType"]] * NUMBERS[accessor["type"]]
    except (KeyError, TypeError):
        raise AssetError("has an accessor of a type that glTF has not; export it anew") from None


def _check_copies(claimed: int, length: int) -> None:
    if claimed > MOST_COPIES * length:
        raise AssetError("claims more data than it has; export it anew")


def _check_pieces(document: dict[str, Any], counts: list[int]) -> None:
    """All meshes where nodes place them: pieces, vertices and triangles."""
    meshes = [_size(row, counts) for row in _rows(document, "meshes")]
    places = [row["mesh"] for row in _rows(document, "nodes") if "mesh" in row]
    if not all(isinstance(place, int) and 0 <= place < len(meshes) for place in places):
        raise AssetError("a node of it has a mesh that there is not; export it anew")
    for sizes, what, most in zip(
        zip(*meshes, *(meshes[place] for place in places), strict=True),
        ("pieces", "vertices", "corners of triangles"),
        (
            2 * MOST_PIECES,
            2 * MOST_VERTICES,
            6 * MOST_VERTICES,
        ),  # in the list of meshes, and in their places
        strict=False,
    ):
        if sum(sizes) > most:
            raise AssetError(
                f"has {sum(sizes) // 2} {what} with all its copies; allowed are {most // 2}: keep "
                "the head alone, or reduce it in a modelling program"
            )


def _size(mesh: dict[str, Any], counts: list[int]) -> tuple[int, int, int]:
    """Pieces, vertices and corners of one mesh."""
    pieces = _rows(mesh, "primitives")
    ends: list[int] = []  # vertices and corners in turn
    for piece in pieces:
        attributes = piece.get("attributes")
        position = attributes.get("POSITION") if isinstance(attributes, dict) else None
        for place in (position, piece.get("indices", position)):
            if not isinstance(place, int) or not 0 <= place < len(counts):
                raise AssetError("a mesh of it has no positions or no corners; export it anew")
            ends.append(counts[place])
    return len(pieces), sum(ends[::2]), sum(ends[1::2])


def pictures_apart(content: bytes) -> tuple[bytes, list[bytes | None]]:
    """A GLB file without pictures, and the one of colour of each material, packed as it was.

    content: a file that `check_glb` let pass. Materials are named by their numbers, "0", "1", ...
    """
    document = _document(content)
    end = 20 + struct.unpack_from("<I", content, 12)[0]
    pictures = [_picture(document, row, content[end + 8 :]) for row in _rows(document, "materials")]
    document["materials"] = [{"name": str(number)} for number in range(len(pictures))]
    for key in ("images", "textures", "samplers"):
        document.pop(key, None)
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    rest = struct.pack("<I4s", len(text), b"JSON") + text + content[end:]
    return struct.pack("<4sII", b"glTF", 2, 12 + len(rest)) + rest, pictures


def _picture(document: dict[str, Any], material: dict[str, Any], data: bytes) -> bytes | None:
    """The picture of a material's colour, if it lies in the file's binary part."""
    try:
        texture = material["pbrMetallicRoughness"]["baseColorTexture"]
        image = document["images"][document["textures"][texture["index"]]["source"]]
        view = document["bufferViews"][image["bufferView"]]
        first = view.get("byteOffset", 0)
        return data[first : first + view["byteLength"]]
    except (KeyError, IndexError, TypeError, AttributeError):
        return None
