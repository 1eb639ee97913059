"""PC2: where the vertices of a mesh go, frame by frame; the mesh itself lies beside as OBJ.

The mesh is the whole head, the skin first, so that one modifier moves everything. Sources:
Blender's own reader, the Mesh Cache modifier, and Autodesk's PointCache2.
"""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np

from .clip import Clip
from .formats import Request
from .frame_surfaces import METRES, frame_surfaces
from .sequences import obj_text, write_material

PC2_HEAD = "<12siiffi"  # signature, version, vertices, first frame, frames a sample, samples


def write_pc2(clip: Clip, part: Path, request: Request) -> None:
    """Write metres, little-endian; a sample is a frame, the first is frame 0."""
    points = []
    for number, frame in enumerate(request.counted(frame_surfaces(clip), clip.frame_count)):
        if number == 0:
            material = write_material(clip, part.with_suffix(".mtl"))
            part.with_suffix(".obj").write_text(obj_text(frame, material))
        points.append(METRES * np.concatenate([surface.points for surface in frame]))
    vertices = len(points[0])
    with part.open("wb") as file:
        head = (b"POINTCACHE2\0", 1, vertices, 0.0, 1.0, clip.frame_count)
        file.write(struct.pack(PC2_HEAD, *head))
        file.write(np.stack(points).astype("<f4").tobytes())
