"""Build the parts under the skin of an opened head: skull, cartilage of the nose, throat.

The parts are data of the package (`data/skull.npz`), and not from a scan. Programs of revision
f4bd608f (`assets/skull.py`, `assets/throat.py`) made them from the built-in skin of that time. The
programs moved the skin inward by the depth of bone, and used measures of an adult skull. A warp by
landmarks, and by directions of the scalp, fits the parts to another head. Where the cranium would
leave the skin, it is pushed inward.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import scipy

from ...geometry.arrays import Floats64
from ...geometry.normals import vertex_normals
from ..data_files import read_arrays
from ..loading import load
from ..model import Part
from ..topology import boundary_loops, grid_faces
from .warp import ThinPlateSpline

FAT_COLOUR = np.array([0.82, 0.62, 0.42])  # sRGB
FLESH_COLOUR = np.array([0.50, 0.17, 0.15])  # sRGB


def build_skull(head: Any, pivots: Mapping[str, Floats64]) -> dict[str, Part]:
    """Build skull, spine, nose and throat under the skin at rest: name -> part.

    head: any object with vertices (V, 3) [mm], faces (F, 3) and landmarks (68,). pivots: "mandible"
    -> the points around which it turns [mm]. If the file is missing or broken, raises AssetError.
    """
    file = Path(__file__).parents[1] / "data" / "skull.npz"
    arrays = read_arrays(file)
    known = arrays["skin"]
    kept = load("head").landmarks
    own = head.landmarks
    bare = np.arange(len(head.vertices))
    # Top and back of the head [mm], where no landmarks lie; without ears.
    is_behind = (known[:, 2] < -20.0) & (abs(known[:, 0]) < 65.0)
    is_far = (known[:, 1] > 55.0) | is_behind
    has_built_in_vertices = hasattr(head, "anatomy") and len(head.vertices) == len(known)
    if has_built_in_vertices:
        ears = [row for name, row in load("head").rings.items() if "ear_" in name]
        bare = np.setdiff1d(bare, np.concatenate(ears))  # ears have no bone
        named = [at for name, at in head.anatomy.items() if not name.startswith("tragion")]
        kept = own = np.concatenate([own, named, np.flatnonzero(is_far)])
    else:
        far = np.flatnonzero(is_far & (known[:, 1] > -40.0))  # [mm]; the cranium ends there
        directions = known[far] - arrays["condyles"]
        is_seen, nearest = _same_directions(directions, head.vertices - pivots["mandible"])
        kept = np.append(kept, far[is_seen])
        own = np.append(own, nearest[is_seen])
    warp = ThinPlateSpline(
        np.vstack([known[kept], arrays["condyles"]]),
        np.vstack([head.vertices[own], pivots["mandible"]]),
    )
    normals = vertex_normals(head.vertices, head.faces)[bare]
    parts = {}
    # Colours of hollows and of the outside, sRGB.
    bone_colours = np.array([0.34, 0.235, 0.165]), np.array([0.90, 0.85, 0.735])
    colours = {
        "nose": (np.array([0.50, 0.42, 0.40]), np.array([0.80, 0.82, 0.80])),
        "throat": (np.array([0.10, 0.035, 0.035]), np.array([0.36, 0.13, 0.12])),
    }
    brows = head.vertices[head.landmarks[17:27], 1].max()
    back = pivots["mandible"][2] - 28.0  # [mm]; bone behind this z is pushed, too
    for name in ("cranium", "mandible", "spine", "nose", "throat"):
        faces = arrays[f"{name}_faces"].T.astype(np.int32)  # stored as differences
        faces[:, 0] = np.cumsum(faces[:, 0])
        faces[:, 1:] += faces[:, :1]
        points = warp.points(0.02 * arrays[f"{name}_vertices"].T)  # integers to mm
        if name == "cranium":  # few landmarks fix its top, back and sides
            free = np.maximum(points[:, 1] - brows, back - points[:, 2])
            points = _under_skin(points, free, head.vertices[bare], normals)
        dark, bright = colours.get(name, bone_colours)
        light = arrays[f"{name}_light"][:, None] / 255.0
        title = name if name == "throat" else f"skull_{name}"
        parts[name] = _part(title, points, faces, dark + light * (bright - dark), name)
    return parts


def _same_directions(directions: Floats64, seen: Floats64) -> tuple[Any, Any]:
    """Find the vertices that lie in given directions from the centre of the cranium.

    directions: points that give the directions, (n, 3). seen: vertices, (m, 3). Both are relative
    to the condyles [mm]. Returns whether each direction has a vertex, and the nearest vertices,
    both (n,).
    """
    centre = np.array([0.0, 40.0, 0.0])  # [mm] relative to the condyles
    apart = scipy.spatial.distance.cdist(directions - centre, seen - centre, "cosine")
    return apart.min(axis=1) < 0.01, apart.argmin(axis=1)


def _under_skin(points: Floats64, free: Floats64, skin: Floats64, normals: Floats64) -> Floats64:
    """Push points of bone inward where they would leave the skin; returns points [mm], (n, 3).

    points: [mm], (n, 3). free: how far each point lies inside the region of pushing [mm], (n,).
    skin: vertices [mm], (m, 3). normals: unit normals of these vertices, (m, 3).
    """
    neighbour_count = 6
    away, near = scipy.spatial.cKDTree(skin).query(points, k=neighbour_count)
    weights = 1.0 / np.maximum(away, 1.0) ** 2
    fade_depth = 10.0  # [mm] inside the region, over which pushing begins
    most_distance = 40.0  # [mm] from bone to the skin; farther bone is not pushed
    pushed = np.clip(free / fade_depth, 0.0, 1.0) * (away[:, 0] < most_distance)
    weights *= (pushed / weights.sum(axis=1))[:, None]
    skin_thickness = 2.0  # [mm] on bone
    from_skin = points[:, None] - skin[near]
    height = (from_skin * normals[near]).sum(axis=2)
    protruding = np.maximum(height + skin_thickness, 0.0)
    push = np.einsum("nk,nkc->nc", weights * protruding, normals[near])
    return np.asarray(points - push)


def neck_sections(head: Any) -> list[Part]:
    """Make parts that close the cut through a neck; head: has vertices, faces and landmarks."""
    chin = head.vertices[head.landmarks[8], 1]
    parts = []
    # Pairs: fraction of the radius, and colour.
    rings = (
        (0.0, FLESH_COLOUR),
        (0.5, FLESH_COLOUR),
        (0.93, FLESH_COLOUR),
        (0.95, FAT_COLOUR),
        (1.0, FAT_COLOUR),
    )
    for loop in boundary_loops(head.faces):
        edge = head.vertices[loop]
        if edge[:, 1].max() < chin:
            centre = edge.mean(axis=0)
            points = np.concatenate([centre + fraction * (edge - centre) for fraction, _ in rings])
            rows = np.arange(len(points)).reshape(len(rings), -1)
            faces = grid_faces(rows, closed=True)
            colours = np.repeat([colour for _, colour in rings], len(loop), axis=0)
            parts.append(_part("neck_section", points, faces, colours, "neck"))
    return parts


def _part(name: str, points: Floats64, faces: Any, colours: Floats64, bone: str) -> Part:
    # Other parts move with the bone of the same name.
    bone_of_part = {"nose": "cranium", "throat": "cranium", "spine": "neck"}
    bone_shine = 0.28
    return Part(
        name=name,
        vertices=points.astype(np.float32),
        normals=vertex_normals(points, faces).astype(np.float32),
        faces=faces,
        colours=colours.astype(np.float32),
        bone=bone_of_part.get(bone, bone),
        shine=bone_shine,
    )
