"""Measure the visible effect of the paper's rule on a head with a quarter of the triangles.

Kähler, Haber, Seidel 2003, section 1: "when the surface is animated by moving the mesh nodes, the
resulting mesh doesn't adapt well to the deformation." On 540 triangles this is clearly visible. As
in Figure 10, the built-in head with 16 times its triangles is moved by the same muscles, drawn in
the same way, and taken as the truth; the coarse head's vertices are a subset of its vertices. In
the maps below the pictures, a changed pixel is green if it came nearer to the dense mesh's picture,
and otherwise red.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt
import trimesh

from risorius import assets, refine, render
from risorius.app.capture.drawing import camera_for
from risorius.app.pictures import Image
from risorius.app.refining.drawn_mesh import DrawnMesh
from risorius.app.refining.presets import FIRST_PRESET, PAPERS_PRESET, STATIC_REFINER, Refinement
from risorius.app.refining.refiners import refiner_for
from risorius.app.scenes import FaceScene
from risorius.assets.coarse import coarse_head
from risorius.geometry.arrays import Flags, Floats64
from risorius.geometry.sides import side_lengths

from ..canvas import CLAY_STYLE, Canvas, ComparedPicture, Drawing, image_table, parts_without_hair
from ..subjects import SETTLING_FRAMES, fine_simulation, settled_positions
from .experiments import Outcome

SEEN_CHANGE = 8.0  # levels of 255: a visible change
LOOK_COLUMNS = (STATIC_REFINER, PAPERS_PRESET, FIRST_PRESET)
"""One column for each look; the dense mesh comes after them."""


@dataclass(frozen=True)
class LookCell(ComparedPicture):
    """The picture of one expression in one look, and flags of the head's pixels, (H, W)."""

    is_head: Flags
    smoother: float
    """Angle between neighbouring triangles at split edges, relative to the mesh there."""

    def wrong(self, truth: LookCell) -> int:
        """Number of pixels that show the head here or in truth, but not in both."""
        return int((self.is_head != truth.is_head).sum())


def outcome(size: tuple[int, int] = (300, 360)) -> Outcome:
    """Error of each look relative to the static mesh, and the fraction of its changes that help."""
    rows = []
    sums = {name: np.zeros(5) for name in LOOK_COLUMNS}
    for expression, cells in _draw_cells(size):
        truth = cells[-1]
        static = cells[0]
        maps = []
        for name, cell in zip(LOOK_COLUMNS, cells, strict=False):
            is_changed = cell.difference(static) > SEEN_CHANGE
            is_nearer = cell.difference(truth) < static.difference(truth)
            helps = (is_changed & is_nearer).sum() / max(is_changed.sum(), 1)
            outline = cell.wrong(truth) / static.wrong(truth)
            error = cell.rms(truth) / static.rms(truth)
            sums[name] += (
                100.0 * is_changed.mean(),
                error,
                outline,
                100.0 * helps,
                cell.smoother,
            )
            said = f"{cell.wrong(truth)} pixels of the outline wrong"
            maps.append((said, _map_of_gains(cell.image, is_changed, is_nearer)))
        pictures = [
            (f"{name}, {cell.triangles}, {cell.rms(truth):.1f}", cell.image)
            for name, cell in zip((*LOOK_COLUMNS, "dense mesh"), cells, strict=True)
        ]
        title = f"{expression}: triangles, and RMS of the difference from the dense mesh"
        rows += [(title, pictures), (f"{expression}: changed pixels", maps)]
    count = len(rows) // 2
    values: dict[str, float] = {}
    for name in (PAPERS_PRESET, FIRST_PRESET):
        changed, error, outline, helps, smoother = sums[name] / count
        values[f"{name}: angle between triangles where it splits, over static"] = float(smoother)
        values[f"{name}: pixels that change visibly [%]"] = float(changed)
        values[f"{name}: difference from the dense mesh, over static"] = float(error)
        values[f"{name}: wrong pixels of the outline, over static"] = float(outline)
        values[f"{name}: changed pixels that come nearer [%]"] = float(helps)
    return Outcome(values, image_table(rows))


def _draw_cells(size: tuple[int, int]) -> Iterator[tuple[str, list[LookCell]]]:
    """Draw every expression in every look; the last cell of an expression is the dense mesh."""
    head = assets.load("head")
    level = 2  # the finer head with 16 times the triangles
    fine = head.finer(level)
    simulation = fine_simulation(head, fine)
    coarse = coarse_head()
    scene = FaceScene(coarse)
    asked = [
        Refinement(refiner=STATIC_REFINER),
        Refinement(PAPERS_PRESET),
        Refinement(FIRST_PRESET),
    ]
    refiners = [(refiner_for(scene, each), coarse.file_vertices) for each in asked]
    dense = refine.create("none", fine.faces, fine.vertices)
    refiners.append((dense, np.arange(len(fine.vertices), dtype=np.int32)))
    camera = camera_for(scene, "-32,3,1.25")  # three-quarter view
    empty = replace(CLAY_STYLE, background=render.BLACK)
    with Canvas(size) as canvas:
        parts = parts_without_hair(scene)
        for expression in ("joy", "surprise", "kiss"):
            now = settled_positions(simulation, {expression: 1.0}, SETTLING_FRAMES)
            bones = simulation.bones.transforms()
            cells = []
            for refiner, kept in refiners:
                pictures = [
                    canvas.draw_image(refiner, now[kept], Drawing(camera, style, parts, bones))
                    for style in (CLAY_STYLE, empty)
                ]
                is_head = (pictures[0] == pictures[1]).all(axis=2)
                drawn = canvas.mesh_of(refiner)
                smoother = _smoother(drawn, now[kept])
                cells.append(LookCell(drawn.triangle_count, pictures[0], is_head, smoother))
            yield expression, cells


def _smoother(drawn: DrawnMesh, positions: Floats64) -> float:
    """Mean angle between subtriangles, over that between the split triangles; 1 without splits."""
    assert drawn.mesh is not None
    splits = drawn.refiner.splits[drawn.refiner.triangle_edges].sum(axis=1)
    is_split = splits > 0
    if not is_split.any():
        return 1.0
    faces = coarse_head().faces
    now = _mean_angle(positions, faces[is_split])
    mesh = drawn.mesh
    refined = mesh.triangles[is_split[mesh.source]]
    return _mean_angle(mesh.positions.astype(np.float64), refined) / now


def _mean_angle(positions: Floats64, faces: npt.NDArray[np.integer]) -> float:
    """The mean angle between neighbouring triangles, weighted by the lengths of shared edges."""
    mesh = trimesh.Trimesh(positions, faces, process=False)
    lengths = side_lengths(positions, mesh.face_adjacency_edges)
    return float(np.average(mesh.face_adjacency_angles, weights=lengths))


def _map_of_gains(image: Image, is_changed: Flags, is_nearer: Flags) -> Image:
    """A pale picture, with changed pixels green if they came nearer to the truth, otherwise red."""
    shown = 255 - (255 - image) // 3
    nearer_colour = (30, 150, 80)
    farther_colour = (215, 60, 40)
    shown[is_changed & is_nearer] = nearer_colour
    shown[is_changed & ~is_nearer] = farther_colour
    return np.asarray(shown)
