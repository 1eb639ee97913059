"""Make a folder of reference data from a checkout of ICT-FaceKit: `risorius bench reference`.

ICT-FaceKit (USC Institute for Creative Technologies, MIT licence) has one head as OBJ files of the
same topology: neutral, in many expressions, and moved along each of its principal components of
identity. Their first 9409 vertices are the face. Written are

    face.npz         vertices (V, 3), triangles (F, 3), landmarks68 (68,), and for each expression
                     of SHAPES the displacement of its vertices at full strength (V, 3); centimetres
    coarse_2029.npz  a decimation: triangles (M, 3), vertices (N, 3), and where each of these lies
                     on the face: fine_triangle (N,), barycentric (N, 3)
    identities.npz   person_1 to person_5, drawn at random: vertices (V, 3)
    LICENSE          that of the checkout
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
from risorius.app.errors import UserError, needed
from risorius.app.files import check_file, written_atomically
from risorius.assets.fitting.landmark_file import read_landmarks
from risorius.assets.wavefront import read_obj
from risorius.geometry.closest import closest_points

from .subjects import COARSE, DENSE, PERSONS

Points = npt.NDArray[np.float64]
Faces = npt.NDArray[np.int64]
Arrays = Mapping[str, npt.NDArray[np.generic]]

MODEL = "FaceXModel"
NEUTRAL = "generic_neutral_mesh"
FACE_VERTICES = 9409
LICENCE = "LICENSE"
MOST = 500_000  # vertices and triangles of a file
BOTH_SIDES = (
    *("browInnerUp", "browDown", "noseSneer", "eyeBlink", "mouthFrown", "mouthStretch"),
    *("mouthLowerDown", "cheekPuff", "eyeSquint", "eyeWide"),
)
SHAPES = (
    *("mouthSmile_L", "mouthSmile_R", "jawOpen"),
    *(f"{name}_{side}" for name in BOTH_SIDES for side in "LR"),
    *("mouthPucker", "jawLeft", "mouthFunnel", "mouthRollLower"),
)
"""The expressions that are measured with."""
COARSE_TRIANGLES = 2029
BORDER_WEIGHT = 10.0
"""How much a border counts: eyes and mouth keep their outlines. With more, the rest gets worse."""
PERSON_COUNT = 5
SEED = 2003
LANDMARKS = re.compile(r"\b\d+(?:\s*,\s*\d+){67}\b")
"""The 68 vertex numbers, as the checkout's README has them."""


def make(checkout: Path, folder: Path, landmarks: Path | None = None) -> list[str]:
    """Write the files into `folder`; returns a line for each of them, and for what is missing.

    landmarks: a file with the 68 landmarks, where the checkout has no README that names them.
    Raises UserError or AssetError for a checkout that is none, and OSError.
    """
    for name in (DENSE, COARSE, PERSONS, LICENCE):
        check_file(folder / name)
    head, corners = _read(checkout, NEUTRAL)
    neutral = head[:FACE_VERTICES]
    triangles = corners[(corners < len(neutral)).all(axis=1)].astype(np.int32)
    fields = {
        name: (_positions(checkout, name, len(head)) - head)[: len(neutral)]
        for name in SHAPES
        if _file(checkout, name) is not None
    }
    if not fields:
        raise UserError(f"{checkout / MODEL}: has none of the expressions {', '.join(SHAPES)}")
    numbers = _landmarks(checkout, landmarks, assets.Mesh(neutral, triangles))
    found: dict[str, Arrays] = {
        DENSE: {
            "vertices": neutral.astype(np.float32),
            "triangles": triangles,
            "landmarks68": numbers,
            **{name: field.astype(np.float32) for name, field in fields.items()},
        },
        COARSE: decimated(neutral, triangles, COARSE_TRIANGLES),
        PERSONS: _persons(checkout, head, len(neutral)),
    }
    lines = []
    for name, arrays in found.items():
        if arrays:
            _save(folder / name, arrays)
            lines.append(f"{folder / name}: {', '.join(arrays)}")
    missing = [name for name in SHAPES if name not in fields]
    if missing:
        lines.append(f"not in the checkout: {', '.join(missing)}")
    licence = checkout / LICENCE
    if licence.is_file():
        with written_atomically(folder / LICENCE) as part:
            part.write_bytes(licence.read_bytes())
    return lines


def decimated(vertices: Points, triangles: npt.NDArray[np.int32], count: int) -> Arrays:
    """Reduce a mesh to `count` triangles, or one or two less: VTK's quadric edge collapse.

    Garland and Heckbert 1997. It leaves vertices beside the surface; each is put onto the nearest
    point, so that whatever moves the dense mesh moves the coarse one, too. Raises UserError without
    PyVista, and for a mesh that has no more than that.
    """
    pyvista = needed("pyvista", "decimation", "peers", package="PyVista")
    if len(triangles) <= count:
        raise UserError(f"the face has {len(triangles)} triangles, and {count} are to be left")
    dense = pyvista.PolyData.from_regular_faces(vertices, triangles)
    coarse = dense.decimate(1.0 - count / len(triangles), boundary_weight=BORDER_WEIGHT)
    found = closest_points(coarse.points, vertices, triangles)
    return {
        "triangles": coarse.regular_faces.astype(np.int32),
        "fine_triangle": found.triangles.astype(np.int32),
        "barycentric": found.weights.astype(np.float32),
        "vertices": found.interpolate(vertices).astype(np.float32),
    }


def _file(checkout: Path, name: str) -> Path | None:
    """The OBJ file of that name, packed or not."""
    files = (checkout / MODEL / f"{name}{suffix}" for suffix in (".obj", ".obj.gz"))
    return next((file for file in files if file.is_file()), None)


def _read(checkout: Path, name: str) -> tuple[Points, Faces]:
    """Vertices and triangles of an OBJ file; polygons are fans."""
    file = _file(checkout, name)
    if file is None:
        raise UserError(
            f"{checkout}: has no {MODEL}/{name}.obj; it must be a checkout of ICT-FaceKit"
        )
    try:
        content = file.read_bytes()
        surface = read_obj(gzip.decompress(content) if file.suffix == ".gz" else content, most=MOST)
        return surface.vertices, surface.faces
    except (assets.AssetError, EOFError, gzip.BadGzipFile, zlib.error) as error:
        raise UserError(f"{file}: {error}") from None


def _positions(checkout: Path, name: str, count: int) -> Points:
    """Vertices of an OBJ file, `count` of them."""
    positions, _ = _read(checkout, name)
    if len(positions) != count:
        raise UserError(
            f"{_file(checkout, name)}: has {len(positions)} vertices, the neutral head {count}"
        )
    return positions


def _landmarks(checkout: Path, file: Path | None, mesh: assets.Mesh) -> npt.NDArray[np.int32]:
    """The 68 landmarks as vertex numbers, from a file or the README of the checkout."""
    if file is not None:
        return read_landmarks(file, mesh)[0]
    readme = checkout / "README.md"
    found = LANDMARKS.search(readme.read_text("utf-8", "replace")) if readme.is_file() else None
    if found is None:
        raise UserError(
            f"{readme}: names no 68 landmarks; give a file with them, --landmarks LANDMARKS.json"
        )
    numbers = np.array(found[0].split(","), dtype=np.int32)
    if numbers.max() >= len(mesh.vertices):
        raise UserError(f"{readme}: landmark {numbers.max()} is no vertex of the face")
    return numbers


def _persons(checkout: Path, head: Points, count: int) -> dict[str, npt.NDArray[np.float32]]:
    """Some who do not exist: the neutral face along all components, each a normal random number.

    The model is scaled so that 1 is one standard deviation. Empty without components.
    """
    names = [name for k in range(1000) if _file(checkout, name := f"identity{k:03d}") is not None]
    if not names:
        return {}
    weights = np.random.default_rng(SEED).normal(size=(PERSON_COUNT, len(names)))
    persons = np.repeat(head[None, :count], PERSON_COUNT, axis=0)
    for name, weight in zip(names, weights.T, strict=True):
        component = (_positions(checkout, name, len(head)) - head)[:count]
        persons += weight[:, None, None] * component
    return {f"person_{k + 1}": each.astype(np.float32) for k, each in enumerate(persons)}


def _save(target: Path, arrays: Arrays) -> None:
    with written_atomically(target) as part:
        np.savez_compressed(part, allow_pickle=False, **arrays)
