"""Small shapes to draw, and helpers that read images."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

from risorius import render
from risorius.geometry.arrays import Flags, Floats32, Integers32, Unsigned8, Unsigned32
from risorius.geometry.directions import unit_vectors
from tests.meshes import ball

SignedImage = npt.NDArray[np.int32]  # differences of images, (H, W, 3)

PLAIN_STYLE = render.Style(background=render.WHITE, shadows=False)
"""Skin before pure white, so all other pixels are drawn ones."""

LIGHT_SKIN = (0.88, 0.75, 0.685)
DARK_SKIN = (0.47, 0.325, 0.255)
"""Albedos."""

STILL_TRANSFORMS = {"cranium": np.eye(4), "eye_left": np.eye(4)}
"""Bones at rest."""


@dataclass(frozen=True, eq=False)
class Shape:
    """Positions (V, 3), normals (V, 3), triangles (M, 3)."""

    positions: Floats32
    normals: Floats32
    triangles: Unsigned32


def sphere(levels: int = 2, radius: float = 50.0) -> Shape:
    """A sphere with smooth normals."""
    unit = ball(levels)
    normals = unit.vertices.astype(np.float32)
    return Shape(normals * np.float32(radius), normals, unit.faces.astype(np.uint32))


def square(half: float = 50.0, *, z: float = 0.0, bulge: float = 0.0) -> Shape:
    """Two triangles that face the viewer; `bulge` tilts the corner normals outward."""
    corners = np.array([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)], np.float32)
    normals = corners * np.float32(bulge) + np.array((0, 0, 1), np.float32)
    normals = unit_vectors(normals)
    positions = corners * np.float32(half) + np.array((0, 0, z), np.float32)
    return Shape(positions, normals, np.array([(0, 1, 2), (0, 2, 3)], np.uint32))


def turned_over(shape: Shape) -> Shape:
    """The shape with its inner side outside."""
    return Shape(shape.positions, -shape.normals, shape.triangles[:, ::-1].copy())


def joined(first: Shape, second: Shape) -> Shape:
    """Both shapes as one mesh."""
    return Shape(
        np.concatenate([first.positions, second.positions]),
        np.concatenate([first.normals, second.normals]),
        np.concatenate([first.triangles, second.triangles + np.uint32(len(first.positions))]),
    )


def lent(renderer: render.Renderer, shape: Shape, *, columns: int = 6) -> render.Stream:
    """A stream with exactly the size of the shape, uploaded."""
    stream = renderer.lend_stream(len(shape.positions), len(shape.triangles), columns)
    stream.vertices[:, :3] = shape.positions
    stream.vertices[:, 3:6] = shape.normals
    stream.triangles[:] = shape.triangles
    stream.upload(len(shape.positions), len(shape.triangles))
    return stream


def facing(half: float = 50.0) -> render.OrbitCamera:
    """A camera in front of the origin that shows about 1.14 times `half` up and down."""
    corners = [(x, y, z) for x in (-half, half) for y in (-half, half) for z in (-half, half)]
    camera = render.OrbitCamera.framing(np.array(corners))
    camera.narrowest_aspect = 0.0
    camera.distance = half * 5.0
    return camera


def draw(
    renderer: render.Renderer,
    skin: render.Skin | render.Stream | None = None,
    style: render.Style = PLAIN_STYLE,
    *,
    parts: Sequence[render.PlacedPart] = (),
    lines: Sequence[render.Lines | render.Shade] = (),
    camera: render.OrbitCamera | None = None,
) -> SignedImage:
    """The picture of one frame, shape (H, W, 3), int32."""
    mesh = render.Skin(skin) if isinstance(skin, render.Stream) else skin
    view = render.CameraView(camera or facing())
    renderer.draw(render.Frame(view, style, mesh, parts, overlays=lines))
    return renderer.surface.read().astype(np.int32)


def still(*parts: Any) -> list[render.PlacedPart]:
    """The parts, placed by bones at rest."""
    return [render.PlacedPart.on_bone(part, STILL_TRANSFORMS) for part in parts]


def draw_image(
    surface: render.Surface,
    shape: Shape,
    style: render.Style = PLAIN_STYLE,
    *,
    camera: render.OrbitCamera | None = None,
    values: Unsigned8 | None = None,
) -> SignedImage:
    """Draw the shape over the style's background on a fresh frame, shape (H, W, 3), int32."""
    renderer = render.Renderer(surface)
    skin = render.Skin(lent(renderer, shape), values=values)
    return draw(renderer, skin, style, camera=camera)


def needs_samples(surface: render.Surface) -> None:
    """Skip a test of smooth edges if the driver has one sample per pixel."""
    if surface.samples < 4:
        driver = surface.gl.info["GL_RENDERER"]
        pytest.skip(f"{driver} has up to {surface.samples} samples a pixel, and 4 are asked for")


def at(image: SignedImage, x: float, y: float) -> Integers32:
    """The colour of the pixel at the point (x, y, 0) in the view of `facing`."""
    height, width, _ = image.shape
    scale = 0.5 * height / (250.0 * np.tan(np.radians(12.5)))
    row = int(0.5 * height - y * scale)
    column = int(0.5 * width + x * scale)
    return np.asarray(image[row, column])


def drawn(image: SignedImage) -> Flags:
    """Flags of pixels that are not the white background, shape (H, W)."""
    return np.asarray((image < 250).any(axis=2))


@dataclass(frozen=True, eq=False)
class Ball:
    """A rigid part: a coloured sphere."""

    colour: tuple[float, float, float] = (0.2, 0.4, 0.9)
    bone: str = "cranium"
    shine: float = 0.0
    name: str = "ball"
    is_enclosed: bool = True
    strand_radius: float = 0.0
    shape: Shape = field(default_factory=lambda: sphere(3, 20.0))

    @property
    def striation(self) -> Floats32 | None:
        return None

    @property
    def vertices(self) -> Floats32:
        return self.shape.positions

    @property
    def normals(self) -> Floats32:
        return self.shape.normals

    @property
    def faces(self) -> Integers32:
        return self.shape.triangles.astype(np.int32)

    @property
    def colours(self) -> Floats32:
        return np.tile(np.array(self.colour, np.float32), (len(self.shape.positions), 1))
