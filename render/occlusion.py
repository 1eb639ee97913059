"""Which triangles of the parts cannot be seen, found before they are drawn.

Teeth behind closed lips cost software OpenGL as much as teeth that are visible: it walks over every
triangle and tests each sample. So the depths of what was drawn before are read back, the farthest
of each block of pixels, and triangles that lie behind are left out; not one pixel changes. Graphics
cards do without: they would wait for the answer longer than they take to draw.
Source: hierarchical occlusion maps, Zhang et al. 1997; blocks of depths as in Greene et al. 1993.
"""

from typing import Any

import moderngl
import numpy as np
import numpy.typing as npt

from .programs import compile_program
from .render_target import Rectangle, RenderTarget

BLOCK = 8  # pixels each way
_WINDOWS = 5  # how many tables to look up: of 1, 2, 4, 8, 16 blocks each way
# By how many blocks a face's last one is from its first -> the table that holds them all.
_LEVELS = np.ceil(np.log2(np.arange(1, 2 ** (_WINDOWS - 1) + 2))).astype(np.intp)
_UNIT = 5  # texture unit while reading depths
_PADDING = 1.0  # [pixels] around a triangle, for samples that lie off the pixels' middles
_TOLERANCE = 1e-6  # of depth: it has 24 bits

FloatArray = npt.NDArray[np.float64]
Depths = npt.NDArray[np.float32]
Indices = npt.NDArray[np.intp]


class DepthReader:
    """Reads the farthest depth of each block of the layer; belongs to one target."""

    def __init__(self, gl: moderngl.Context, scene: RenderTarget) -> None:
        self.scene = scene
        self._gl = gl
        width, height = scene.size
        self._size = -(-width // BLOCK), -(-height // BLOCK)
        self._program = compile_program(
            gl, "farthest.glsl", f"SAMPLES {scene.samples}", f"BLOCK {BLOCK}"
        )
        self._program["depths"] = _UNIT
        self._program["last"] = width - 1, height - 1
        self._triangle = gl.vertex_array(self._program, [])
        self._target = gl.framebuffer([gl.texture(self._size, 1, dtype="f4")])
        self._blocks: Rectangle = (0, 0, 0, 0)  # of the last search

    def find_farthest(self, pixels: Rectangle) -> None:
        """Find the farthest depths of the blocks that hold the rectangle `pixels`."""
        gl = self._gl
        left, bottom = pixels[0] // BLOCK, pixels[1] // BLOCK
        width = -(-(pixels[0] + pixels[2]) // BLOCK) - left
        height = -(-(pixels[1] + pixels[3]) // BLOCK) - bottom
        self._blocks = left, bottom, width, height
        self.scene.use_depth(_UNIT)
        self._target.use()
        gl.viewport, gl.scissor = (0, 0, *self._size), self._blocks
        gl.disable(moderngl.DEPTH_TEST)
        self._triangle.render(moderngl.TRIANGLES, vertices=3)
        gl.enable(moderngl.DEPTH_TEST)
        gl.scissor = None

    def read(self) -> "FarthestDepths":
        """Return what was found; waits until all is drawn, so find other work before."""
        left, bottom, width, height = self._blocks
        data = self._target.read(viewport=self._blocks, components=1, dtype="f4")
        return FarthestDepths(np.frombuffer(data, np.float32).reshape(height, width), left, bottom)


class ProjectedFaces:
    """The faces of a part as the camera sees them, and those that turn their front to it.

    candidates: their numbers, shape (k,). nearest: their nearest depth, 0..1, shape (k,).
    left, right, bottom, top: the first and last block that each touches, shape (k,).
    """

    def __init__(
        self, vertices: Depths, corners: Indices, matrix: FloatArray, viewport: Rectangle
    ) -> None:
        """Project vertices, shape (n, 3), and faces by their corners, shape (3, m).

        matrix: model -> clip space, for row vectors, shape (4, 4). viewport: [pixels].
        """
        self.count = corners.shape[1]
        clip = vertices @ matrix[:3].astype(np.float32) + matrix[3].astype(np.float32)
        self.reaches_behind_the_eye = not (clip[:, 2] > -clip[:, 3]).all()
        if self.reaches_behind_the_eye:
            return
        place = clip[:, :3] / clip[:, 3:]
        x = (0.5 * viewport[2]) * (place[:, 0] + 1.0) + viewport[0]
        y = (0.5 * viewport[3]) * (place[:, 1] + 1.0) + viewport[1]
        depth = 0.5 * place[:, 2] + 0.5
        a, b, c = corners
        area = (x[b] - x[a]) * (y[c] - y[a]) - (x[c] - x[a]) * (y[b] - y[a])
        self.candidates = np.flatnonzero(area > -1e-3)  # [pixels^2]
        a, b, c = corners[:, self.candidates]
        self.nearest = np.minimum(np.minimum(depth[a], depth[b]), depth[c]) - np.float32(_TOLERANCE)
        self.left, self.right = _covered_blocks(x[a], x[b], x[c])
        self.bottom, self.top = _covered_blocks(y[a], y[b], y[c])


class FarthestDepths:
    """The farthest depth in windows of blocks: one table for each size of window."""

    def __init__(self, depths: Depths, left: int, bottom: int) -> None:
        self._left, self._bottom = left, bottom
        tables = [depths]
        for level in range(_WINDOWS - 1):
            tables.append(_doubled(tables[-1], 1 << level))
        self._tables = np.stack([*tables, depths])  # the last stands for "too large a face"

    def visible(self, faces: ProjectedFaces) -> npt.NDArray[np.bool_]:
        """Which faces turn their front to the eye and may be seen, shape (m,).

        What the viewport shows of the faces has to lie within the blocks that were read.
        """
        if faces.reaches_behind_the_eye:
            return np.ones(faces.count, np.bool_)
        _, rows, columns = self._tables.shape
        left = np.clip(faces.left - self._left, 0, columns - 1)
        right = np.clip(faces.right - self._left, 0, columns - 1)
        bottom = np.clip(faces.bottom - self._bottom, 0, rows - 1)
        top = np.clip(faces.top - self._bottom, 0, rows - 1)
        level = _LEVELS[np.minimum(np.maximum(right - left, top - bottom), len(_LEVELS) - 1)]
        is_visible = np.zeros(faces.count, np.bool_)
        farthest = self._tables[level, bottom, left]
        is_visible[faces.candidates] = (faces.nearest <= farthest) | (level == _WINDOWS)
        return is_visible


def _covered_blocks(a: Depths, b: Depths, c: Depths) -> tuple[Indices, Indices]:
    """First and last block of faces whose corners have these coordinates along one axis."""
    low = np.minimum(np.minimum(a, b), c) - _PADDING
    high = np.maximum(np.maximum(a, b), c) + _PADDING
    return _block(low), _block(high)


def _block(places: npt.NDArray[np.floating[Any]]) -> Indices:
    blocks: Indices = np.floor(np.clip(places, -1e6, 1e6) / BLOCK).astype(np.intp)
    return blocks


def _doubled(table: Depths, size: int) -> Depths:
    """From windows of `size` blocks to windows twice as large; they end at the border."""
    wide = table.copy()
    np.maximum(wide[:, :-size], table[:, size:], out=wide[:, :-size])
    high = wide.copy()
    np.maximum(high[:-size], wide[size:], out=high[:-size])
    return high
