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

from .camera import CameraView
from .parts import PlacedPart
from .programs import compile_program
from .render_target import Rectangle, RenderTarget
from .stream import MeshBuffers, Share
from .style import ColourBy, Style

TILE = 8  # [pixels] each way
SIDES = 1, 2, 4, 8  # tiles: of squares of which the farthest depth is kept, and of twice them
MARGIN = 1e-4  # of the range of depths: beyond the rounding of drivers, 0.05 mm on a head
SLIVER = 0.5 / TILE**2  # [tiles**2], twice the area up to which a triangle may turn to either side
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
        self._farthest = np.ones((1, 1, 1), np.float32)  # level, row, column
        self._view: CameraView | None = None
        self._layer_number = -1

    def is_of(self, view: CameraView, target: RenderTarget) -> bool:
        """Whether what it saw, through this view, is still on the target's layer."""
        return (
            self._view is view
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
        tables = [read.reshape(rows, columns)]
        for side in SIDES:  # from squares of so many tiles to twice as large ones
            padded = np.pad(tables[-1], ((0, side), (0, side)))
            wider = np.maximum(padded[:, :-side], padded[:, side:])
            tables.append(np.maximum(wider[:-side], wider[side:]))
        self._farthest = np.stack(tables)  # each square is named by its lowest tile

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
        self,
        vertices: npt.NDArray[np.floating],
        triangles: npt.NDArray[np.integer],
        *,
        away: bool = False,
    ) -> npt.NDArray[np.bool_]:
        """Which triangles (M, 3) of vertices in the world, (V, 3), are not surely hidden, (M,).

        away: of those that turn away from the eye, else to it; none of the others.
        """
        assert self._view is not None
        matrix = self._view.world_to_clip.astype(np.float32)
        left, bottom, width, height = self._view.viewport
        with np.errstate(all="ignore"):  # what is not finite is not surely hidden
            x, y, z, w = np.ascontiguousarray(
                (vertices.astype(np.float32, copy=False) @ matrix[:3] + matrix[3]).T
            )
            inverse = np.where(w > 0.0, 1.0 / w, np.float32(np.nan))
            # In tiles; and depths.
            x = (left + 0.5 * width * (x * inverse + 1.0)) / TILE
            y = (bottom + 0.5 * height * (y * inverse + 1.0)) / TILE
            z = 0.5 * (z * inverse + 1.0)
            a, b, c = triangles.T.astype(np.intp)
            turn = (x[b] - x[a]) * (y[c] - y[a]) - (x[c] - x[a]) * (y[b] - y[a])
            turned = np.flatnonzero(~((turn if away else -turn) > SLIVER))
            a, b, c = a[turned], b[turned], c[turned]
            nearest = np.minimum(np.minimum(z[a], z[b]), z[c])
            # A pixel to spare on each side.
            low = [np.minimum(np.minimum(at[a], at[b]), at[c]) - 1.0 / TILE for at in (x, y)]
            high = [np.maximum(np.maximum(at[a], at[b]), at[c]) + 1.0 / TILE for at in (x, y)]
            farthest = self._farthest_within(low, high)
        is_seen = np.zeros(len(triangles), bool)
        is_seen[turned] = ~np.isfinite(nearest + low[0] + low[1]) | (nearest <= farthest + MARGIN)
        return is_seen

    def _farthest_within(
        self, low: list[npt.NDArray[np.float32]], high: list[npt.NDArray[np.float32]]
    ) -> npt.NDArray[np.float32]:
        """The farthest depth of all tiles between two places [tiles]; 1 between distant ones."""
        rows, columns = self._farthest.shape[1:]
        # What is no number may be in any tile.
        first, last = (
            [np.fmin(np.fmax(at, 0.0), count - 1).astype(np.intp) for at, count in pairs]
            for pairs in (zip(ends, (columns, rows), strict=True) for ends in (low, high))
        )
        # Squares as large as fit, one in each corner, hold all tiles that a triangle touches.
        reach = np.maximum(last[0] - first[0], last[1] - first[1]) + 1
        level = np.clip(np.frexp(reach)[1] - 1, 0, len(SIDES))
        side = 1 << level
        ends = [np.maximum(last[axis] + 1 - side, first[axis]) for axis in (0, 1)]
        flat = self._farthest.ravel()
        above = [(level * rows + row) * columns for row in (first[1], ends[1])]
        corners = [flat[row + column] for row in above for column in (first[0], ends[0])]
        farthest = np.maximum(np.maximum(*corners[:2]), np.maximum(*corners[2:]))
        return np.where(reach <= 2 * side, farthest, np.float32(1.0))


def draw_sides(
    gl: moderngl.Context,
    stream: MeshBuffers,
    shares: Sequence[tuple[moderngl.Program, Share]],
    view: CameraView,
    style: Style,
    occluder: Occluder | None,
) -> None:
    """Draw shares of a mesh with software: what turns to the eye goes first.

    What turns away is mostly hidden: drawn last, it is not shaded at all, if nothing is
    multisampled. Else it is left out where that is certain, which needs an occluder.
    """
    gl.enable(moderngl.CULL_FACE)
    gl.cull_face = "back"
    for program, share in shares:
        stream.draw(program, share)
    is_free = style.colour_by is ColourBy.NONE  # else values go by the order of triangles
    if is_free and occluder is not None and occluder.target.samples:
        covered = view.covered_pixels(stream.corners)
        occluder.look(view, covered)
        positions = stream.frame.vertices[:, :3]
        stream.choose(occluder.may_be_seen(positions, stream.frame.triangles, away=True))
        occluder.target.use_layer(view.viewport, covered)
        gl.enable(moderngl.CULL_FACE)
        # What turns away shows no bumps, so the last program does for it.
        shares = [(shares[-1][0], Share.CHOSEN)]
    gl.cull_face = "front"
    for program, share in shares:
        stream.draw(program, share)
    gl.cull_face = "back"
    gl.disable(moderngl.CULL_FACE)
