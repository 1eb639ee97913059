"""Draw coverage: the surface that each sample of a pixel sees, without lighting."""

from collections.abc import Sequence
from typing import NamedTuple

import moderngl

from .camera import PlacedView
from .frame import CutPlane, Skin
from .parts import PlacedBuffers
from .programs import compile_program, write_uniform
from .render_target import Rectangle, RenderTarget
from .translucency import CUT_WIDTH, NO_CUT, SUNK_DEPTH, set_cut

Numbers = tuple[float, float, float]  # the uniform `numbers` of surface_number.glsl
SKIN_NUMBERS = 190.0, 63.0, 254.0


class Drawn(NamedTuple):
    """The surfaces of a frame that have been drawn in a view.

    skin: None if the skin has not been drawn yet.
    cut: plane that cuts an opened skin; None for a closed skin.
    is_opened: whether the skin is translucent.
    has_triangles: whether each triangle of the skin counts as a separate surface.
    has_normals: whether surface numbers of the skin depend on normals, as in per-pixel shading.
    """

    skin: Skin | None
    parts: Sequence[PlacedBuffers]
    cut: CutPlane | None = None
    is_opened: bool = False
    has_triangles: bool = False
    has_normals: bool = True


class Coverage:
    """Surface numbers and depths of several samples per pixel of a target.

    numbers, depths: multisample textures.
    """

    def __init__(self, gl: moderngl.Context, target: RenderTarget) -> None:
        self._gl = gl
        self.numbers = gl.texture(target.size, 1, samples=target.samples)
        self.depths = gl.depth_texture(target.size, samples=target.samples)
        self._frame = gl.framebuffer([self.numbers], self.depths)
        self._programs: dict[tuple[str, ...], moderngl.Program] = {}

    def draw(self, drawn: Drawn, view: PlacedView, area: Rectangle) -> None:
        """Draw surfaces within an area."""
        gl = self._gl
        gl.scissor = None
        self._frame.clear(depth=1.0)
        self._frame.use()
        gl.viewport = view.viewport
        gl.scissor = area
        gl.enable_only(moderngl.DEPTH_TEST)
        if drawn.skin is not None:
            self._draw_skin(drawn, drawn.skin, view)
        for each in drawn.parts:
            if not each.buffers.strand_radius:
                self._draw_part(each, drawn.cut if each.part.lies_beneath else None, view)

    def _draw_skin(self, drawn: Drawn, skin: Skin, view: PlacedView) -> None:
        """Draw both sides of the skin."""
        defines = ["TRANSLUCENT"] * drawn.is_opened + ["TRIANGLES"] * drawn.has_triangles
        defines += ["PIXEL"] * drawn.has_normals
        program = self._program(view, SKIN_NUMBERS, *defines)
        write_uniform(program, "model_view", view.world_to_view)
        if drawn.is_opened:
            set_cut(program, view, drawn.cut or NO_CUT, CUT_WIDTH)
        skin.stream.draw(program)

    def _draw_part(self, placed: PlacedBuffers, cut: CutPlane | None, view: PlacedView) -> None:
        """Draw a solid part, or the outline of short hair."""
        is_hair = placed.buffers.kind == "SHELLS"
        defines = ["SHELLS"] * is_hair + ["SUNK"] * (cut is not None)
        program = self._program(view, part_numbers(placed), *defines)
        write_uniform(program, "model_view", placed.part.transform.T @ view.world_to_view)
        if is_hair:
            program["layers"] = placed.buffers.layer_count(view)
        if cut is not None:
            set_cut(program, view, cut, SUNK_DEPTH)
        placed.buffers.draw(program)

    def _program(self, view: PlacedView, numbers: Numbers, *defines: str) -> moderngl.Program:
        """Return the program with some defines, and set its uniforms."""
        if defines not in self._programs:
            self._programs[defines] = compile_program(self._gl, "coverage.glsl", *defines)
        program = self._programs[defines]
        write_uniform(program, "projection", view.projection)
        set_numbers(program, numbers, view)
        return program


def part_numbers(placed: PlacedBuffers) -> Numbers:
    """Return the surface numbers of a part."""
    return float(placed.number), 0.0, float(placed.number)


def set_numbers(program: moderngl.Program, numbers: Numbers, view: PlacedView) -> None:
    """Set the uniforms with which a program writes surface numbers."""
    for name, value in (("numbers", numbers), ("depth_range", view.depth_range)):
        # Absent in programs for strands, or without depths; `in` would look at all names.
        if program.get(name, None) is not None:
            program[name] = value
