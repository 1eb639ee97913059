"""Which triangles are hidden behind what was drawn: software need not shade them.

Software OpenGL shades whatever it multisamples, and tests depth without using the answer to save
work: the back of a head costs as much as its front. So the depths of what turns to the eye are
read back, the farthest of each tile of 8 x 8 pixels, and triangles that lie behind these in all
tiles that they touch are left out. That changes no pixel: each of their samples would fail its
depth test. (Measured 2026-11-22, two heads of 640 x 720, 4 samples: 185 -> 152 ms of processor.)
Source: Greene, Kass, Miller 1993, "Hierarchical Z-buffer visibility".
"""

from collections.abc import Sequence

import moderngl
import numpy as np
import numpy.typing as npt

from .camera_view import CameraView, FloatArray
from .parts import PlacedPart
from .programs import compile_program
from .render_target import Rectangle, RenderTarget
from .stream import Share, Stream

TILE = 8  # [pixels] each way
LARGEST = 16  # tiles: side of the largest squares of which the farthest depth is kept
MARGIN = 1e-4  # of the range of depths: beyond the rounding of drivers, 0.05 mm on a head
_UNIT = 1  # texture unit: the one of the layer


class Occluder:
    """The farthest depths, in tiles of a target, of what was drawn on its layer so far."""

    def __init__(self, gl: moderngl.Context, target: RenderTarget) -> None:
        self.target = target
        self._gl = gl
        program = compile_program(gl, "farthest.glsl", f"SAMPLES {target.samples}", f"TILE {TILE}")
        program["depths"] = _UNIT
        self._pass = gl.vertex_array(program, [])
        columns, rows = (-(-pixels // TILE) for pixels in target.size)
        self._tiles = gl.framebuffer([gl.texture((columns, rows), 1, dtype="f4")])
        self._farthest = np.ones((1, 1, 1))  # level, row, column
        self._view: CameraView | None = None
        self._layer_number = -1

    def is_of(self, view: CameraView, target: RenderTarget) -> bool:
        """Whether what it saw, through this view, is still on the target's layer."""
        return (
            self._view is not None
            and self._view.fingerprint == view.fingerprint
            and self._view.viewport == view.viewport
            and self.target is target
            and self._layer_number == target.layer_number
        )

    def look(self, view: CameraView, area: Rectangle) -> None:
        """Take the depths within an area [pixels] of a view; nothing is hidden elsewhere."""
        self._view, self._layer_number = view, self.target.layer_number
        columns, rows = self._tiles.size
        left, bottom = area[0] // TILE, area[1] // TILE
        right, top = (-(-(area[k] + area[k + 2]) // TILE) for k in (0, 1))
        self._tiles.use()
        self._gl.enable_only(moderngl.NOTHING)
        self._gl.viewport, self._gl.scissor = (0, 0, columns, rows), None
        self._tiles.clear(1.0)
        self._gl.scissor = left, bottom, right - left, top - bottom
        self.target.layer_depth.use(_UNIT)
        self._pass.render(moderngl.TRIANGLES, vertices=3)
        self._gl.scissor = None
        self._gl.enable_only(moderngl.DEPTH_TEST)
        read = np.frombuffer(self._tiles.read(components=1, dtype="f4"), np.float32)
        tables: list[FloatArray] = [read.reshape(rows, columns).astype(np.float64)]
        while 1 << len(tables) <= LARGEST:
            tables.append(_doubled(tables[-1], 1 << (len(tables) - 1)))
        self._farthest = np.stack(tables)

    def choose_parts(self, placed: Sequence[PlacedPart]) -> None:
        """Choose the faces of parts that are not surely hidden; all at once, which takes less."""
        vertices, faces, first = [], [], 0
        for buffers, transform in placed:
            part = buffers.part
            vertices.append(part.vertices @ transform[:3, :3].T + transform[:3, 3])
            faces.append(part.faces + first)
            first += len(part.vertices)
        if not placed:
            return
        is_seen = self.may_be_seen(np.concatenate(vertices), np.concatenate(faces))
        ends = np.cumsum([len(each) for each in faces])
        for (buffers, _), chosen in zip(placed, np.split(is_seen, ends[:-1]), strict=True):
            buffers.choose(chosen)

    def may_be_seen(
        self, vertices: npt.NDArray[np.floating], triangles: npt.NDArray[np.integer]
    ) -> npt.NDArray[np.bool_]:
        """Which triangles (M, 3) of vertices in the world, (V, 3), are not surely hidden, (M,)."""
        view = self._view
        assert view is not None
        matrix = view.world_to_clip
        left, bottom, width, height = view.viewport
        with np.errstate(all="ignore"):  # what is not finite is not surely hidden
            clip = vertices @ matrix[:3] + matrix[3]
            place = (clip[:, :3] / clip[:, 3:]).T
            place = np.where(clip[:, 3] > 0.0, place, np.nan)
            # In tiles, a pixel to spare on each side; and depths.
            x = (left + 0.5 * width * (place[0] + 1.0)) / TILE
            y = (bottom + 0.5 * height * (place[1] + 1.0)) / TILE
            a, b, c = triangles.T
            x, y, z = ((each[a], each[b], each[c]) for each in (x, y, 0.5 * (place[2] + 1.0)))
            nearest = np.minimum(np.minimum(*z[:2]), z[2])
            spare = 1.0 / TILE
            low = [np.minimum(np.minimum(*each[:2]), each[2]) - spare for each in (x, y)]
            high = [np.maximum(np.maximum(*each[:2]), each[2]) + spare for each in (x, y)]
            is_known = np.isfinite(nearest + low[0] + low[1])
            first = [self._tile(each, axis) for axis, each in enumerate(low)]
            last = [self._tile(each, axis) for axis, each in enumerate(high)]
        # Squares as large as fit, one in each corner, hold all tiles that a triangle touches.
        reach = np.maximum(last[0] - first[0], last[1] - first[1]) + 1
        level = np.minimum(np.frexp(np.maximum(reach, 1))[1] - 1, len(self._farthest) - 1)
        side = 1 << level
        is_known &= reach <= 2 * side
        ends = [np.maximum(last[axis] + 1 - side, first[axis]) for axis in (0, 1)]
        rows, columns = self._farthest.shape[1:]
        flat = self._farthest.ravel()
        above = [(level * rows + row) * columns for row in (first[1], ends[1])]
        corners = [flat[row + column] for row in above for column in (first[0], ends[0])]
        farthest = np.maximum(np.maximum(*corners[:2]), np.maximum(*corners[2:]))
        is_seen: npt.NDArray[np.bool_] = ~is_known | (nearest <= farthest + MARGIN)
        return is_seen

    def _tile(self, place: npt.NDArray[np.floating], axis: int) -> npt.NDArray[np.int64]:
        """The number of the tile that holds a place [tiles] along x or y."""
        last = self._farthest.shape[2 - axis] - 1
        numbers: npt.NDArray[np.int64] = np.clip(np.nan_to_num(place), 0, last).astype(np.int64)
        return numbers


def draw_sides(
    gl: moderngl.Context,
    stream: Stream,
    shares: Sequence[tuple[moderngl.Program, Share]],
    view: CameraView | None,
    occluder: Occluder | None,
) -> None:
    """Draw shares of a mesh with software: what turns to the eye goes first.

    What turns away is mostly hidden: drawn last, it is not shaded at all, if nothing is
    multisampled. Else it is left out where that is certain, which needs a view and an occluder.
    """
    gl.enable(moderngl.CULL_FACE)
    gl.cull_face = "back"
    for program, share in shares:
        stream.draw(program, share)
    is_chosen = False
    if view is not None and occluder is not None and occluder.target.samples:
        is_chosen = True
        covered = view.covered_pixels(stream.corners)
        occluder.look(view, covered)
        positions = stream.vertices[: stream.vertex_count, :3]
        triangles = stream.triangles[: stream.triangle_count]
        stream.choose(occluder.may_be_seen(positions, triangles))
        occluder.target.use_layer(view.viewport, covered)
        gl.enable(moderngl.CULL_FACE)
    gl.cull_face = "front"
    for program, share in shares:
        stream.draw(program, share, chosen=is_chosen)
    gl.cull_face = "back"
    gl.disable(moderngl.CULL_FACE)


def _doubled(farthest: FloatArray, side: int) -> FloatArray:
    """From squares of `side` tiles to squares twice as large, each named by its lowest tile."""
    wider = farthest.copy()
    np.maximum(wider[:, :-side], farthest[:, side:], out=wider[:, :-side])
    result = wider.copy()
    np.maximum(result[:-side], wider[side:], out=result[:-side])
    return result
