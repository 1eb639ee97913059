"""Draw the pictures of docs/in_other_programs.md: `python docs/figures/hosts.py [FOLDER]`.

`hosts_pyvista` is what the page's own program draws. `hosts_blender`, the face in joy by Cycles,
is drawn by refined_in_blender.py in the Python of Blender that RISORIUS_BLENDER_PYTHON names.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from contextlib import chdir
from pathlib import Path
from typing import Any

import numpy as np
import PIL.Image

from risorius.app.errors import UserError
from risorius.app.files import Image
from risorius.app.scenes import FaceScene
from risorius.bench import figures

PAGE = Path(__file__).parents[1] / "in_other_programs.md"
AS_INSTALLED = Path(__file__).parents[2] / ".venv" / "as_installed"  # laid by `make check`
SETTLED = 1.5  # [s]


def read(file: Path) -> Image:
    """A picture without its alpha."""
    return np.asarray(PIL.Image.open(file).convert("RGB"))


def pyvista() -> Image:
    """Run the programs of the page, and read what they wrote."""
    programs = re.findall(r"^```python\n(.*?)^```$", PAGE.read_text("utf-8"), re.M | re.S)
    with tempfile.TemporaryDirectory() as folder, chdir(folder):
        exec(compile("\n".join(programs), PAGE, "exec"), {})
        return read(Path("hosts_pyvista.png"))


def blender() -> Image:
    """Let Blender render the face."""
    python = os.environ.get("RISORIUS_BLENDER_PYTHON")
    if not python:
        raise UserError("hosts_blender: RISORIUS_BLENDER_PYTHON must name a Python that has bpy")
    scene = FaceScene()
    scene.pose({"joy": 1.0})
    scene.step(SETTLED)
    data: dict[str, Any] = {"rest": scene.rest_positions, "moved": scene.positions}
    data["faces"] = scene.faces
    for part in scene.parts:
        matrix = scene.bone_transforms()[part.bone]
        data[f"{part.name} points"] = part.vertices @ matrix[:3, :3].T + matrix[:3, 3]
        data[f"{part.name} faces"] = part.faces
        data[f"{part.name} colours"] = np.asarray(part.colours) ** 2.2  # linear
    data["parts"] = np.array([part.name for part in scene.parts])
    with tempfile.TemporaryDirectory() as folder:
        file, picture = Path(folder) / "face.npz", Path(folder) / "face.png"
        np.savez(file, **data)
        subprocess.run(
            [python, Path(__file__).with_name("refined_in_blender.py"), file, picture],
            env={**os.environ, "PYTHONPATH": str(AS_INSTALLED)},
            stdout=sys.stderr,
            check=True,
        )
        return read(picture)


def main(arguments: Sequence[str]) -> None:
    """Draw the pictures into the folder given."""
    given = figures.parse(arguments, __doc__)
    every: dict[str, figures.Figure] = {"hosts_pyvista": pyvista, "hosts_blender": blender}
    figures.draw(given.folder, figures.chosen(every, given.only))


if __name__ == "__main__":
    figures.run(main)
