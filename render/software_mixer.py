"""Smooth edges like `sample_mixer.py`, but by kernels on the processor, for software OpenGL.

Software OpenGL would sample every pixel that a triangle touches; this takes a third of the time of
a picture. These kernels sample only edge pixels, about one pixel in fifty. No copy between two
memories is needed, because software OpenGL keeps the picture in main memory.
"""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from ..geometry.arrays import Floats64, Integers32
from ..geometry.directions import unit_vectors
from ..geometry.read_only import read_only
from .camera import PlacedView
from .coverage import SKIN_NUMBERS, Drawn, Numbers, part_numbers
from .frame import CutPlane, Skin
from .parts import PlacedBuffers
from .render_target import Rectangle, RenderTarget, around
from .sample_kernels import (
    HAIR_KIND,
    SAMPLE_POSITIONS,
    SURFACE_KIND,
    TRIANGLE_KIND,
    find_edges,
    mix,
    rasterise,
)
from .translucency import NO_CUT, SUNK_DEPTH, in_view

_MEAN_PLACE = 0.6  # MEAN of shell_layers.glsl
_LOWEST_PLACE = 0.15  # LOWEST of shell_layers.glsl


class _Surface(NamedTuple):
    """A surface as `rasterise` takes it, except that `corners` are in clip space, (V, 4)."""

    corners: Floats64
    values: Floats64
    triangles: Integers32
    kind: int
    numbers: Numbers
    has_back: bool


class SoftwareMixer:
    """Smooths the edges on one target, by kernels on the processor."""

    def __init__(self, target: RenderTarget) -> None:
        self.target = target

    def mix(self, drawn: Drawn, view: PlacedView, areas: Sequence[Rectangle]) -> None:
        """Smooth the edges of drawn surfaces; areas: rectangles that contain all of them."""
        area = around(areas)
        colours, surfaces = self.target.read_area(area)
        pixels = find_edges(surfaces, *view.depth_tolerance)
        depths = np.ones((len(pixels.rows), len(SAMPLE_POSITIONS)))
        seen = np.zeros_like(depths)
        to_area = _clip_to(area, view)
        with np.errstate(all="ignore"):  # triangles with infinite corners are not drawn
            for surface in _visible_surfaces(drawn, view):
                # One type of triangles, so that the kernel is compiled once.
                placed = surface._replace(
                    corners=surface.corners @ to_area,
                    triangles=read_only(np.ascontiguousarray(surface.triangles, np.int32)),
                )
                rasterise(*placed, pixels, depths, seen)
        least, scale = view.depth_range
        depths = np.clip((depths - least) * scale, 0.0, 1.0)
        mixed = mix(colours, surfaces, pixels, depths, seen, *view.depth_tolerance)
        self.target.colour.write(mixed, viewport=area)


def _clip_to(area: Rectangle, view: PlacedView) -> Floats64:
    """Return the matrix for row vectors from clip space to an area's pixels and depths, (4, 4)."""
    left, bottom, width, height = view.viewport
    matrix = np.diag([0.5 * width, 0.5 * height, 0.5, 1.0])
    matrix[3] = 0.5 * width + left - area[0], 0.5 * height + bottom - area[1], 0.5, 1.0
    return matrix


def _visible_surfaces(drawn: Drawn, view: PlacedView) -> Iterator[_Surface]:
    """Yield all surfaces that samples may see, in the order of coverage.py."""
    if drawn.skin is not None:
        yield _skin_surface(drawn, drawn.skin, view)
    for each in drawn.parts:
        if each.buffers.kind == "SHELLS":
            yield _hair_surface(each, view)
        elif not each.buffers.strand_radius:
            yield _part_surface(each, drawn.cut if each.part.lies_beneath else None, view)


def _skin_surface(drawn: Drawn, skin: Skin, view: PlacedView) -> _Surface:
    """Return both sides of the skin."""
    mesh = skin.stream.mesh
    rows = mesh.vertices
    values = np.zeros((len(rows), 3))
    if drawn.has_normals:
        values[:, 0] = unit_vectors(rows[:, 3:6] @ view.world_to_view[:3, :3])[:, 1]
    if drawn.is_opened:
        cut = np.array(drawn.cut or NO_CUT)
        values[:, 1] = rows[:, :3] @ cut[:3] + cut[3]
    kind = TRIANGLE_KIND if drawn.has_triangles else SURFACE_KIND
    clip = _multiplied(rows[:, :3], view.world_to_clip)
    return _Surface(
        corners=clip,
        values=values,
        triangles=mesh.triangles.view(np.int32),
        kind=kind,
        numbers=SKIN_NUMBERS,
        has_back=True,
    )


def _part_surface(placed: PlacedBuffers, cut: CutPlane | None, view: PlacedView) -> _Surface:
    """Return a solid part; cut: plane in front of which skin hides the part, see sunk.glsl."""
    model_view = placed.part.transform.T @ view.world_to_view
    positions = _multiplied(placed.part.vertices, model_view)[:, :3]
    clip = _multiplied(positions, view.projection)
    if cut is not None:
        plane = np.array(in_view(cut, view))
        most = SUNK_DEPTH * view.camera.scene_radius
        beyond = np.clip(positions @ plane[:3] + plane[3], 0.0, most)[:, None]
        sunk = _multiplied(positions + beyond * unit_vectors(positions), view.projection)
        clip[:, 2] = sunk[:, 2] / sunk[:, 3] * clip[:, 3]
    values = np.zeros((len(positions), 3))
    return _surface_of(placed, clip, values, SURFACE_KIND)


def _hair_surface(placed: PlacedBuffers, view: PlacedView) -> _Surface:
    """Return the outline of short hair; see coverage.glsl."""
    striation = placed.part.part.striation
    assert striation is not None  # all short hair has it
    layers = placed.buffers.layer_count(view)
    number = np.floor(_MEAN_PLACE * layers - _LOWEST_PLACE + 0.5)
    place = (number + _LOWEST_PLACE) / layers
    model_view = placed.part.transform.T @ view.world_to_view
    outline = placed.part.vertices + (place - _MEAN_PLACE) * striation[:, 2:5]
    positions = _multiplied(outline, model_view)[:, :3]
    normals = unit_vectors(placed.part.normals @ model_view[:3, :3])
    facing = -(normals * unit_vectors(positions)).sum(axis=1)
    values = np.stack([striation[:, 5], facing, striation[:, 6]], axis=1).astype(np.float64)
    clip = _multiplied(positions, view.projection)
    return _surface_of(placed, clip, values, HAIR_KIND)


def _surface_of(placed: PlacedBuffers, clip: Floats64, values: Floats64, kind: int) -> _Surface:
    """Return the front of a part with these corners in clip space, (V, 4), and values, (V, 3)."""
    return _Surface(
        corners=clip,
        values=values,
        triangles=placed.buffers.faces.astype(np.int32, copy=False),
        kind=kind,
        numbers=part_numbers(placed),
        has_back=False,
    )


def _multiplied(points: npt.NDArray[np.floating], matrix: Floats64) -> Floats64:
    """Multiply points (n, 3) by a matrix for row vectors (4, 4); returns (n, 4)."""
    return np.asarray(points @ matrix[:3] + matrix[3])
