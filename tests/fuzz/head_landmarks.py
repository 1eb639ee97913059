"""Odd and broken landmark files, beside the built-in head as a mesh file; and odd heads."""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from risorius import assets

from .head_inputs import Brought, Kind, OddHead

HEAD = assets.load("head")
NUMBERS = HEAD.landmarks.tolist()
POINTS = HEAD.vertices[HEAD.landmarks].tolist()


@cache
def head_obj() -> bytes:
    """The built-in head as an OBJ file."""
    return obj_of(HEAD.vertices, HEAD.faces)


def obj_of(vertices: Any, faces: Any) -> bytes:
    """A mesh as an OBJ file."""
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in vertices.tolist()]
    lines += [f"f {a} {b} {c}" for a, b, c in (faces + 1).tolist()]
    return "\n".join(lines).encode()


def landmarks(name: str, content: bytes | str | list[Any], expected: str | Kind) -> OddHead:
    """A landmark file beside a good mesh."""
    return head(name, head_obj, content, expected)


def head(name: str, mesh: Any, content: Any, expected: str | Kind) -> OddHead:
    """A mesh file, made when it is written, and a landmark file."""

    def write(folder: Path) -> Brought:
        brought = Brought(folder / "head.obj", folder / "head.json")
        brought.mesh.write_bytes(mesh())
        text = content if isinstance(content, bytes | str) else json.dumps(content)
        (folder / "head.json").write_bytes(text if isinstance(text, bytes) else text.encode())
        return brought

    if isinstance(expected, Kind):
        return OddHead(name, write, expected)
    return OddHead(name, write, Kind.REFUSED, expected)


def _with(entries: list[Any], **places: Any) -> list[Any]:
    changed = list(entries)
    for place, entry in places.items():
        changed[int(place[1:])] = entry
    return changed


def _text(entry: str) -> str:
    """The numbers as JSON with the fourth one written so."""
    return json.dumps(_with(NUMBERS, _3="HERE")).replace('"HERE"', entry)


def _moved(where: int, to: Any) -> Any:
    def mesh() -> bytes:
        vertices = HEAD.vertices.copy()
        vertices[where] = to
        return obj_of(vertices, HEAD.faces)

    return mesh


def _scaled(scale: float, shift: float = 0.0) -> Any:
    return lambda: obj_of(HEAD.vertices * scale + shift, HEAD.faces)


BACK = int(np.argmin(HEAD.vertices[:, 2]))
WRONG_KIND = "every landmark must be a vertex number, or every one a point"
RANGE = "must be a number from -1e.09 to 1e.09"
DEEP = "[" * 100_000

GOOD = {
    "landmark numbers": {"landmarks": NUMBERS},
    "landmark points": {"landmarks": POINTS},
    "other key": {"marks": NUMBERS, "name": "anna", "unit": ["mm"]},
    "longer list beside other key": {"marks": NUMBERS, "weights": [0.0] * 500},
    "numbers utf-8 mark": b"\xef\xbb\xbf" + json.dumps(NUMBERS).encode(),
    "numbers utf-16": json.dumps(NUMBERS).encode("utf-16"),
    "whole numbers as points": [[round(x) for x in point] for point in POINTS],
    "key twice": f'{{"landmarks": [1], "landmarks": {json.dumps(NUMBERS)}}}',
}

BAD: dict[str, tuple[Any, str]] = {
    "no bytes": ("", "is empty; it must be a landmark file"),
    "cut": (json.dumps(NUMBERS)[:50], "not valid JSON: .*; it must be"),
    "deep": (DEEP, "not valid JSON: brackets are nested too deep"),
    "deep landmark": ([*NUMBERS[:67], json.loads("[" * 500 + "]" * 500)], WRONG_KIND),
    "long": (json.dumps(NUMBERS) + " " * 1_000_000, "has 1 MB; a landmark file may have 1 MB"),
    "no list": ({"landmarks": 68}, "holds no list"),
    "one less": (NUMBERS[:67], "67 landmarks; it must be the 68"),
    "two lists": ({"a": NUMBERS, "b": NUMBERS}, "holds 2 lists of 68; call the right one"),
    "beyond": (_with(NUMBERS, _5=10**7), "'landmark 5': was 10000000, must be a whole"),
    "400 digits": (_with(NUMBERS, _3=10**400), r"'landmark 3': was 1000\d*\.\.\.\d+, must be"),
    "5000 digits": (_text("9" * 5000), "not valid JSON: a number has thousands of digits"),
    "fraction": (_with(NUMBERS, _3=4.5), WRONG_KIND),
    "all true": ([True] * 68, f"'landmark 0': was True, .*{WRONG_KIND}"),
    "null landmark": ([None] * 68, "landmark 0 is null: not marked yet, as 68 of 68"),
    "long word": (["x" * 10_000] * 68, f"'landmark 0': was 'x+...x+', .*{WRONG_KIND}"),
    "mixed": (_with(POINTS, _67=5), f"'landmark 67': was 5, .*{WRONG_KIND}"),
    "point of four": (_with(POINTS, _8=[1.0, 2.0, 3.0, 1.0]), WRONG_KIND),
    "point of lists": ([[[1.0], [2.0], [3.0]]] * 68, WRONG_KIND),
    "nan point": (_with(POINTS, _8=[float("nan"), 0.0, 0.0]), f"'landmark 8' 1: was nan, {RANGE}"),
    "point at 1e300": (_with(POINTS, _8=[1e300, 0.0, 0.0]), RANGE),
    "point at 1e8": (_with(POINTS, _8=[1e8, 0.0, 0.0]), "landmark 8 lies 1e.08 units off the mesh"),
    "all at one": ([NUMBERS[0]] * 68, "all landmarks are one point"),
    "mouth corners alike": (_with(NUMBERS, _54=NUMBERS[48]), "landmarks 48 and 54 are 0 mm apart"),
    "eye corners alike": (_with(NUMBERS, _39=NUMBERS[36]), "landmarks 36 and 39 are 0 mm apart"),
    "other order": (NUMBERS[::-1], "head.obj: (the landmarks are no face|left and right)"),
}

HEADS = (
    head("head in micrometres", _scaled(1e3), NUMBERS, Kind.HEAD),
    head("head in kilometres", _scaled(1e-6), NUMBERS, Kind.HEAD),
    head("head far away", _scaled(1e-3, 1e7), NUMBERS, Kind.HEAD),
    head("head of no size", _scaled(1e-300), NUMBERS, "landmarks lie within .*; allowed are 1e-09"),
    head("head too far away", _scaled(1.0, 1e10), NUMBERS, "vertex 0 .* must be finite numbers up"),
    head("vertex at 1e8", _moved(BACK, 1e8), NUMBERS, r"lies 1.73e\+05 m off the face; allowed"),
    head("landmark at 1e8", _moved(NUMBERS[30], 1e8), NUMBERS, "landmarks are no face"),
    head("vertex at 1e300", _moved(BACK, 1e300), NUMBERS, "must be finite numbers up to"),
    head("vertex at nan", _moved(BACK, np.nan), NUMBERS, "must be finite numbers up to"),
    head("flat head", _moved((slice(None), 2), 0.0), NUMBERS, "the right eye has no opening|face"),
    head("one place", _moved(slice(None), 1.0), NUMBERS, "all landmarks are one point"),
    head("triangle of no area", _moved(HEAD.faces[-1], HEAD.vertices[BACK]), NUMBERS, Kind.HEAD),
    head("few triangles", lambda: obj_of(HEAD.vertices, HEAD.faces[:99]), NUMBERS, "99 triangles"),
)

INPUTS: tuple[OddHead, ...] = (
    *(landmarks(name, content, Kind.HEAD) for name, content in GOOD.items()),
    *(landmarks(f"bad/{name}", content, says) for name, (content, says) in BAD.items()),
    *HEADS,
)
