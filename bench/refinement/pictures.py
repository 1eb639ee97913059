"""What a person sees of a refined mesh: pictures of it beside pictures of the dense mesh.

All meshes of a subject are drawn in the same pose from the same cameras, in plain clay without
texture or shadows, shaded per pixel with the normals that the mesh has. Each picture is drawn
SUPERSAMPLING times too large and averaged, so that an outline that is off by a part of a pixel
counts by that part, as it does on a screen.

    with Pictures(subject) as pictures:
        error = pictures.error("joy", (positions, normals, triangles))
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from risorius import refine, render
from risorius.geometry.normals import vertex_normals

from ..subjects import Subject

Array = npt.NDArray[np.float64]
Mesh = Any
"""Positions [mm] and unit normals, shape (N, 3), and triangles, shape (M, 3); RefinedMesh fits."""

SIZE = 480
"""Width and height of a picture [pixels]."""
SUPERSAMPLING = 2
VIEWS = ("front", "three-quarter", "profile")
CLAY = render.Style(textured=False, albedo=render.CLAY, shadows=False, bumps=0.0)
BACKGROUND = 215
"""Grey level behind the mesh, about that of the window's."""


@dataclass(frozen=True)
class PictureError:
    """How the pictures of one mesh differ from those of the dense one, over all views."""

    rms: float
    """Root mean square of grey levels, over the pixels that either mesh covers."""
    outline: float
    """Pixels covered by one mesh and not by the other, mean over views."""


@dataclass(frozen=True)
class Shots:
    """Pictures of one mesh from all views."""

    grey: Array
    """Grey levels over the background, 0..255, shape (views, SIZE, SIZE)."""
    covered: npt.NDArray[np.bool_]
    """Which fine pixels the mesh covers, shape (views, fine, fine)."""


class Pictures:
    """Draws meshes of one subject; a context manager."""

    def __init__(self, subject: Subject, *, views: tuple[str, ...] = VIEWS) -> None:
        self._subject = subject
        fine = SIZE * SUPERSAMPLING
        self._surface = render.open_offscreen((fine, fine), samples=0)
        self._renderer = render.Renderer(self._surface)
        shown = np.concatenate([pose.dense for pose in (subject.rest, *subject.poses.values())])
        self._cameras = [render.OrbitCamera.framing(shown, view=view) for view in views]
        eye = self._cameras[0]
        self.view = refine.View(eye.eye, eye.focal(1.0, SIZE))
        """Where the first picture is taken from, for criteria that ask."""
        self._stream: render.Stream | None = None
        self._truth: dict[str, Shots] = {}

    def __enter__(self) -> Pictures:
        return self

    def __exit__(self, *_: object) -> None:
        self._surface.close()

    def error(self, expression: str, mesh: Mesh) -> PictureError:
        """Measure a mesh in one expression of the subject against its dense mesh."""
        if expression not in self._truth:
            dense = shaded(self._subject.poses[expression].dense, self._subject.dense_faces)
            # One expression after the other: older ones are not kept.
            self._truth = {expression: self.shoot(dense)}
        return difference(self.shoot(mesh), self._truth[expression])

    def shoot(self, mesh: Mesh) -> Shots:
        """Draw a mesh from all views."""
        stream = self._upload(mesh)
        greys, covers = [], []
        for camera in self._cameras:
            self._surface.begin()
            self._renderer.draw_mesh(stream, camera, CLAY)
            self._surface.end()
            red, green, blue = np.moveaxis(self._surface.read().astype(np.uint16), 2, 0)
            levels = red + green + blue
            covered = levels > 0  # lit clay is nowhere black, an empty frame is
            levels[~covered] = 3 * BACKGROUND
            greys.append(_block_sums(levels) / (3.0 * SUPERSAMPLING**2))
            covers.append(covered)
        return Shots(np.stack(greys), np.stack(covers))

    def _upload(self, mesh: Mesh) -> render.Stream:
        positions, normals, triangles = mesh[:3]
        stream = self._stream
        if (
            stream is None
            or len(stream.vertices) < len(positions)
            or len(stream.triangles) < len(triangles)
        ):
            room = 2 * len(positions), 2 * len(triangles)
            self._stream = stream = self._renderer.lend_stream(*room)
        stream.vertices[: len(positions)] = np.concatenate([positions, normals], axis=1)
        stream.triangles[: len(triangles)] = triangles
        stream.upload(len(positions), len(triangles))
        return stream


def difference(shots: Shots, truth: Shots) -> PictureError:
    """Compare pictures of a mesh with those of the dense one."""
    either = _block_sums(shots.covered | truth.covered)
    off = (shots.grey - truth.grey)[either]
    wrong = int(np.count_nonzero(shots.covered != truth.covered)) / SUPERSAMPLING**2
    return PictureError(float(np.sqrt(np.mean(off**2))), wrong / len(shots.grey))


def _block_sums(fine: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """Sums over the fine pixels of each pixel: shape (.., SIZE, SIZE)."""
    steps = range(SUPERSAMPLING)
    parts = [fine[..., i::SUPERSAMPLING, j::SUPERSAMPLING] for i in steps for j in steps]
    return np.asarray(sum(parts[1:], parts[0]))


def shaded(
    positions: Array, faces: npt.NDArray[np.integer]
) -> tuple[Array, Array, npt.NDArray[np.integer]]:
    """A mesh as it is, with unit vertex normals weighted by area."""
    return positions, vertex_normals(positions, faces), faces
