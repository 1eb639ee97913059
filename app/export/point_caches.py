"""PC2 and MDD: where the vertices of a mesh go, frame by frame; the mesh itself lies beside as OBJ.

The mesh is the whole head, the skin first, so that one modifier moves everything. Sources: the PC2
and MDD chapters of Blender's own reader of both, the Mesh Cache modifier (its manual tells where
they come from), and Autodesk's PointCache2.
"""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np

from .clip import Clip, Singles
from .formats import Request
from .frame_surfaces import METRES, frame_surfaces
from .sequences import obj_text, write_material

PC2_HEAD = "<12siiffi"  # signature, version, vertices, first frame, frames a sample, samples


def write_pc2(clip: Clip, part: Path, request: Request) -> None:
    """Write metres, little-endian; a sample is a frame, the first is frame 0."""
    points = _points(clip, part, request)
    count, vertices = points.shape[:2]
    with part.open("wb") as file:
        file.write(struct.pack(PC2_HEAD, b"POINTCACHE2\0", 1, vertices, 0.0, 1.0, count))
        file.write(points.astype("<f4").tobytes())


def write_mdd(clip: Clip, part: Path, request: Request) -> None:
    """Write metres, big-endian, with the time of each frame [s]."""
    points = _points(clip, part, request)
    with part.open("wb") as file:
        file.write(struct.pack(">2i", *points.shape[:2]))
        file.write(clip.times.astype(">f4").tobytes())
        file.write(points.astype(">f4").tobytes())


def _points(clip: Clip, part: Path, request: Request) -> Singles:
    """All vertices of all frames [m], shape (N, V, 3), and the mesh of the first beside them."""
    points = []
    for number, frame in enumerate(request.counted(frame_surfaces(clip), clip.frame_count)):
        if number == 0:
            material = write_material(clip, part.with_suffix(".mtl"))
            part.with_suffix(".obj").write_text(obj_text(frame, material))
        points.append(
            METRES * np.concatenate([surface.points for surface in frame]).astype(np.float32)
        )
    return np.stack(points)
