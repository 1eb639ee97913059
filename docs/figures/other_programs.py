"""Draw the pictures of docs/export.md and docs/in_other_programs.md.

    xvfb-run -a python docs/figures/other_programs.py [FOLDER]

`export_blender` is a glTF file in Blender, `hosts_blender` a face as the add-on refines it;
RISORIUS_BLENDER_PYTHON names a Python that has bpy. `export_paraview` is a VTKHDF file by VTK,
which draws for ParaView, coloured by how far each point is from rest, and `hosts_pyvista` what the
page's own program draws.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
import tempfile
from collections.abc import Callable, Mapping, Sequence
from contextlib import chdir
from functools import partial
from pathlib import Path
from typing import Any

import figures
import pyvista
from vtkmodules.vtkIOHDF import vtkHDFReader

from risorius.app.capture.captions import contact_sheet
from risorius.app.errors import UserError
from risorius.app.export.clip import Clip, record
from risorius.app.export.formats import Request, format_for, write
from risorius.app.files import Image
from risorius.app.script import parse_script

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "docs" / "in_other_programs.md"
AS_INSTALLED = ROOT / ".venv" / "as_installed"  # laid by `make check`
RATE = 30  # frames a second
POSES = {15: "joy", 30: "surprise", 45: "kiss", 60: "anger", 75: "yawn", 90: "disgust"}  # by frame
SCRIPT = "duration = 3.5\n[[pose]]\ntime = 0.0\n" + "".join(
    f"[[pose]]\ntime = {frame / RATE}\n{pose} = 1.0\n" for frame, pose in POSES.items()
)
FARTHEST = 16.0  # [mm] from rest
FAR = (-300.0, 20.0, 1000.0)  # where the camera of ParaView's picture stands [mm]
HEAD, HEAD_ANGLE = (0.0, -15.0, 0.0), 17.0  # what it looks at [mm, degrees]: no more of the shirt


def exported(folder: str, name: str) -> tuple[Clip, Path]:
    """The clip, and the file that it was written to."""
    clip = record(parse_script(SCRIPT, source="script"), None, RATE, progress=False)
    path = Path(folder) / name
    write(clip, path, format_for(path, None), Request(progress=False))
    return clip, path


def in_blender(name: str, moments: Mapping[str, str]) -> Image:
    """Frames of an exported file, rendered by Blender; their titles by what in_blender.py takes."""
    with tempfile.TemporaryDirectory() as folder:
        python = os.environ.get("RISORIUS_BLENDER_PYTHON", sys.executable)
        program = Path(__file__).with_name("in_blender.py")
        words: list[str | Path] = [python, program]
        words += [exported(folder, name)[1], folder, str(RATE), *moments]
        environment = {**os.environ, "PYTHONPATH": str(AS_INSTALLED)}
        ended = subprocess.run(words, env=environment, capture_output=True, text=True, check=False)
        if ended.returncode:
            raise UserError(f"Blender: {ended.stderr.strip().splitlines()[-1]}")
        cells = [
            (title, figures.read(Path(folder) / f"{frame}.png")) for frame, title in moments.items()
        ]
    return contact_sheet(cells, columns=len(cells), cell_width=900 // len(cells))


def in_paraview() -> Image:
    """Steps of a VTKHDF file, drawn by VTK."""
    cells = []
    with tempfile.TemporaryDirectory() as folder:
        clip, path = exported(folder, "face.vtkhdf")
        reader = vtkHDFReader()
        reader.SetFileName(str(path))
        for frame in list(POSES)[:3]:
            reader.UpdateTimeStep(clip.times[frame])
            plotter: Any = pyvista.Plotter(off_screen=True, window_size=[420, 480])
            plotter.background_color = (0.32, 0.34, 0.43)
            look = {"cmap": "OrRd", "smooth_shading": True, "show_scalar_bar": False}
            mesh = pyvista.wrap(reader.GetOutput())
            plotter.add_mesh(mesh, scalars="displacement", clim=(0.0, FARTHEST), **look)
            plotter.camera_position = [FAR, HEAD, (0.0, 1.0, 0.0)]
            plotter.camera.view_angle = HEAD_ANGLE
            plotter.reset_camera_clipping_range()
            cells.append((POSES[frame], plotter.screenshot(return_img=True)))
            plotter.close()
    return contact_sheet(cells, columns=len(cells), cell_width=300)


def in_pyvista() -> Image:
    """Run the programs of the page, and read what they wrote."""
    programs = re.findall(r"^```python\n(.*?)^```$", PAGE.read_text("utf-8"), re.M | re.S)
    with tempfile.TemporaryDirectory() as folder, chdir(folder):
        exec(compile("\n".join(programs), PAGE, "exec"), {})
        return figures.read(Path("hosts_pyvista.png"))


def main(arguments: Sequence[str]) -> None:
    """Draw the pictures into the folder given."""
    given = figures.parse(arguments, __doc__)
    poses = [(str(frame), pose) for frame, pose in POSES.items()]
    refined = {"15": "joy, as it is simulated", "15r": "with Refined Copy"}
    every: dict[str, Callable[[], Image]] = {
        "export_blender": partial(in_blender, "face.glb", dict(poses[3:])),
        "export_paraview": in_paraview,
        "hosts_pyvista": in_pyvista,
        "hosts_blender": partial(in_blender, "face.usdz", refined),
    }
    figures.draw(given.folder, figures.chosen(every, given.only))


if __name__ == "__main__":
    figures.run(main)
