"""Make a folder of reference data from a checkout of ICT-FaceKit: `risorius bench reference`.

ICT-FaceKit (USC Institute for Creative Technologies, MIT licence) has one head as OBJ files of the
same topology: neutral, in many expressions, and moved along each of its principal components of
identity. The first 9409 vertices of each file are the face. The written files, in centimetres, are:

    face.npz            vertices (V, 3), triangles (F, 3), landmarks68 (68,), and for each
                        expression of MEASURED_SHAPES how far its vertices move at full strength
                        (V, 3)
    identity_modes.npz  modes (k, V, 3): displacement by each component at one standard deviation
    LICENSE             a copy of the checkout's licence
"""

from __future__ import annotations

import gzip
import re
import zlib
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import numpy.typing as npt

from risorius import assets
from risorius.app.errors import UserError
from risorius.app.files import check_file, written_atomically
from risorius.assets.wavefront import read_obj
from risorius.geometry.arrays import Floats32, Floats64, Integers32, Integers64

from .subjects import DENSE_FILE, MODES_FILE

MODEL_FOLDER = "FaceXModel"
FACE_VERTICES = 9409
SIDED_SHAPES = (
    *("browInnerUp", "browDown", "noseSneer", "eyeBlink", "mouthFrown", "mouthStretch"),
    *("mouthLowerDown", "cheekPuff", "eyeSquint", "eyeWide"),
)
MEASURED_SHAPES = (
    *("mouthSmile_L", "mouthSmile_R", "jawOpen"),
    *(f"{name}_{side}" for name in SIDED_SHAPES for side in "LR"),
    *("mouthPucker", "jawLeft", "mouthFunnel", "mouthRollLower"),
)
"""The expressions for measurements."""
LANDMARK_LIST = re.compile(r"\b\d+(?:\s*,\s*\d+){67}\b")
"""The heading of the 68 vertex indices in the checkout's README."""


def make(checkout: Path, folder: Path) -> list[str]:
    """Write the files into `folder`; return a line for each file and for each missing source.

    Raises UserError if `checkout` is not a checkout of ICT-FaceKit, and OSError.
    """
    licence_file = "LICENSE"
    for name in (DENSE_FILE, MODES_FILE, licence_file):
        check_file(folder / name)
    neutral_file = "generic_neutral_mesh"
    head, corners = _read(checkout, neutral_file)
    neutral = head[:FACE_VERTICES]
    triangles = corners[(corners < len(neutral)).all(axis=1)].astype(np.int32)

    def moved(name: str) -> Floats32:
        positions, _ = _read(checkout, name)
        if len(positions) != len(head):
            raise UserError(f"{checkout}: {name} has other vertices than the neutral head")
        return (positions - head)[: len(neutral)].astype(np.float32)

    fields = {name: moved(name) for name in MEASURED_SHAPES if _file(checkout, name) is not None}
    if not fields:
        raise UserError(
            f"{checkout / MODEL_FOLDER}: has none of the expressions {', '.join(MEASURED_SHAPES)}"
        )
    arrays: dict[str, Mapping[str, npt.NDArray[np.generic]]] = {
        DENSE_FILE: {
            "vertices": neutral.astype(np.float32),
            "triangles": triangles,
            "landmarks68": _landmarks(checkout / "README.md"),
            **fields,
        }
    }
    names = [f"identity{number:03d}" for number in range(1000)]
    names = [name for name in names if _file(checkout, name) is not None]
    if names:
        arrays[MODES_FILE] = {"modes": np.array([moved(name) for name in names])}
    for name, content in arrays.items():
        with written_atomically(folder / name) as part:
            np.savez_compressed(part, allow_pickle=False, **content)
    if (checkout / licence_file).is_file():
        with written_atomically(folder / licence_file) as part:
            part.write_bytes((checkout / licence_file).read_bytes())
    missing = [name for name in MEASURED_SHAPES if name not in fields]
    return [
        *(f"{folder / name}: {', '.join(content)}" for name, content in arrays.items()),
        *([f"not in the checkout: {', '.join(missing)}"] if missing else []),
    ]


def _file(checkout: Path, name: str) -> Path | None:
    """Path of the OBJ file with this name, compressed or not."""
    files = (checkout / MODEL_FOLDER / f"{name}{suffix}" for suffix in (".obj", ".obj.gz"))
    return next((file for file in files if file.is_file()), None)


def _read(checkout: Path, name: str) -> tuple[Floats64, Integers64]:
    """Vertices and triangles of an OBJ file; polygons become fans."""
    file = _file(checkout, name)
    if file is None:
        raise UserError(
            f"{checkout}: has no {MODEL_FOLDER}/{name}.obj; it must be a checkout of ICT-FaceKit"
        )
    try:
        content = file.read_bytes()
        if file.suffix == ".gz":
            content = gzip.decompress(content)
        most_elements = 500_000  # limit for vertices and for triangles
        surface = read_obj(content, most=most_elements)
        return surface.vertices, surface.faces
    except (assets.AssetError, EOFError, gzip.BadGzipFile, zlib.error) as error:
        raise UserError(f"{file}: {error}") from None


def _landmarks(readme: Path) -> Integers32:
    """The 68 landmarks as vertex indices, from the checkout's README."""
    found = LANDMARK_LIST.search(readme.read_text("utf-8", "replace")) if readme.is_file() else None
    if found is None:
        raise UserError(f"{readme}: has no list of 68 landmarks; use a checkout of ICT-FaceKit")
    return np.array(found[0].split(","), dtype=np.int32)
