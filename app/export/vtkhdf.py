"""Writes VTKHDF, for ParaView and VTK: all frames in one HDF5 file, constant triangles once.

Arrays contain the rows of all frames. Each frame is a step, with the index of its first row in each
array. Lengths are millimetres.

Source: Kitware, "VTKHDF format specification", version 2.0, PolyData with steps.
"""

from __future__ import annotations

import io
from collections import defaultdict
from pathlib import Path
from typing import Any

import numpy as np

from ..extras import optional_import
from .clip import Clip, FrameSurface, frame_surfaces
from .formats import ExportRequest

h5py = optional_import("h5py", "VTKHDF", "export")


def write_vtkhdf(clip: Clip, part: Path, request: ExportRequest) -> None:
    """Write all surfaces as one PolyData, the skin's triangles first.

    Vertices have `Normals`, and `displacement` from rest if triangles are constant. Triangles have
    `surface`, a number among the names in the attribute `surfaces`, and `source`, the triangle of
    the mesh that contains them.
    """
    rest = np.concatenate([each.rest for each in clip.surfaces])
    memory = io.BytesIO()  # because HDF5 crashes on a full disk
    with h5py.File(memory, "w") as file:
        steps = _Steps(file.create_group("VTKHDF"))
        frames = request.counted(frame_surfaces(clip, request.refinement), clip.frame_count)
        for number, frame in enumerate(frames):
            if number == 0 or request.refinement is not None:
                steps.begin_mesh(frame)
            points = np.concatenate([surface.points for surface in frame])
            normals = np.concatenate([surface.normals for surface in frame])
            values = {"Normals": normals}
            if request.refinement is None:
                values["displacement"] = points - rest
            steps.add(clip.times[number], points, values)
        steps.finish([each.name for each in clip.surfaces])
    part.write_bytes(memory.getbuffer())


class _Steps:
    """The arrays of a file, which grow frame by frame, and the first rows of each frame."""

    def __init__(self, root: Any) -> None:
        self._root = root
        self._steps: dict[str, list[Any]] = defaultdict(list)
        self._meshes: dict[str, list[int]] = defaultdict(list)
        self._begins: dict[str, Any] = {}  # first rows of the current mesh
        root.attrs["Version"] = (2, 0)
        root.attrs["Type"] = np.bytes_("PolyData")

    def begin_mesh(self, frame: list[FrameSurface]) -> None:
        """Add triangles for this frame, and for later frames until the next call."""
        points = [len(surface.points) for surface in frame]
        starts = np.cumsum([0, *points[:-1]])
        shifted = [surface.faces + start for surface, start in zip(frame, starts, strict=True)]
        triangles = np.concatenate(shifted)
        surfaces = np.repeat(np.arange(len(frame)), [len(surface.faces) for surface in frame])
        # Cells of vertices, lines, polygons and strips; here only polygons have cells.
        our_cells = np.array([0, 0, 1, 0])
        self._begins = {
            "PartOffsets": len(self._meshes["NumberOfPoints"]),
            "CellOffsets": our_cells * self._length("CellData/surface"),
            "ConnectivityIdOffsets": our_cells * self._length("Polygons/Connectivity"),
            "CellDataOffsets/surface": self._length("CellData/surface"),
            "CellDataOffsets/source": self._length("CellData/surface"),
        }
        self._append("Polygons/Connectivity", triangles.ravel().astype(np.int64))
        self._append("Polygons/Offsets", np.arange(0, triangles.size + 1, 3, dtype=np.int64))
        self._append("CellData/surface", surfaces.astype(np.int32))
        self._append("CellData/source", np.concatenate([surface.source for surface in frame]))
        self._meshes["NumberOfPoints"].append(sum(points))
        self._meshes["Polygons/NumberOfCells"].append(len(triangles))
        self._meshes["Polygons/NumberOfConnectivityIds"].append(triangles.size)

    def add(self, time: float, points: Any, values: dict[str, Any]) -> None:
        """Add the positions of a frame's vertices, and their values."""
        begin = self._length("Points")
        offsets = {f"PointDataOffsets/{name}": begin for name in values}
        row = {"Values": time, "NumberOfParts": 1, "PointOffsets": begin, **offsets, **self._begins}
        for name, value in row.items():
            self._steps[name].append(value)
        self._append("Points", points.astype(np.float32))
        for name, array in values.items():
            self._append(f"PointData/{name}", array.astype(np.float32))
        self._root["PointData/Normals"].attrs["Attribute"] = np.bytes_("Normals")

    def finish(self, surfaces: list[str]) -> None:
        """Write the tables that are complete only at the end."""
        for name, numbers in self._meshes.items():
            self._root.create_dataset(name, data=numbers, dtype=np.int64)
        none = np.zeros(len(self._meshes["NumberOfPoints"]), np.int64)
        for topology in ("Vertices", "Lines", "Strips"):
            self._root.create_dataset(f"{topology}/Connectivity", data=none[:0])
            for name in ("Offsets", "NumberOfCells", "NumberOfConnectivityIds"):
                self._root.create_dataset(f"{topology}/{name}", data=none)
        steps = self._root.create_group("Steps")
        steps.attrs["NSteps"] = len(self._steps["Values"])
        for name, numbers in self._steps.items():
            steps.create_dataset(name, data=np.array(numbers))
        self._root.attrs["surfaces"] = surfaces

    def _append(self, name: str, rows: Any) -> None:
        """Append rows to an array."""
        if name not in self._root:
            limits = (None, *rows.shape[1:])
            self._root.create_dataset(
                name, data=rows, maxshape=limits, chunks=rows.shape, compression=1, shuffle=True
            )
            return
        array = self._root[name]
        begin = len(array)
        array.resize(begin + len(rows), axis=0)
        array[begin:] = rows

    def _length(self, name: str) -> int:
        """Return the number of rows of an array."""
        return len(self._root[name]) if name in self._root else 0
