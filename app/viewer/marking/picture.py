"""What is drawn while landmarks are marked: the mesh, and beside it a guide to the next point."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import numpy.typing as npt

from risorius import assets, render
from risorius.geometry.normals import vertex_normals
from risorius.sim.landmarks import MIRRORED

from ...passes.labels import CameraLabels
from ...pipeline import Pipeline, Viewport
from ...refining.presets import STATIC, Refinement
from ...scenes import Scene, build_scene
from ..picture.view import View
from ..settings import Display, Settings
from .marking import Marking
from .marks import GROUP_OF, name_of

FACING = 0.15  # cosine to the line of sight beyond which a mark is seen

FloatArray = npt.NDArray[np.float64]
Spot = tuple[float, float]  # [window units]


class MeshScene(Scene):
    """The mesh where it is placed now."""

    name = "face"
    limits: Mapping[str, tuple[float, float]] = {}

    def __init__(self, marking: Marking) -> None:
        self.rest_positions, self.faces = marking.positions, marking.faces
        self._marking = marking

    @property
    def positions(self) -> FloatArray:
        return self._marking.positions


class MarkingView(View):
    """How the mesh is seen: as clay, by a camera that frames all of it."""

    def __init__(self, marking: Marking, settings: Settings, surface: render.WindowSurface) -> None:
        self._marking, self._settings, self._surface = marking, settings, surface
        self.area, self.pointed = (0.0, 0.0, 1.0, 1.0), {}
        self.guide_area = self.area
        self.fit_scene()

    def fit_scene(self) -> None:
        marking = self._marking
        self.camera = render.OrbitCamera.framing(marking.positions)
        if marking.is_upright:  # all of the face, however much there is of hair and shoulders
            self.camera.fit(marking.seen(marking.marks.places)[0], 0.14)

    @property
    def display(self) -> Display:
        return Display(skin="clay")

    @property
    def state(self) -> object:
        marking = self._marking
        return super().state, id(marking.positions), marking.current, marking.marks.is_complete

    @property
    def drawn(self) -> None:
        """All of the window: the guide is in its upper left corner."""

    @property
    def panel(self) -> render.Rectangle:
        """The part of the framebuffer below the guide."""
        left, bottom, width, _ = self.pixels(self.guide_area)
        return left, 0, width, bottom


class MarkingPicture:
    """Draws both."""

    def __init__(self, marking: Marking, surface: render.WindowSurface) -> None:
        self.surface, self.marking = surface, marking
        self._renderer = render.Renderer(surface)
        self._guide = Pipeline(build_scene("face"), self._renderer)
        self._skin = self._guide.bind(Refinement())
        self._own = Pipeline(MeshScene(marking), self._renderer)
        self._mesh = self._own.bind(Refinement(refiner=STATIC))
        head = assets.load("head")
        self.guide_points = head.vertices[head.landmarks]
        self._guide_normals = vertex_normals(head.vertices, head.faces)[head.landmarks]

    def bind(self, display: Display) -> None:
        """Nothing: the mesh is always drawn alike."""

    def draw(self, view: View) -> None:
        """Draw the mesh, and the guide into its corner."""
        assert isinstance(view, MarkingView)
        self.surface.begin()
        clay = render.Style(albedo=render.CLAY, background=view.background)
        self._own.draw(view.camera, clay, [Viewport(self._mesh, view.viewport)])
        skin = render.Style(background=view.background)
        corner = Viewport(self._skin, view.pixels(view.guide_area))
        self._guide.draw(self.guide_camera(), skin, [corner])
        self.surface.target.flush()
        self.surface.gl.finish()

    def guide_seen(self) -> npt.NDArray[np.bool_]:
        """Which points of the guide look at its camera, shape (68,)."""
        return are_facing(self.guide_camera(), self.guide_points, self._guide_normals)

    def guide_camera(self) -> render.OrbitCamera:
        """The camera that shows the current landmark best; the whole face for the first ones."""
        points, number = self.guide_points, self.marking.current
        camera = render.OrbitCamera.framing(points)
        if self.marking.marks.is_complete:
            group = GROUP_OF[number]
            line = next(line for line in group.lines if number in line)
            camera.target = points[list(line)].mean(axis=0)
            camera.orbit(yaw_of(number))
            camera.zoom(group.zoom / GROUP_OF[0].zoom)
        return camera


def yaw_of(number: int) -> float:
    """From where a landmark is seen best [degrees]."""
    sign = 0.0 if MIRRORED[number] == number else -1.0 if "right" in name_of(number) else 1.0
    return sign * GROUP_OF[number].yaw


def are_facing(
    camera: render.OrbitCamera, points: FloatArray, normals: FloatArray
) -> npt.NDArray[np.bool_]:
    """Whether skin at points (n, 3) looks at a camera, shape (n,)."""
    to_eye = camera.eye - points
    toward = (normals * to_eye).sum(axis=1)
    return np.asarray(toward > FACING * np.linalg.norm(to_eye, axis=1))


def places_in(
    area: tuple[float, float, float, float], camera: render.OrbitCamera, points: FloatArray
) -> list[Spot]:
    """Where a camera that fills an area of the window sees points (n, 3) [window units]."""
    left, top, width, height = area
    seen = CameraLabels.of(camera, (width, max(height, 1.0))).project(points)
    return [(left + x, top + y) for x, y in seen.tolist()]
