"""What of the parts is left out before they are drawn: only what cannot be seen."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest

from risorius import render
from risorius.render.occlusion import BLOCK, FarthestDepths, ProjectedFaces

from .scenes import PLAIN, Ball, Shape, facing, joined, lent, sphere, square


def wall_with_slit(height: float) -> Shape:
    """Two squares one above the other, `height` apart, before the origin."""
    lower, upper = square(40.0, z=25.0), square(40.0, z=25.0)
    lower.positions[:, 1] -= 40.0 + 0.5 * height
    upper.positions[:, 1] += 40.0 + 0.5 * height
    return joined(lower, upper)


def scene(
    surface: render.Surface,
    wall: Shape,
    camera: render.OrbitCamera,
    viewport: render.Viewport | None = None,
) -> tuple[render.Image, list[int]]:
    """Two balls behind a wall; the image, and how many faces of each ball were drawn."""
    renderer = render.Renderer(surface)
    stream = lent(renderer, wall)
    balls = [Ball(colour=(0.9, 0.2, 0.1)), Ball(bone="jaw", shine=0.8)]
    aside = np.eye(4)
    aside[:3, 3] = (24.0, 3.0, -8.0)
    style = replace(PLAIN, shadows=True)
    surface.begin()
    renderer.draw_background(style, viewport)
    renderer.draw_mesh(stream, camera, style, viewport=viewport)
    renderer.draw_parts(
        balls, {"cranium": np.eye(4), "jaw": aside}, camera, style, viewport=viewport
    )
    surface.end()
    return surface.read(), [renderer._parts.known[id(ball)].face_count for ball in balls]


@pytest.mark.parametrize("samples", [0, 4])
@pytest.mark.parametrize("height", [0.0, 0.4, 3.0, 30.0])
def test_not_one_pixel_changes(
    monkeypatch: pytest.MonkeyPatch, samples: int, height: float
) -> None:
    """Through slits of any width the same is seen as when all triangles are drawn."""
    with render.open_offscreen((150, 110), samples=samples) as surface:
        for yaw, zoom, viewport in ((0.0, 1.0, None), (25.0, 2.5, (13, 7, 120, 90)), (80, 9, None)):
            camera = facing()
            camera.orbit(yaw, 10.0)
            camera.zoom(zoom)
            images = []
            for is_software in (True, False):
                monkeypatch.setattr(type(surface), "is_software", is_software)
                images.append(scene(surface, wall_with_slit(height), camera, viewport)[0])
            assert (images[0] == images[1]).all()


@pytest.mark.parametrize("samples", [0, 4])
def test_depths_of_an_earlier_picture_hide_nothing(
    monkeypatch: pytest.MonkeyPatch, samples: int
) -> None:
    """Parts alone look the same in every frame, whatever was drawn in the one before."""
    with render.open_offscreen((150, 110), samples=samples) as surface:
        monkeypatch.setattr(type(surface), "is_software", True)
        renderer = render.Renderer(surface)
        wall, ball = lent(renderer, square(40.0, z=25.0)), Ball()
        images = []
        for is_walled in (False, True, False):
            surface.begin()
            renderer.draw_background(PLAIN)
            if is_walled:
                renderer.draw_mesh(wall, facing(), PLAIN)
            renderer.draw_parts([ball], {"cranium": np.eye(4)}, facing(), PLAIN)
            surface.end()
            images.append(surface.read())
        assert (images[0] != images[1]).any()
        assert (images[0] == images[2]).all()


def test_hidden_faces_are_left_out(
    surface: render.Surface, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Behind a closed wall nothing is drawn, through a slit little, on a graphics card all."""
    monkeypatch.setattr(type(surface), "is_software", True)
    total = len(Ball().faces)
    _, behind = scene(surface, wall_with_slit(0.0), facing())
    _, through = scene(surface, wall_with_slit(3.0), facing())
    _, before = scene(surface, wall_with_slit(200.0), facing())
    assert behind[0] == 0 < behind[1] < 0.25 * total  # the second one looks out beside the wall
    assert 0 < through[0] < 0.35 * total
    assert 0.35 * total < before[0] < 0.6 * total  # its back is left out in any case
    monkeypatch.setattr(type(surface), "is_software", False)
    assert scene(surface, wall_with_slit(0.0), facing())[1] == [total, total]


def brute_force(
    depths: npt.NDArray[np.float32], corners: npt.NDArray[np.float32], left: int, bottom: int
) -> bool:
    """Whether one face is no farther than the farthest depth of the blocks it touches."""
    first = ((corners[:, :2].min(axis=0) - 1.0) // BLOCK).astype(int) - (left, bottom)
    last = ((corners[:, :2].max(axis=0) + 1.0) // BLOCK).astype(int) - (left, bottom)
    first, last = np.maximum(first, 0), np.minimum(last, np.array(depths.shape[::-1]) - 1)
    window = depths[first[1] : last[1] + 1, first[0] : last[0] + 1]
    return bool(corners[:, 2].min() <= window.max())


def test_tables_never_hide_more_than_a_search(generator: np.random.Generator) -> None:
    """Whatever a search through all blocks leaves in, the look-up in the tables leaves in."""
    view = (0, 0, 320, 240)
    depths = generator.uniform(0.2, 0.8, (20, 25)).astype(np.float32)
    farthest = FarthestDepths(depths, 5, 4)
    pixels = np.empty((3 * 500, 3), np.float32)
    centres = generator.uniform((45, 40), (230, 180), (500, 2))
    sizes = generator.choice([2.0, 8.0, 25.0, 60.0], 500)
    for corner in range(3):
        angle = np.radians(90.0 + 120.0 * corner)
        pixels[corner::3, :2] = centres + sizes[:, None] * 0.6 * (np.cos(angle), np.sin(angle))
    pixels[:, 2] = np.repeat(generator.uniform(0.3, 1.0, 500), 3)
    clip = pixels / (160.0, 120.0, 0.5) - 1.0
    faces = np.arange(1500).reshape(-1, 3).T
    seen = farthest.visible(ProjectedFaces(clip.astype(np.float32), faces, np.eye(4), view))
    searched = [brute_force(depths, pixels[3 * face : 3 * face + 3], 5, 4) for face in range(500)]
    assert (seen | ~np.array(searched)).all()
    assert 50 < np.count_nonzero(~seen)


def test_faces_behind_the_eye_hide_nothing() -> None:
    """Where a part reaches behind the eye, all of it is drawn."""
    matrix = np.eye(4)
    matrix[3, 3] = 0.0
    matrix[2, 3] = -1.0  # w = -z
    vertices = sphere(1, 1.0).positions
    faces = sphere(1).triangles.T.astype(np.intp)
    farthest = FarthestDepths(np.zeros((4, 4), np.float32), 0, 0)
    assert farthest.visible(ProjectedFaces(vertices, faces, matrix, (0, 0, 32, 32))).all()
