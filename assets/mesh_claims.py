"""What a mesh file claims to hold, compared with what it does hold, before trimesh believes it.

A header of a few bytes may claim a billion vertices, or one mesh a thousand times over; and a file
that was cut off may still look like a smaller mesh. Each check returns the content in a form that
means the same and leaves nothing to guess.

Sources: Turk 1994, "The PLY Polygon File Format"; Geomview manual, "OFF"; 3D Systems 1988,
"StereoLithography Interface Specification"; for GLB see glb_claims.py.
"""

import re
import struct
from collections.abc import Callable, Mapping
from types import MappingProxyType

from .errors import AssetError
from .glb_claims import check_glb
from .user_files import MOST_VERTICES, plain_text, size_text

MOST_SOLIDS = 1000  # of one STL file
LONGEST_HEADER = 2**16  # [bytes] of a PLY file
PLY_FORMATS = (b"ascii", b"binary_little_endian", b"binary_big_endian")
STL_HEADER, STL_TRIANGLE = 84, 50  # [bytes] of a binary STL file
_BLANK_LINES = re.compile(rb"\n\s*\n|^\s+")


def check_ply(content: bytes) -> bytes:
    """PLY: the header's counts must be allowed, and as many lines must follow if it is text."""
    end = re.search(rb"end_header[ \t]*\r?\n?", content[:LONGEST_HEADER])
    if not content[:4].lower().startswith(b"ply") or end is None:
        raise AssetError("is no PLY file: it must begin with 'ply' and have an 'end_header'")
    header = plain_text(content[: end.end()]).split(b"\n")
    lines = [line.split() for line in header if line.split()]
    kind = next((fields[1] for fields in lines if fields[0] == b"format" and len(fields) > 1), b"")
    if kind not in PLY_FORMATS:
        raise AssetError("has no PLY format that is known: ascii, or binary with its byte order")
    ends = {b"": 0}  # name of an element -> number of the row behind its last one
    for fields in lines:
        if fields[0] == b"element":
            if len(fields) != 3:
                raise AssetError("its PLY header is broken: an element must have a name and count")
            count = _count(fields[2], f"element {fields[1][:20].decode()}")
            ends[fields[1]] = max(ends.values()) + count
    if kind != b"ascii":
        return b"\n".join(b" ".join(fields) for fields in lines) + b"\n" + content[end.end() :]
    text = _BLANK_LINES.sub(b"\n", plain_text(content[end.end() :])).strip()
    rows = text.split(b"\n") if text else []
    _check_rows(len(rows), max(ends.values()))
    face = next(
        (at for at, fields in enumerate(lines) if fields[:2] == [b"element", b"face"]), None
    )
    if face is not None and lines[face + 1][:2] == [b"property", b"list"]:
        last = ends[b"face"]
        _check_polygons(rows[last - int(lines[face][2]) : last])
    return b"\n".join(b" ".join(fields) for fields in lines) + b"\n" + text + b"\n"


def check_off(content: bytes) -> bytes:
    """OFF: the counts in its first lines must be allowed, and as many lines must follow."""
    text = re.sub(rb"#[^\n]*", b"", plain_text(content))
    text = _BLANK_LINES.sub(b"\n", text).strip()
    found = re.match(rb"[A-Z0-9]*OFF\s+(\S+)[ \t]+(\S+)[^\n]*(\n|$)", text)
    if found is None:
        raise AssetError("is no OFF file: it must begin with 'OFF' and two counts")
    vertex_count, face_count = _count(found[1], "vertices"), _count(found[2], "faces")
    rows = text[found.end() :].split(b"\n") if found.end() < len(text) else []
    _check_rows(len(rows), vertex_count + face_count)
    _check_polygons(rows[vertex_count : vertex_count + face_count])
    return b"OFF\n%d %d 0\n%s" % (vertex_count, face_count, text[found.end() :])


def check_stl(content: bytes) -> bytes:
    """STL, binary or text: as long as its count says, or closed with 'endsolid'."""
    if len(content) >= STL_HEADER:
        (count,) = struct.unpack_from("<I", content, STL_HEADER - 4)
        if len(content) == STL_HEADER + STL_TRIANGLE * count:
            _count(str(count).encode(), "triangles")
            return content
    if b"\0" in content:
        raise AssetError(
            f"has {size_text(len(content))}, which is no whole number of STL triangles and not "
            "what it says: it was cut off or is no STL file; save it anew"
        )
    text = plain_text(content)
    ends = text.lower().count(b"endsolid")
    if not 1 <= ends <= MOST_SOLIDS:
        raise AssetError(
            f"has {ends} lines 'endsolid'; a text STL file has 1 to {MOST_SOLIDS}: it was cut off, "
            "is no STL file, or must be joined to one solid"
        )
    return text


def _count(word: bytes, what: str) -> int:
    number = int(word) if word.isdigit() and len(word) < 12 else -1
    if not 0 <= number <= MOST_VERTICES:
        raise AssetError(
            f"claims {word[:20].decode()} for {what}; allowed are 0 to {MOST_VERTICES}: reduce it "
            "in a modelling program, or save it anew"
        )
    return number


def _check_rows(found: int, claimed: int) -> None:
    if found < claimed:
        raise AssetError(
            f"claims {claimed} vertices, faces and the like, and has {found} lines of them: it was "
            "cut off; save it anew"
        )


def _check_polygons(rows: list[bytes]) -> None:
    """Each row must have as many corners as its first number says, at least three of them."""
    triangle_count = 0
    for place, row in enumerate(rows):
        said, *corners = row.split()
        if not said.isdigit() or not 3 <= int(said[:12]) <= len(corners):
            excerpt = b" ".join([said, *corners])[:30].decode()
            raise AssetError(
                f"face {place} (counted from 0) is '{excerpt}'; it must be a count from 3 up and "
                "as many vertex numbers: save it anew"
            )
        triangle_count += int(said) - 2
        if triangle_count > MOST_VERTICES:
            raise AssetError(
                f"has more than {MOST_VERTICES} triangles; reduce it in a modelling program"
            )


CHECKS: Mapping[str, Callable[[bytes], bytes]] = MappingProxyType(
    {"glb": check_glb, "off": check_off, "ply": check_ply, "stl": check_stl}
)
