"""Which triangles are hidden behind others: software need not shade them.

Software OpenGL shades all that it multisamples, and does not save work by its depth tests: the back
of a head costs as much as its front. So the depths of front faces are read back, the farthest of
each tile of 8 x 8 pixels, and triangles that lie behind these in all tiles that they touch are left
out. That changes no pixel: each of their samples would fail its depth test. (Measured 2026-11-22,
two heads of 640 x 720, 4 samples: 185 -> 152 ms of processor.)
Source: Greene, Kass, Miller 1993, "Hierarchical Z-buffer visibility".
"""

from collections.abc import Sequence

import moderngl
import numpy as np
import numpy.typing as npt

from ..geometry.arrays import Flags, Floats32
from ..geometry.transforms import moved_points
from .camera import PlacedView
from .frame import Frame
from .parts import PlacedBuffers
from .programs import compile_program
from .render_target import Rectangle, RenderTarget
from .stream import Share
from .style import ColourBy

TILE = 8  # [pixels] each way
LEVELS = 5  # tables of the farthest depth: of tiles, and of squares of 2, 4, 8 and 16 of them
MARGIN = 1e-4  # of the range of depths: beyond the rounding of drivers, 0.05 mm on a head
SLIVER = 0.5 / TILE**2  # [tiles**2], twice the area up to which a triangle may turn to either side
_UNIT = 1  # texture unit: the one of the layer


class Occluder:
    """Reads the farthest depths back from the layer of a target."""

    def __init__(self, gl: moderngl.Context, target: RenderTarget) -> None:
        self.target = target
        self._gl = gl
        program = compile_program(gl, "farthest.glsl", f"SAMPLES {target.samples}", f"TILE {TILE}")
        program["depths"] = _UNIT
        self._pass = gl.vertex_array(program, [])
        columns, rows = (-(-pixels // TILE) for pixels in target.size)
        self._tiles = gl.framebuffer([gl.texture((columns, rows), 1, dtype="f4")])

    def look(self, view: PlacedView, area: Rectangle) -> "FarthestDepths":
        """The depths of all that was drawn within an area [pixels]; nothing hides elsewhere."""
        columns, rows = self._tiles.size
        left = area[0] // TILE
        bottom = area[1] // TILE
        right, top = (-(-(area[k] + area[k + 2]) // TILE) for k in (0, 1))
        self._tiles.use()
        self._gl.enable_only(moderngl.NOTHING)
        self._gl.viewport = (0, 0, columns, rows)
        self._gl.scissor = None
        self._tiles.clear(1.0)
        self._gl.scissor = left, bottom, right - left, top - bottom
        self.target.layer_depth.use(_UNIT)
        self._pass.render(moderngl.TRIANGLES, vertices=3)
        self._gl.scissor = None
        self._gl.enable_only(moderngl.DEPTH_TEST)
        read = np.frombuffer(self._tiles.read(components=1, dtype="f4"), np.float32)
        return FarthestDepths(view, read.reshape(rows, columns))


class FarthestDepths:
    """The farthest depth in each tile of a target, as a view saw it."""

    def __init__(self, view: PlacedView, tiles: Floats32) -> None:
        """tiles: depths by row and column."""
        self._view = view
        self._farthest = [tiles]  # by level
        for _ in range(1, LEVELS):
            last = self._farthest[-1]
            even = np.pad(last, [(0, count % 2) for count in last.shape])
            by_twos = even.reshape(len(even) // 2, 2, -1, 2)
            self._farthest.append(by_twos.max(axis=(1, 3)))

    def choose_parts(self, placed: Sequence[PlacedBuffers]) -> None:
        """Choose the faces of parts that are not surely hidden; all at once, which takes less."""
        vertices = []
        faces = []
        first = 0
        for buffers, part in placed:
            for side in buffers.sides():
                vertices.append(moved_points(part.transform, side))
                faces.append(buffers.faces + first)
                first += len(side)
        if not placed:
            return
        is_seen = self.may_be_seen(np.concatenate(vertices), np.concatenate(faces))
        ends = np.cumsum([len(each) for each in faces])
        chosen = iter(np.split(is_seen, ends[:-1]))
        for buffers, _ in placed:
            buffers.choose(np.logical_or.reduce([next(chosen) for _ in buffers.sides()]))

    def may_be_seen(
        self,
        vertices: npt.NDArray[np.floating],
        triangles: npt.NDArray[np.integer],
        *,
        away: bool = False,
    ) -> Flags:
        """Which triangles (M, 3) of vertices in the world, (V, 3), are not surely hidden, (M,).

        away: of those that turn away from the eye, else to it; none of the others.
        """
        matrix = self._view.world_to_clip.astype(np.float32)
        left, bottom, width, height = self._view.viewport
        with np.errstate(all="ignore"):  # a corner that is not finite is not surely hidden
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
            a = a[turned]
            b = b[turned]
            c = c[turned]
            nearest = np.minimum(np.minimum(z[a], z[b]), z[c])
            # A pixel to spare on each side.
            low = [np.minimum(np.minimum(at[a], at[b]), at[c]) - 1.0 / TILE for at in (x, y)]
            high = [np.maximum(np.maximum(at[a], at[b]), at[c]) + 1.0 / TILE for at in (x, y)]
            farthest = self._farthest_within(low, high)
        is_seen = np.zeros(len(triangles), bool)
        is_seen[turned] = ~np.isfinite(nearest + low[0] + low[1]) | (nearest <= farthest + MARGIN)
        return is_seen

    def _farthest_within(self, low: list[Floats32], high: list[Floats32]) -> Floats32:
        """The farthest depth of all tiles between two places [tiles]; 1 between distant ones."""
        rows, columns = self._farthest[0].shape
        # A corner that is not finite may be in any tile.
        (left, right), (bottom, top) = (
            [np.fmin(np.fmax(at[axis], 0.0), count - 1).astype(np.intp) for at in (low, high)]
            for axis, count in enumerate((columns, rows))
        )
        farthest = np.ones(len(left), np.float32)
        for level in reversed(range(LEVELS)):  # the finest at which two squares each way hold it
            ends = [at >> level for at in (left, right, bottom, top)]
            fits = np.flatnonzero((ends[1] - ends[0] <= 1) & (ends[3] - ends[2] <= 1))
            x0, x1, y0, y1 = (at[fits] for at in ends)
            table = self._farthest[level]
            corners = [table[y, x] for y in (y0, y1) for x in (x0, x1)]
            farthest[fits] = np.maximum.reduce(corners)
        return farthest


def draw_sides(
    gl: moderngl.Context,
    frame: Frame,
    shares: Sequence[tuple[moderngl.Program, Share]],
    view: PlacedView,
    occluder: Occluder | None,
    *,
    blends: bool = False,
) -> FarthestDepths | None:
    """Draw shares of a frame's skin with software: front faces first; the depths of these.

    Back faces are mostly hidden: drawn last, the hidden ones are not shaded at all if nothing is
    multisampled. Else an occluder, if there is one, leaves out those that are certainly hidden.
    """
    assert frame.skin is not None
    stream = frame.skin.stream
    flags = moderngl.CULL_FACE | (moderngl.BLEND if blends else moderngl.NOTHING)
    gl.enable(flags)
    gl.cull_face = "back"
    for program, share in shares:
        stream.draw(program, share)
    depths = None
    is_free = frame.style.colour_by is ColourBy.NONE  # else values go by the order of triangles
    if is_free and occluder is not None:
        covered = view.covered_pixels(stream.corners)
        depths = occluder.look(view, covered)
        positions = stream.mesh.vertices[:, :3]
        stream.choose(depths.may_be_seen(positions, stream.mesh.triangles, away=True))
        occluder.target.use_layer(view.viewport, covered)
        gl.enable(flags)
        # Back faces show no bumps, so the last program draws them.
        shares = [(shares[-1][0], Share.CHOSEN)]
    gl.cull_face = "front"
    for program, share in shares:
        stream.draw(program, share)
    gl.cull_face = "back"
    gl.disable(moderngl.CULL_FACE)
    return depths
