"""Smooth the edges of a picture by several samples per pixel, although each pixel is shaded once.

Surfaces are drawn a second time, without light, to find the surface that each sample sees. Where
the samples of a pixel see several surfaces, the colours of these surfaces are mixed. On software
OpenGL shading takes most of the time of a picture; shading every sample would take twice as long.
Source of the idea: Ragan-Kelley et al. 2011, "Decoupled sampling for graphics pipelines".
"""

from collections.abc import Sequence
from typing import Protocol

import moderngl

from .camera import PlacedView
from .coverage import Coverage, Drawn
from .programs import compile_program
from .render_target import PICTURE_UNIT, Rectangle, RenderTarget, around

# Sampler -> texture unit.
_TEXTURE_UNITS = {
    "colours": PICTURE_UNIT,
    "sample_numbers": 5,
    "sample_depths": 6,
    "surfaces": 7,
}


class Mixer(Protocol):
    """Smooths the edges on one target."""

    target: RenderTarget

    def mix(self, drawn: Drawn, view: PlacedView, areas: Sequence[Rectangle]) -> None:
        """Smooth the edges of drawn surfaces; areas: rectangles that contain all of them."""


class SampleMixer:
    """Smooths the edges on one target, by programs on the graphics card."""

    def __init__(self, gl: moderngl.Context, target: RenderTarget) -> None:
        self.target = target
        self._gl = gl
        self._coverage = Coverage(gl, target)
        self._copy = gl.texture(target.size, 4)
        self._copied = gl.framebuffer([self._copy])
        found = gl.depth_renderbuffer(target.size)
        self._found = gl.framebuffer(depth_attachment=found)
        self._mixed = gl.framebuffer([target.colour], found)
        self._mixed.depth_mask = False
        self._find = self._pass("FIND")
        self._mix = self._pass()

    def _pass(self, *defines: str) -> moderngl.VertexArray:
        """Make a pass over all pixels of the target with some defines."""
        samples = f"SAMPLES {self.target.samples}"
        program = compile_program(self._gl, "mixing.glsl", samples, *defines)
        for name, unit in _TEXTURE_UNITS.items():
            if name in program:
                program[name] = unit
        return self._gl.vertex_array(program, [])

    def mix(self, drawn: Drawn, view: PlacedView, areas: Sequence[Rectangle]) -> None:
        """Smooth the edges of drawn surfaces; areas: rectangles that contain all of them."""
        gl = self._gl
        area = around(areas)
        bands = _bands_around(areas)
        self.target.surfaces.use(_TEXTURE_UNITS["surfaces"])
        self._found.use()
        gl.scissor = None
        self._found.clear(depth=1.0)
        self._run(self._find, view, area, bands)
        self._coverage.draw(drawn, view, area)
        gl.scissor = None
        gl.copy_framebuffer(self._copied, self.target.frame)
        self._copy.use(_TEXTURE_UNITS["colours"])
        self._coverage.numbers.use(_TEXTURE_UNITS["sample_numbers"])
        self._coverage.depths.use(_TEXTURE_UNITS["sample_depths"])
        self._mixed.use()
        gl.depth_func = "=="
        self._run(self._mix, view, area, bands)
        gl.depth_func = "<="

    def _run(
        self,
        shaded: moderngl.VertexArray,
        view: PlacedView,
        area: Rectangle,
        bands: Sequence[Rectangle],
    ) -> None:
        """Run a pass over some bands of an area."""
        gl = self._gl
        left, bottom, width, height = area
        program = shaded.program
        program["area"] = left, bottom, left + width - 1, bottom + height - 1
        program["tolerance"] = view.depth_tolerance
        if "depth_range" in program:
            program["depth_range"] = view.depth_range
        gl.viewport = 0, 0, *self.target.size
        gl.enable_only(moderngl.DEPTH_TEST)
        for band in bands:
            gl.scissor = band
            shaded.render(moderngl.TRIANGLES, vertices=3)


def _bands_around(areas: Sequence[Rectangle]) -> list[Rectangle]:
    """Return horizontal bands that contain all areas, each as wide as the areas in it.

    So wide shoulders do not widen the bands of the head.
    """
    _, bottom, _, height = around(areas)
    band_height = 64  # [pixels]; height of the tiles in which software draws
    bands = []
    for low in range(bottom, bottom + height, band_height):
        high = min(low + band_height, bottom + height)
        within = [each for each in areas if each[1] < high and low < each[1] + each[3]]
        if within:
            left, _, width, _ = around(within)
            bands.append((left, low, width, high - low))
    return bands
