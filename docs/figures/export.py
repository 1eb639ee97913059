"""Draw the pictures of docs/export.md: `xvfb-run -a python docs/figures/export.py [FOLDER]`.

Each shows an exported file in a program that it is for: `export_usd`, a USD package in Blender
(RISORIUS_BLENDER_PYTHON names a Python that has bpy), and `export_paraview`, a VTKHDF file by VTK,
which draws for ParaView, coloured by how far each point is from rest.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import PIL.Image
from vtkmodules import vtkRenderingOpenGL2  # noqa: F401, what draws
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOHDF import vtkHDFReader
from vtkmodules.vtkRenderingCore import (
    vtkActor,
    vtkColorTransferFunction,
    vtkPolyDataMapper,
    vtkRenderer,
    vtkRenderWindow,
    vtkWindowToImageFilter,
)

from risorius.app.capture.captions import contact_sheet
from risorius.app.errors import UserError
from risorius.app.export.clip import Clip, record
from risorius.app.export.formats import Request, format_for, write
from risorius.app.files import Image
from risorius.app.script import parse_script
from risorius.bench import figures

to_numpy: Callable[..., Any] = vtk_to_numpy  # which has no annotations
RATE = 30  # frames a second
MOMENTS = {15: "joy", 30: "surprise", 45: "kiss"}  # by frame
SCRIPT = "duration = 2.0\n[[pose]]\ntime = 0.0\n" + "".join(
    f"[[pose]]\ntime = {frame / RATE}\n{pose} = 1.0\n" for frame, pose in MOMENTS.items()
)
IN_BLENDER = Path(__file__).with_name("usd_in_blender.py")
SIZE = (420, 480)  # [pixels] of a picture
COLOURS = {  # by distance from rest [mm]
    0.0: (0.86, 0.86, 0.86),
    4.0: (0.99, 0.80, 0.52),
    8.0: (0.93, 0.45, 0.20),
    16.0: (0.45, 0.05, 0.18),
}
FAR, ZOOM = (-300.0, 20.0, 1000.0), 1.5  # where the camera of ParaView's picture stands [mm]


def exported(folder: str, name: str) -> tuple[Clip, Path]:
    """The clip, and the file that it was written to."""
    clip = record(parse_script(SCRIPT, source="export.py"), None, RATE, progress=False)
    path = Path(folder) / name
    write(clip, path, format_for(path, None), Request(progress=False))
    return clip, path


def in_blender() -> Image:
    """Frames of a USD package, rendered by Blender."""
    python = os.environ.get("RISORIUS_BLENDER_PYTHON", sys.executable)
    with tempfile.TemporaryDirectory() as folder:
        _, path = exported(folder, "face.usdz")
        words = [python, str(IN_BLENDER), str(path), folder, str(RATE), *map(str, MOMENTS)]
        ended = subprocess.run(words, capture_output=True, text=True, check=False)
        if ended.returncode:
            raise UserError(f"Blender: {ended.stderr.strip().splitlines()[-1]}")
        cells = []
        for frame, title in MOMENTS.items():
            with PIL.Image.open(Path(folder) / f"{frame}.png") as picture:
                cells.append((title, np.asarray(picture.convert("RGB"))))
    return contact_sheet(cells, columns=len(cells), cell_width=300)


def in_paraview() -> Image:
    """Steps of a VTKHDF file, drawn by VTK."""
    with tempfile.TemporaryDirectory() as folder:
        clip, path = exported(folder, "face.vtkhdf")
        reader, mapper, actor = vtkHDFReader(), vtkPolyDataMapper(), vtkActor()
        reader.SetFileName(str(path))
        colours = vtkColorTransferFunction()
        for distance, colour in COLOURS.items():
            colours.AddRGBPoint(distance, *colour)
        colours.SetVectorModeToMagnitude()
        mapper.SetInputConnection(reader.GetOutputPort())
        mapper.SetScalarModeToUsePointFieldData()
        mapper.SelectColorArray("displacement")
        mapper.SetLookupTable(colours)
        actor.SetMapper(mapper)
        scene, window = vtkRenderer(), vtkRenderWindow()
        scene.AddActor(actor)
        scene.SetBackground(0.32, 0.34, 0.43)
        window.OffScreenRenderingOn()
        window.SetMultiSamples(8)
        window.SetSize(*SIZE)
        window.AddRenderer(scene)
        cells = []
        for frame, title in MOMENTS.items():
            reader.UpdateTimeStep(clip.times[frame])
            camera = scene.GetActiveCamera()
            camera.SetFocalPoint(0.0, 0.0, 0.0)
            camera.SetPosition(*FAR)
            camera.SetViewUp(0.0, 1.0, 0.0)
            scene.ResetCamera()
            camera.Zoom(ZOOM)
            window.Render()
            grabber = vtkWindowToImageFilter()
            grabber.SetInput(window)
            grabber.Update()
            pixels = to_numpy(grabber.GetOutput().GetPointData().GetScalars())
            cells.append((title, pixels.reshape(SIZE[1], SIZE[0], 3)[::-1].copy()))
    return contact_sheet(cells, columns=len(cells), cell_width=300)


def main(arguments: Sequence[str]) -> None:
    """Draw the pictures into the folder given."""
    given = figures.parse(arguments, __doc__)
    every = {"export_paraview": in_paraview, "export_usd": in_blender}
    figures.draw(given.folder, figures.chosen(every, given.only))


if __name__ == "__main__":
    figures.run(main)
