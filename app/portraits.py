"""The pictures of docs/head.md: `python -m risorius.app.portraits [FOLDER]` draws them anew.

Two contact sheets, always from the same views and under the same light, so that two states of the
head can be laid side by side: `head_views.png` (the head at rest, as painted skin, as clay, as flat
triangles) and `head_details.png` (the open jaw, the mesh, the finer meshes of the same form).
"""

import argparse
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import TracebackType

import numpy as np
import numpy.typing as npt

from risorius import assets, refine, render, sim

from .errors import run_alone
from .labels import contact_sheet
from .outputs import Frame, check_picture, save_png
from .parameters import pixels

FOLDER = Path("docs/pictures")
CELL = (260, 320)  # [pixels] of one portrait: a sheet stays below 600 kB
VIEWS = ("front", "three-quarter", "profile", "below")
SETTLED = 90  # steps of 1/60 s after which an opened jaw stands still
AT_REST = dict.fromkeys(("cranium", "mandible", "eye_left", "eye_right"), np.eye(4))

PAINTED = render.Style()
CLAY = render.Style(textured=False, albedo=render.CLAY)
FLAT = render.Style(textured=False, albedo=render.CLAY, shading=render.Shading.FLAT)
EDGES = render.Style(textured=False, albedo=render.CLAY, wireframe=True)

Points = npt.NDArray[np.float64]
Poses = Mapping[str, Points]


class Studio:
    """An offscreen surface in which meshes of the built-in head sit for portraits."""

    def __init__(self, head: assets.Head, size: tuple[int, int]) -> None:
        self.head = head
        self.surface = render.open_offscreen(size, samples=4)
        self.renderer = render.Renderer(self.surface)
        self.texture = self.renderer.load_texture(head.albedo)

    def __enter__(self) -> "Studio":
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.surface.close()

    def portrait(
        self,
        style: render.Style,
        view: str,
        *,
        positions: Points | None = None,
        poses: Poses = AT_REST,
        level: int = 0,
    ) -> Frame:
        """Draw the head from a named view: at rest or at `positions`, or a finer mesh of it."""
        head = self.head
        fine = head.finer(level) if level else None
        faces = head.faces if fine is None else fine.faces
        vertices = head.vertices if fine is None else fine.vertices
        uv = head.uv if fine is None else fine.carried(head.uv).astype(np.float32)
        refiner = refine.create("none", faces, vertices, uv, faces)
        stream = self.renderer.lend_stream(
            refiner.vertex_capacity, refiner.triangle_capacity, refiner.vertex_columns
        )
        mesh = refiner.refine(vertices if positions is None else positions, out=stream)
        stream.upload(len(mesh.positions), len(mesh.triangles))
        camera = render.OrbitCamera.framing(head.vertices, view=view)
        self.surface.begin()
        self.renderer.draw_background(style)
        self.renderer.draw_mesh(stream, camera, style, texture=self.texture)
        self.renderer.draw_parts(head.parts, poses, camera, style)
        self.surface.end()
        return self.surface.read()


def opened_jaw(head: assets.Head) -> tuple[Points, Poses]:
    """Positions [mm], shape (V, 3), and bone matrices with the jaw quite open."""
    simulation = sim.create(head)
    simulation.set("jaw_open", 1.0)
    for _ in range(SETTLED):
        simulation.step(1.0 / 60.0)
    return simulation.positions.copy(), simulation.bone_transforms()


def views(studio: Studio) -> list[tuple[str, Frame]]:
    """The cells of `head_views.png`."""
    return [
        (f"{view}, {title}", studio.portrait(style, view))
        for title, style in (("painted", PAINTED), ("clay", CLAY), ("flat", FLAT))
        for view in VIEWS
    ]


def details(studio: Studio) -> list[tuple[str, Frame]]:
    """The cells of `head_details.png`."""
    positions, poses = opened_jaw(studio.head)
    cells = [("jaw closed", studio.portrait(PAINTED, "front"))]
    cells += [
        (f"jaw open, {view}", studio.portrait(PAINTED, view, positions=positions, poses=poses))
        for view in ("front", "three-quarter")
    ]
    cells.append(("2030 triangles", studio.portrait(EDGES, "three-quarter")))
    cells += [
        (f"{4**level * len(studio.head.faces)}, flat", studio.portrait(FLAT, view, level=level))
        for level, view in ((1, "three-quarter"), (2, "three-quarter"))
    ]
    cells.append(("32480, clay", studio.portrait(CLAY, "three-quarter", level=2)))
    cells.append(("32480, painted", studio.portrait(PAINTED, "three-quarter", level=2)))
    return cells


def main(arguments: Sequence[str]) -> None:
    """Draw both sheets into the folder given."""
    parser = argparse.ArgumentParser(
        prog="python -m risorius.app.portraits", description=(__doc__ or "").splitlines()[0]
    )
    parser.add_argument("folder", nargs="?", type=Path, default=FOLDER)
    parser.add_argument("--width", type=pixels, default=CELL[0], help="of one portrait [pixels]")
    given = parser.parse_args(arguments)
    for name in ("views", "details"):
        check_picture(given.folder / f"head_{name}.png")
    size = given.width, given.width * CELL[1] // CELL[0]
    with Studio(assets.load("head"), size) as studio:
        for name, cells in (("views", views(studio)), ("details", details(studio))):
            sheet = contact_sheet(cells, columns=len(VIEWS), cell_width=size[0])
            save_png(given.folder / f"head_{name}.png", sheet)


if __name__ == "__main__":
    run_alone(main)
