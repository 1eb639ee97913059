"""What lies under the skin of a head that is opened: skull, cartilage of the nose, throat.

They ship as data (`data/skull.npz`). Programs of revision f4bd608f (`assets/skull.py`,
`assets/throat.py`) carved them from the skin that the built-in head then had, moved inward by the
depth of its bone, by measures of an adult skull; they are a proxy. Landmarks and directions of the
scalp carry them to another head, and the cranium is pushed in where it would leave the skin.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import scipy

from risorius.geometry.normals import vertex_normals

from ..data_files import read_arrays
from ..loading import load
from ..model import FloatArray, Part
from ..topology import boundary_loops, grid_faces
from .warp import ThinPlateSpline

FILE = Path(__file__).parents[1] / "data" / "skull.npz"
STEP = 0.02  # [mm] of the places in it
NAMES = "cranium", "mandible", "spine", "nose", "throat"
BONES = {"nose": "cranium", "throat": "cranium", "spine": "neck"}  # others move with their own
SHINE = 0.28
BONE = np.array([0.34, 0.235, 0.165]), np.array([0.90, 0.85, 0.735])  # sRGB: in hollows, outside
COLOURS = {
    "nose": (np.array([0.50, 0.42, 0.40]), np.array([0.80, 0.82, 0.80])),
    "throat": (np.array([0.10, 0.035, 0.035]), np.array([0.36, 0.13, 0.12])),
}
BROWS = slice(17, 27)  # landmarks
CROWN, OCCIPUT, EARS = 55.0, -20.0, 65.0  # [mm] above and behind there are none; ears lie aside
NAPE = -40.0  # [mm] below it lies no cranium
WITHIN = np.array([0.0, 40.0, 0.0])  # [mm] over the condyles, from where directions are told
BACK, COVERED, BESIDE = 28.0, 2.0, 40.0  # [mm] behind condyles; skin on bone; to skin that tells
AROUND, SOFT, ASIDE = 6, 10.0, 0.01  # vertices near by; [mm] of a soft edge; 1 - cosine
FAT, FLESH = np.array([0.82, 0.62, 0.42]), np.array([0.50, 0.17, 0.15])
RINGS = (0.0, FLESH), (0.5, FLESH), (0.93, FLESH), (0.95, FAT), (1.0, FAT)  # how far out; colour


def build_skull(
    head: Any, pivots: Mapping[str, FloatArray], names: Collection[str] = NAMES
) -> dict[str, Part]:
    """Parts under the skin at rest, which move with their bones; names: of NAMES, all unless told.

    head: with vertices, faces and landmarks. pivots: what "mandible" turns about, (3,).
    Raises AssetError where the file is missing or broken.
    """
    arrays = read_arrays(FILE)
    known = arrays["skin"]
    kept, own = load("head").landmarks, head.landmarks
    bare = np.arange(len(head.vertices))
    is_far = (known[:, 1] > CROWN) | (known[:, 2] < OCCIPUT) & (abs(known[:, 0]) < EARS)
    if hasattr(head, "anatomy"):  # made of the built-in head's vertices
        ears = [row for name, row in load("head").rings.items() if "ear_" in name]
        bare = np.setdiff1d(bare, np.concatenate(ears))  # bone lies under no ear
        named = [at for name, at in head.anatomy.items() if not name.startswith("tragion")]
        kept = own = np.concatenate([own, named, np.flatnonzero(is_far)])
    else:  # what lies in the same directions from within its cranium
        far = np.flatnonzero(is_far & (known[:, 1] > NAPE))
        ways, seen = known[far] - arrays["condyles"], head.vertices - pivots["mandible"]
        apart = scipy.spatial.distance.cdist(ways - WITHIN, seen - WITHIN, "cosine")
        is_seen = apart.min(axis=1) < ASIDE
        kept, own = np.append(kept, far[is_seen]), np.append(own, apart.argmin(axis=1)[is_seen])
    warp = ThinPlateSpline(
        np.vstack([known[kept], arrays["condyles"]]),
        np.vstack([head.vertices[own], pivots["mandible"]]),
    )
    skin, normals = head.vertices[bare], vertex_normals(head.vertices, head.faces)[bare]
    parts = {}
    for name in names:
        faces = arrays[f"{name}_faces"].T.astype(np.int32)  # steps from the first corners
        faces[:, 0] = np.cumsum(faces[:, 0])
        faces[:, 1:] += faces[:, :1]
        points = warp.points(STEP * arrays[f"{name}_vertices"].T)
        if name == "cranium":  # what is named says little of its top, back and sides
            away, near = scipy.spatial.cKDTree(skin).query(points, k=AROUND)
            shares = 1.0 / np.maximum(away, 1.0) ** 2
            above = points[:, 1] - head.vertices[head.landmarks[BROWS], 1].max()
            behind = pivots["mandible"][2] - BACK - points[:, 2]
            free = np.clip(np.maximum(above, behind) / SOFT, 0.0, 1.0) * (away[:, 0] < BESIDE)
            shares *= (free / shares.sum(axis=1))[:, None]
            out = ((points[:, None] - skin[near]) * normals[near]).sum(axis=2) + COVERED
            points -= np.einsum("nk,nkc->nc", shares * np.maximum(out, 0.0), normals[near])
        dark, bright = COLOURS.get(name, BONE)
        light = arrays[f"{name}_light"][:, None] / 255.0
        title = name if name == "throat" else f"skull_{name}"
        parts[name] = _part(title, points, faces, dark + light * (bright - dark), name)
    return parts


def neck_sections(head: Any) -> list[Part]:
    """What closes the ends of a neck, seen from above; head: with vertices, faces, landmarks."""
    chin = head.vertices[head.landmarks[8], 1]
    parts = []
    for loop in boundary_loops(head.faces):
        edge = head.vertices[loop]
        if edge[:, 1].max() < chin:
            middle = edge.mean(axis=0)
            points = np.concatenate([middle + share * (edge - middle) for share, _ in RINGS])
            faces = grid_faces(np.arange(len(points)).reshape(len(RINGS), -1), closed=True)
            colours = np.repeat([colour for _, colour in RINGS], len(loop), axis=0)
            parts.append(_part("neck_section", points, faces, colours, "neck"))
    return parts


def _part(name: str, points: FloatArray, faces: Any, colours: FloatArray, bone: str) -> Part:
    places, normals, inks = (
        each.astype(np.float32) for each in (points, vertex_normals(points, faces), colours)
    )
    return Part(name, places, normals, faces, inks, BONES.get(bone, bone), SHINE)
