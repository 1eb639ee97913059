"""What a clip looks like in one frame, surface by surface, as mesh files hold them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from risorius.geometry.normals import vertex_normals

from ..refining.presets import Refinement
from .clip import Clip, Floats, Indices, Singles, Surface

GREY = 0.8  # of what has neither colours nor a texture


@dataclass(frozen=True)
class FrameSurface:
    """One surface in one frame [mm].

    name: that of the surface. points, normals, colours (sRGB 0..1): of vertices, shape (V, 3).
    faces: shape (F, 3). uv, face_uv: as in `Surface`; None without a texture. source: the triangle
    of the surface that each triangle is part of, shape (F,).
    """

    name: str
    points: Floats
    normals: Floats
    colours: Floats
    faces: Indices
    uv: Singles | None
    face_uv: Indices | None
    source: Indices


def frame_surfaces(
    clip: Clip, refinement: Refinement | None = None
) -> Iterator[list[FrameSurface]]:
    """All surfaces of each frame, the skin first, which is refined where that is asked for."""
    colours = {each.name: _colours(clip, each) for each in clip.surfaces}
    skins = None if refinement is None else _refined(clip, refinement)
    for frame in range(clip.frame_count):
        skin = None if skins is None else next(skins)
        plain = clip.surfaces if skin is None else clip.surfaces[1:]
        rest = [_plain(each, frame, colours[each.name]) for each in plain]
        yield rest if skin is None else [skin, *rest]


def _plain(surface: Surface, frame: int, colours: Floats) -> FrameSurface:
    """A surface as it is."""
    points = surface.at(frame)
    return FrameSurface(
        surface.name,
        points,
        vertex_normals(points, surface.faces),
        colours,
        surface.faces,
        surface.uv,
        surface.face_uv,
        np.arange(len(surface.faces), dtype=np.int32),
    )


def _refined(clip: Clip, refinement: Refinement) -> Iterator[FrameSurface]:
    """The refined skin of each frame, in arrays of its own."""
    for mesh in clip.refined(refinement):
        faces = mesh.triangles.astype(np.int32)
        yield FrameSurface(
            clip.skin.name,
            mesh.positions.astype(np.float64),
            mesh.normals.astype(np.float64),
            _painted(clip, len(mesh.positions), mesh.uv),
            faces,
            None if mesh.uv is None else mesh.uv.copy(),
            None if mesh.uv is None else faces,
            mesh.source.copy(),
        )


def _colours(clip: Clip, surface: Surface) -> Floats:
    """The colours of a surface's vertices, its own or those of the texture there."""
    if surface.colours is not None:
        return surface.colours.astype(np.float64)
    if surface.uv is None or surface.face_uv is None:
        return _painted(clip, len(surface.rest), None)
    uv = np.zeros((len(surface.rest), 2), np.float32)
    uv[surface.faces.ravel()] = surface.uv[surface.face_uv.ravel()]
    return _painted(clip, len(uv), uv)


def _painted(clip: Clip, count: int, uv: Singles | None) -> Floats:
    """What colours the skin's texture has at these coordinates, shape (count, 3)."""
    if clip.scene.albedo is None or uv is None:
        return np.full((count, 3), GREY)
    height, width = clip.scene.albedo.shape[:2]
    column = np.clip((uv[:, 0] * width).astype(int), 0, width - 1)
    row = np.clip(((1.0 - uv[:, 1]) * height).astype(int), 0, height - 1)
    colours: Floats = clip.scene.albedo[row, column] / 255.0
    return colours
