"""Draws meshes, rigid parts, lines and backgrounds on a surface.

Every call takes a view: a camera in a viewport, (x, y, width, height) in pixels from the lower left
corner, whose aspect it takes on. All other pixels stay as they are. A `clip` draws only a part of
the viewport: two clips make one image of two meshes.
Programs are compiled on first use, one per combination of shading and options.
Source: Kähler et al. 2003, Fig. 1 (the rendering stage) and section 5 (how the figures are shaded).
"""

from collections.abc import Iterable, Mapping, Sequence
from contextlib import nullcontext
from types import MappingProxyType

import moderngl
import numpy as np
import numpy.typing as npt

from .camera import CameraView, OrbitCamera, box_corners
from .compositor import Backdrop
from .geometry_buffer import Geometry, GeometryBuffer
from .hidden import Occluder, draw_sides
from .lines import Lines
from .materials import (
    mesh_shader,
    part_shader,
    set_light,
    set_mesh,
    set_part,
    value_texture,
)
from .parts import Part, PartStore
from .programs import compile_program, write_uniform
from .render_target import Rectangle, scaled
from .shadow import ShadowMap, Thrower
from .stream import GpuStream, MeshBuffers, Share, Stream
from .style import ColourBy, Style
from .surface import NEWEST_VERSION, Surface
from .texture import BumpMap, Texture
from .translucency import (
    SUNK_DEPTH,
    Plane,
    blending,
    draw_nearest,
    fade_seen,
    set_cut,
    set_translucency,
)

# Texture units; the target uses 1.
_VALUE_UNIT = 0
_SHADOW_UNIT = 2
_ALBEDO_UNIT = 3


class Renderer:
    """The drawing calls of one surface, and the programs and buffers behind them."""

    def __init__(self, surface: Surface) -> None:
        surface.make_current()
        self.surface = surface
        self._gl = surface.gl
        self.lends_gpu_streams = self._gl.version_code >= NEWEST_VERSION
        self._programs: dict[tuple[str, ...], moderngl.Program] = {}
        self._parts = PartStore(self._gl)
        self._values: moderngl.Texture | None = None
        self._backdrop = Backdrop(self._gl)
        self._shadow: ShadowMap | None = None
        self._shadow_of: MeshBuffers | None = None  # whose shadow is there before it is drawn
        self._geometry_buffer: GeometryBuffer | None = None
        self._occluder: Occluder | None = None

    def lend_stream(self, vertex_capacity: int, triangle_capacity: int, columns: int = 6) -> Stream:
        """Lend arrays for a mesh of at most so many vertices and triangles (see Stream)."""
        self.surface.make_current()
        return Stream(self._gl, vertex_capacity, triangle_capacity, columns)

    def lend_gpu_stream(
        self, vertex_capacity: int, triangle_capacity: int, columns: int, margin: float
    ) -> GpuStream:
        """Lend buffers to a program that makes such a mesh on the graphics card (see GpuStream).

        margin: how far its vertices are beyond those of the mesh that it is made of, at most.
        """
        self.surface.make_current()
        return GpuStream(self._gl, vertex_capacity, triangle_capacity, columns, margin)

    def view(
        self,
        camera: OrbitCamera,
        viewport: Rectangle | None = None,
        clip: Rectangle | None = None,
    ) -> CameraView:
        """The view of a camera in a viewport, by default the whole frame; drawing calls take it.

        clip: the part of the viewport in which anything is drawn.
        """
        return CameraView(camera, self._viewport(viewport), clip and self._viewport(clip))

    def _viewport(self, viewport: Rectangle | None) -> Rectangle:
        self.surface.make_current()
        if viewport is None:
            return (0, 0, *self.surface.target.size)
        return scaled(viewport, self.surface.scale)

    def draw_background(self, style: Style, *viewports: Rectangle) -> None:
        """Paint the background of a style over viewports, before anything is drawn; none: all."""
        areas = tuple(self._viewport(each) for each in viewports or (None,))
        self._backdrop.paint(self.surface.target, areas, style.background)

    def draw_mesh(
        self,
        stream: MeshBuffers,
        view: CameraView,
        style: Style,
        *,
        values: npt.NDArray[np.uint8] | None = None,
        texture: Texture | None = None,
        bumps: BumpMap | None = None,
        cut: Plane | None = None,
        fade: Plane | None = None,
    ) -> None:
        """Draw the last upload of `stream`.

        values: the number that colours each triangle, see `ColourBy`, shape (M,), uint8; needed
            unless that is NONE. Raises ValueError where it does not fit.
        texture: the albedo of the front side, unless the style is not textured, and its fine shape;
            needs a stream of 8 columns, ValueError else.
        bumps: fine shape, as far as the style and the amounts that were uploaded let it show;
            per-pixel shading alone has it. Needs 8 columns, too.
        cut: in front of it the mesh is opaque. Parts that are seen through it are drawn before it.
        fade: a x + b y + c z + d, from 0 to 1, is the share of the mesh that shows at (x, y, z).
        """
        if texture is not None or bumps is not None:
            stream.check_uv()
        if style.colour_by is not ColourBy.NONE:
            self._values = value_texture(self._gl, values, stream.triangle_count)
        if style.shadows and self._shadow_of is not stream:
            self._cast([stream], view, style)
        self._shadow_of = None
        if not self._use_layer(view, stream.corners):
            return
        fade = fade_seen(fade, stream, view)
        drawn = [
            (self._mesh_program(view, style, texture, relief, fade), share)
            for share, relief in _shares(stream, style, bumps)
        ]
        if style.opacity < 1.0:
            for program, _ in drawn:
                set_translucency(program, style, view, cut)
            draw_nearest(self._gl, stream, drawn)
            return
        with nullcontext() if fade is None else blending(self._gl, hides=True):
            if self.surface.is_software:
                occluder = self._target_occluder()
                blends = fade is not None
                draw_sides(self._gl, stream, drawn, view, style, occluder, blends=blends)
            else:
                for program, share in drawn:
                    stream.draw(program, share)

    def _target_occluder(self) -> Occluder | None:
        """The occluder of the target where pixels have several samples; else the last one."""
        target = self.surface.target
        occluder = self._occluder
        if target.samples and (occluder is None or occluder.target is not target):
            self._occluder = Occluder(self._gl, target)
        return self._occluder

    def cast_shadows(
        self,
        parts: Iterable[Part],
        transforms: Mapping[str, npt.NDArray[np.float64]],
        view: CameraView,
        style: Style,
        *,
        stream: MeshBuffers | None = None,
    ) -> None:
        """Let parts, not the mesh, throw the shadow on parts that are drawn next.

        stream: a mesh that is drawn next; it throws the shadow, too, and takes that of the parts.
        """
        mesh = [] if stream is None else [stream]
        self._cast([*mesh, *self._parts.placed(parts, transforms)], view, style)
        self._shadow_of = stream

    def _cast(self, throwers: Sequence[Thrower], view: CameraView, style: Style) -> None:
        if self._shadow is None:
            self._shadow = ShadowMap(self._gl)
        self._shadow.draw(throwers, view, self.surface.target.frame_number, style.light.to_key)

    def _mesh_program(
        self,
        view: CameraView,
        style: Style,
        texture: Texture | None,
        bumps: BumpMap | None,
        fade: Plane | None,
    ) -> moderngl.Program:
        """The program of a mesh, with all that it asks for."""
        maps = {} if bumps is None else {bumps: style.bumps}
        fine = None if texture is None else texture.fine_shape
        if fine is not None and style.shows_fine_shape:
            maps[fine] = 1.0
        texture = texture if style.textured else None
        names = mesh_shader(style, texture is not None, maps, fade is not None)
        program = self._program(*names)
        write_uniform(program, "model_view", view.world_to_view)
        write_uniform(program, "projection", view.projection)
        if fade is not None:
            program["fade"] = fade
        set_mesh(program, style, view, self._line_scale)
        if style.shadows and self._shadow is not None:
            self._shadow.set_uniforms(program, view, _SHADOW_UNIT)
        if texture is not None:
            texture.set_uniforms(program, _ALBEDO_UNIT, float(style.skin_maps))
        for map_, strength in maps.items():
            map_.set_uniforms(program, strength)
        if style.colour_by is not ColourBy.NONE:
            assert self._values is not None
            self._values.use(_VALUE_UNIT)
            program["triangle_values"] = _VALUE_UNIT
        return program

    def draw_parts(
        self,
        parts: Iterable[Part],
        transforms: Mapping[str, npt.NDArray[np.float64]],
        view: CameraView,
        style: Style,
        *,
        cut: Plane | None = None,
    ) -> None:
        """Draw coloured parts, each moved by the matrix of its bone (column vectors); shells last.

        Draw them after the mesh: it throws its shadow on them. A part's arrays are uploaded when it
        is first seen and must not change after; a part that changes its shape hands out others.
        Raises ValueError for a bone without transform.
        cut: in front of it an opaque mesh will hide them, even where they come out of it.
        """
        shadow = self._shadow if style.shadows else None
        if shadow is not None and not shadow.is_of(view, self.surface.target.frame_number):
            shadow = None
        placed = self._parts.placed(parts, transforms)
        corners = [each.corners @ bone[:3, :3].T + bone[:3, 3] for each, bone in placed]
        if not placed or not self._use_layer(view, np.concatenate(corners)):
            return
        occluder = self._occluder
        if is_chosen := occluder is not None and occluder.is_of(view, self.surface.target):
            occluder.choose_parts(placed)
        programs = {}
        for kind in {each.kind for each, _ in placed}:
            names = part_shader(kind, shadow is not None, cut is not None)
            programs[kind] = program = self._program(*names)
            write_uniform(program, "projection", view.projection)
            set_light(program, style.light)
            if cut is not None and "cut" in program:
                set_cut(program, view, cut, SUNK_DEPTH)
            if shadow is not None and "shadow_map" in program:
                shadow.set_uniforms(program, view, _SHADOW_UNIT)
        for buffers, bone in sorted(placed, key=lambda each: each[0].is_mixed):
            program = programs[buffers.kind]
            write_uniform(program, "model_view", bone.T @ view.world_to_view)
            set_part(program, buffers, style.light, view)
            if buffers.kind == "SHELLS":
                buffers.draw_shells(program, view, chosen=is_chosen)
                continue
            with blending(self._gl) if buffers.is_mixed else nullcontext():
                buffers.draw(program, chosen=is_chosen)

    def draw_geometry(
        self,
        stream: MeshBuffers,
        parts: Iterable[Part],
        transforms: Mapping[str, npt.NDArray[np.float64]],
        view: CameraView,
        *,
        maps: Mapping[BumpMap, float] = MappingProxyType({}),
    ) -> Geometry:
        """Numbers for each pixel of the surface, whose picture stays as it is.

        maps: fine shape that tilts normals, and how much of each, 0 to 1; a map that needs amounts
            counts for nothing where none were uploaded. Raises ValueError for a bone without
            transform.
        """
        if self._geometry_buffer is None or self._geometry_buffer.size != self.surface.target.size:
            self._geometry_buffer = GeometryBuffer(self._gl, self.surface.target.size)
        placed = self._parts.placed(parts, transforms)
        if not stream.has_bumps:
            maps = {each: strength for each, strength in maps.items() if each.define != "BUMPS"}
        return self._geometry_buffer.draw(stream, placed, view, maps)

    def draw_lines(self, lines: Lines, view: CameraView) -> None:
        """Draw polylines over the scene; where something hides them they shine through."""
        program = self._program("lines.glsl")
        rows, segments = lines.segments()
        if not len(segments):
            return
        width = lines.width * self._line_scale
        write_uniform(program, "world_to_clip", view.world_to_clip)
        program["viewport_size"] = view.viewport[2:]
        program["half_width"] = 0.5 * width
        if not self._use_layer(view, box_corners(rows[:, :3]), padding=2.0 + width):
            return
        content = [(self._gl.buffer(rows), "3f 3f", "in_position", "in_colour")]
        drawn = self._gl.vertex_array(program, content, self._gl.buffer(segments))
        with blending(self._gl):
            for depth_func, share in ((">", lines.hidden_opacity), ("<=", lines.opacity)):
                if share > 0.0:
                    self._gl.depth_func = depth_func
                    program["opacity"] = share
                    drawn.render(moderngl.LINES)

    @property
    def _line_scale(self) -> float:
        return self.surface.pixel_scale * self.surface.scale

    def _program(self, name: str, *defines: str) -> moderngl.Program:
        key = (name, *defines)
        if key not in self._programs:
            has_geometry_stage = name == "lines.glsl" or "WIREFRAME" in defines
            self._programs[key] = compile_program(
                self._gl, name, *defines, has_geometry_stage=has_geometry_stage
            )
        return self._programs[key]

    def _use_layer(
        self, view: CameraView, corners: npt.NDArray[np.float64], padding: float = 2.0
    ) -> bool:
        """Set the drawing area to the hull of corners; False where the view does not see it."""
        covered = view.covered_pixels(corners, padding)
        if is_seen := min(covered[2:]) > 0:
            self.surface.target.use_layer(view.viewport, covered)
        return is_seen


def _shares(
    stream: MeshBuffers, style: Style, bumps: BumpMap | None
) -> list[tuple[Share, BumpMap | None]]:
    """The triangles that are drawn alike, and their bumps; values go by the order of all."""
    if bumps is None or not (style.shows_bumps and stream.has_bumps):
        return [(Share.ALL, None)]
    if style.colour_by is not ColourBy.NONE:
        return [(Share.ALL, bumps)]
    return [(Share.BUMPED, bumps), (Share.SMOOTH, None)]
