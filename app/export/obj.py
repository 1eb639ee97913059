"""Writes OBJ, for nearly every program: a file per frame, or one file that a PC2 file moves.

The mesh is the whole head, in metres, with the skin first, so that one modifier moves everything.
Sources: Wavefront, "Advanced Visualizer manual", appendix B1 (OBJ) and B2 (MTL); Blender's reader
and its Mesh Cache modifier; Autodesk's PointCache2.
"""

from __future__ import annotations

import struct
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import numpy.typing as npt
import PIL.Image

from risorius.geometry.arrays import Integers32

from ..rig.surface import METRES_PER_MILLIMETRE
from .clip import Clip, FrameSurface, frame_surfaces
from .formats import FRAME_NAME, ExportRequest


def write_obj(clip: Clip, folder: Path, request: ExportRequest) -> None:
    """Write an OBJ of each frame, in metres, and the skin's texture beside them.

    The simulated mesh keeps its V vertices, in their order.
    """
    material = _write_material(clip, folder / "frame.mtl")
    frames = request.counted(frame_surfaces(clip, request.refinement), clip.frame_count)
    for number, frame in enumerate(frames):
        path = folder / f"{FRAME_NAME.format(number)}.obj"
        _write(path, _obj_text(clip, frame, material))


def write_pc2(clip: Clip, part: Path, request: ExportRequest) -> None:
    """Write the vertices in metres, little-endian; each frame is a sample, the first is frame 0."""
    points = []
    for number, frame in enumerate(request.counted(frame_surfaces(clip), clip.frame_count)):
        if number == 0:
            material = _write_material(clip, part.with_suffix(".mtl"))
            _write(part.with_suffix(".obj"), _obj_text(clip, frame, material))
        points.append(METRES_PER_MILLIMETRE * np.concatenate([surface.points for surface in frame]))
    vertices = len(points[0])
    with part.open("wb") as file:
        head = (b"POINTCACHE2\0", 1, vertices, 0.0, 1.0, clip.frame_count)
        # Signature, version, vertices, first frame, frames per sample, samples.
        file.write(struct.pack("<12siiffi", *head))
        file.write(np.stack(points).astype("<f4").tobytes())


def _write_material(clip: Clip, path: Path) -> str:
    """Write an MTL and its picture if the skin has one; return the name of the MTL, or ""."""
    if clip.scene.skin.albedo is None:
        return ""
    picture = path.with_name(f"{path.stem}_skin.png")
    _write(path, f"newmtl skin\nKd 1 1 1\nmap_Kd {picture.name}\nnewmtl parts\nKd 1 1 1\n")
    PIL.Image.fromarray(clip.scene.skin.albedo).save(picture)
    return path.name


def _write(path: Path, text: str) -> None:
    """Write a text with names of files, which keep their bytes even if they are not UTF-8."""
    path.write_text(text, encoding="utf-8", errors="surrogateescape")


def _obj_text(clip: Clip, frame: Sequence[FrameSurface], material: str) -> str:
    """Return an OBJ of one object with a group for each surface. material: the skin's MTL.

    Colours follow the coordinates of a vertex, as MeshLab writes and Blender reads them; vertices
    of a textured surface are white.
    """
    texts = [f"mtllib {material}\n" if material else ""]
    points = coordinates = 1
    for whole, surface in zip(clip.surfaces, frame, strict=True):
        white = np.ones_like(surface.points)
        colours = white if whole.colours is None else whole.colours.astype(np.float64)
        texts.append(_rows("v", np.hstack([surface.points * METRES_PER_MILLIMETRE, colours])))
        texts.append(_rows("vn", surface.normals))
        uv = surface.uv
        face_uv = surface.face_uv
        if uv is None or face_uv is None:  # for readers that expect uv at all corners
            uv = np.zeros((1, 2), np.float32)
            face_uv = np.zeros_like(surface.faces)
        texts.append(_rows("vt", uv))
        texts.append(f"g {whole.name}\n")
        if material:
            texts.append(f"usemtl {'parts' if surface.uv is None else 'skin'}\n")
        texts.append(
            _faces([surface.faces + points, face_uv + coordinates, surface.faces + points])
        )
        coordinates += len(uv)
        points += len(surface.points)
    return "".join(texts)


def _rows(name: str, rows: npt.NDArray[np.floating]) -> str:
    """Return a line for each row: a name, then the row's numbers."""
    line: str = name + " %.6g" * rows.shape[1] + "\n"
    return (line * len(rows)) % tuple(rows.ravel().tolist())


def _faces(corners: Sequence[Integers32]) -> str:
    """Return lines of triangles, whose corners are vertex/coordinate/normal."""
    line = "f" + " %d/%d/%d" * 3 + "\n"
    numbers = np.stack(corners, axis=-1)
    return (line * len(numbers)) % tuple(numbers.ravel().tolist())
