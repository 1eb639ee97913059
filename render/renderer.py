"""Draw frames on a surface: meshes, rigid parts, lines and backgrounds.

`Renderer.draw` draws a whole picture. Programs are compiled, and buffers are made, on first use.
They are kept; nothing else of a picture affects the next one. Source: Kähler et al. 2003, Fig. 1
(the rendering stage) and section 5 (how the figures are shaded).
"""

from collections.abc import Sequence
from contextlib import nullcontext
from weakref import WeakValueDictionary

import moderngl
import numpy as np

from ..geometry.arrays import Floats64
from .backdrop import Backdrop
from .camera import PlacedView
from .coverage import SKIN_NUMBERS, Drawn, part_numbers, set_numbers
from .dense_hair import hide_below
from .errors import GLError
from .frame import CutPlane, Frame, Skin
from .geometry_buffer import Geometry, GeometryBuffer
from .materials import (
    mesh_shader,
    part_shader,
    set_light,
    set_mesh,
    set_part,
    value_texture,
)
from .opening import RIM_DEFINE, set_rim
from .overlays import OverlayPainter
from .parts import PartStore, PlacedBuffers
from .programs import compile_program, write_uniform
from .render_target import RenderTarget
from .sample_mixer import Mixer, SampleMixer
from .shadow import Shadow, ShadowMap
from .sides import DrawnGroups, draw_nearest, draw_sides
from .stream import GpuStream, Stream, TriangleGroup
from .style import ColourBy, Shading, Style
from .surface import NEWEST_VERSION, Image, Surface
from .texture import BumpMap
from .translucency import (
    SUNK_DEPTH,
    blending,
    fade_defines,
    set_cut,
    set_translucency,
)

# Texture units; the target uses 1.
_VALUE_UNIT = 0
_SHADOW_UNIT = 2
_ALBEDO_UNIT = 3


class Renderer:
    """Draws on one surface, and owns the programs and buffers of this surface."""

    def __init__(self, surface: Surface) -> None:
        surface.make_current()
        self.surface = surface
        self._gl = surface.gl
        self.lends_gpu_streams = self._gl.version_code >= NEWEST_VERSION
        self._programs: dict[tuple[str, ...], moderngl.Program] = {}
        self._parts = PartStore(self._gl)
        self._bump_maps: WeakValueDictionary[int, BumpMap] = WeakValueDictionary()
        self._backdrop = Backdrop(self._gl)
        self._shadow_map: ShadowMap | None = None
        self._geometry_buffer: GeometryBuffer | None = None
        self._mixer: Mixer | None = None

    def lend_stream(self, vertex_capacity: int, triangle_capacity: int, columns: int = 6) -> Stream:
        """Lend arrays for a mesh of limited numbers of vertices and triangles (see `Stream`)."""
        self.surface.make_current()
        return Stream(self._gl, vertex_capacity, triangle_capacity, columns)

    def lend_gpu_stream(
        self, vertex_capacity: int, triangle_capacity: int, columns: int, margin: float
    ) -> GpuStream:
        """Lend buffers to a program that makes a mesh on the graphics card (see `GpuStream`).

        margin: greatest distance of the made vertices from the bounding box of the source mesh.
        """
        self.surface.make_current()
        return GpuStream(self._gl, vertex_capacity, triangle_capacity, columns, margin)

    def bump_map(self, texels: Image, steepest: float, channels: int = 4) -> BumpMap:
        """Return the map of some texels (see `BumpMap`); equal calls return the same map.

        So skins share maps. A map is released with its last skin. The texels must not change.
        """
        known = self._bump_maps.get(id(texels))
        if known is None or known.steepest != steepest:
            known = BumpMap(self.surface, texels, steepest, channels)
            self._bump_maps[id(texels)] = known
        return known

    def draw(self, *frames: Frame) -> None:
        """Draw a picture of frames, each in its viewport; all other pixels are black.

        A window shows the picture at `Surface.end`. Raises ValueError for a viewport without
        pixels, for values that do not fit the triangles, and for a frame whose stream was filled
        again. Raises GLError if memory is short.
        """
        try:
            self._draw_all(frames)
        except moderngl.Error as error:
            width, height = self.surface.target.size
            raise GLError(
                f"a picture of {width} x {height} pixels cannot be drawn ({error}). Cure: ask for "
                "a smaller one"
            ) from None

    def _draw_all(self, frames: Sequence[Frame]) -> None:
        self.surface.begin()
        target = self.surface.target
        views = [self._placed_view(frame) for frame in frames]
        styles = [frame.style for frame in frames]
        self._backdrop.paint(target, views, [style.background for style in styles])
        for frame, view in zip(frames, views, strict=True):
            self._draw(frame, view)
        target.use_frame()

    def read(self, frame: Frame) -> Geometry:
        """Return the G-buffer of a frame; the picture on the surface does not change.

        Skin and parts are drawn opaque. Strands are thinner than a pixel, so they are left out.
        """
        self.surface.make_current()
        size = self.surface.target.size
        if self._geometry_buffer is None or self._geometry_buffer.size != size:
            self._geometry_buffer = GeometryBuffer(self._gl, size)
        solid = [each for each in frame.parts if not each.part.strand_radius]
        parts = self._parts.uploaded(solid)
        return self._geometry_buffer.draw(frame, parts, self._placed_view(frame))

    def _placed_view(self, frame: Frame) -> PlacedView:
        """Place a frame's view on the current target."""
        if frame.skin is not None:
            frame.skin.check()
        return PlacedView(frame.view, self.surface.target.size, self.surface.scale)

    def _draw(self, frame: Frame, view: PlacedView) -> None:
        """Draw skin, parts and overlays in the order that depth tests and blending need.

        Solid parts come before a translucent skin, which shows them. All other parts come after
        the skin, because they need its shadow and depths. Hair and other fibres come last.
        """
        parts = self._parts.uploaded(frame.parts)
        later = parts
        if frame.is_opened:
            solid = [each for each in parts if not each.buffers.is_mixed]
            later = [each for each in parts if each.buffers.is_mixed]
            self._draw_under(frame, view, solid)
            self._smooth(frame, view, solid, with_skin=False)
            parts = [each.as_background() for each in solid] + later
        shadow = self._shadow(frame, view, later, with_skin=True)
        if frame.skin is not None:
            if not frame.is_opened:
                hide_below(later, view, self.surface.target, self._program("shadow.glsl", "SHELLS"))
            self._draw_skin(frame, view, shadow)
        self._draw_parts(later, frame.style, view, shadow)
        self._smooth(frame, view, parts, with_skin=True)
        # It is not stored, because renderer and painter would keep each other and leak.
        painter = OverlayPainter(self.surface, self._program)
        for overlay in frame.overlays:
            painter.draw(overlay, view)

    def _smooth(
        self, frame: Frame, view: PlacedView, parts: Sequence[PlacedBuffers], *, with_skin: bool
    ) -> None:
        """Smooth the edges of parts, and of the skin if it was drawn."""
        target = self.surface.target
        if not target.samples:
            return
        if self._mixer is None or self._mixer.target is not target:
            self._mixer = self._new_mixer(target)
        skin = frame.skin if with_skin else None
        boxes = [each.corners for each in parts]
        if skin is not None:
            boxes.append(skin.stream.corners)
        areas = [area for area in map(view.covered_pixels, boxes) if min(area[2:]) > 0]
        if areas:
            has_triangles = skin is not None and frame.style.has_numbered_triangles
            drawn = Drawn(
                skin,
                parts,
                frame.cut,
                frame.is_opened,
                has_triangles,
                frame.style.shading is Shading.PIXEL,
            )
            self._mixer.mix(drawn, view, areas)
            if skin is None:
                target.forget_surfaces()

    def _new_mixer(self, target: RenderTarget) -> Mixer:
        """Make the mixer that smooths edges on a target."""
        if not self.surface.is_software:
            return SampleMixer(self._gl, target)
        from .software_mixer import SoftwareMixer  # here, because a GPU does not need numba

        return SoftwareMixer(target)

    def _draw_under(self, frame: Frame, view: PlacedView, parts: Sequence[PlacedBuffers]) -> None:
        """Draw the solid parts that a translucent skin will show; the skin throws no shadow."""
        shadow = self._shadow(frame, view, parts, with_skin=False)
        beneath = [each for each in parts if each.part.lies_beneath]
        others = [each for each in parts if not each.part.lies_beneath]
        self._draw_parts(beneath, frame.style, view, shadow, cut=frame.cut)
        self._draw_parts(others, frame.style, view, shadow)

    def _shadow(
        self, frame: Frame, view: PlacedView, parts: Sequence[PlacedBuffers], *, with_skin: bool
    ) -> Shadow | None:
        """Draw the shadow of some parts and of the skin; None if the frame has no shadows."""
        if not frame.style.shadows or frame.skin is None:
            return None
        if self._shadow_map is None:
            self._shadow_map = ShadowMap(self._gl)
        throwers = [each for each in parts if each.part.throws_shadow]
        return self._shadow_map.draw(frame, view, throwers, with_skin=with_skin)

    def _draw_skin(self, frame: Frame, view: PlacedView, shadow: Shadow | None) -> None:
        """Draw the mesh."""
        assert frame.skin is not None
        skin = frame.skin
        stream = skin.stream
        style = frame.style
        values = None
        if style.colour_by is not ColourBy.NONE:
            values = value_texture(self._gl, skin.values, stream.triangle_count)
        if not self._use_surfaces(view, stream.corners):
            return
        fade = fade_defines(skin, view)
        mouth = () if skin.mouth is None else ("LIPS", RIM_DEFINE)
        if values is not None:
            values.use(_VALUE_UNIT)

        def groups(*defines: str) -> DrawnGroups:
            """Return the groups of triangles, with programs that have these defines."""
            return [
                (self._skin_program(frame, view, maps, shadow, defines), group)
                for group, maps in _groups_with_maps(skin, style)
            ]

        if frame.is_opened:
            drawn = groups(*mouth, *fade)
            for program, _ in drawn:
                set_translucency(program, frame, view)
            draw_nearest(self._gl, stream, drawn, is_cut=frame.cut is not None)
            return
        with blending(self._gl, hides=True) if fade else nullcontext():
            if self.surface.is_software:
                needed = mouth if "MOUTH" in fade else ()
                front = groups("FRONT_ONLY", *needed, *fade)
                draw_sides(self._gl, stream, front, groups(*mouth, *fade))
                return
            for program, group in groups(*mouth, *fade):
                stream.draw(program, group)

    def _skin_program(
        self,
        frame: Frame,
        view: PlacedView,
        maps: dict[BumpMap, float],
        shadow: Shadow | None,
        defines: Sequence[str],
    ) -> moderngl.Program:
        """Return the program of a frame's skin, and set its uniforms and textures."""
        assert frame.skin is not None
        style = frame.style
        texture = frame.skin.maps.texture if style.textured else None
        names = mesh_shader(style, texture is not None, maps, defines)
        program = self._program(*names)
        write_uniform(program, "model_view", view.world_to_view)
        write_uniform(program, "projection", view.projection)
        set_numbers(program, SKIN_NUMBERS, view)
        set_mesh(program, style, view, self._line_scale)
        if frame.skin.mouth is not None and "LIPS" in defines:
            set_rim(program, "rim", frame.skin.mouth, view)
        if shadow is not None:
            shadow.set_uniforms(program, _SHADOW_UNIT)
        if texture is not None:
            texture.set_uniforms(program, _ALBEDO_UNIT, float(style.skin_maps))
        for map_, strength in maps.items():
            map_.set_uniforms(program, strength)
        if style.colour_by is not ColourBy.NONE:
            program["triangle_values"] = _VALUE_UNIT
        return program

    def _draw_parts(
        self,
        parts: Sequence[PlacedBuffers],
        style: Style,
        view: PlacedView,
        shadow: Shadow | None,
        *,
        cut: CutPlane | None = None,
    ) -> None:
        """Draw coloured parts; blended parts come last.

        cut: plane. In front of it opaque skin will hide the parts, even where they pierce the skin.
        """
        corners = [each.corners for each in parts]
        if not parts or not self._use_surfaces(view, np.concatenate(corners)):
            return
        programs = {}
        is_around = bool(style.light.around)
        for kind, opening in {_kind_of(each, style) for each in parts}:
            names = part_shader(kind, opening, shadow is not None, cut is not None, is_around)
            programs[kind, opening] = program = self._program(*names)
            write_uniform(program, "projection", view.projection)
            set_light(program, style.light)
            if cut is not None and "cut" in program:
                set_cut(program, view, cut, SUNK_DEPTH)
            if shadow is not None and "shadow_map" in program:
                shadow.set_uniforms(program, _SHADOW_UNIT)
        for each in sorted(parts, key=lambda each: each.buffers.is_mixed):
            buffers, part, _ = each
            kind, opening = _kind_of(each, style)
            program = programs[kind, opening]
            write_uniform(program, "model_view", part.transform.T @ view.world_to_view)
            set_numbers(program, part_numbers(each), view)
            set_part(program, buffers, style.light, view)
            if opening and part.opening is not None:
                part.opening.set_uniforms(program, view)
            if buffers.kind == "SHELLS":
                buffers.draw_shells(program, view)
                continue
            with blending(self._gl) if buffers.is_mixed else nullcontext():
                buffers.draw(program)

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

    def _use_surfaces(self, view: PlacedView, corners: Floats64) -> bool:
        """Set the drawing area to the hull of corners (n, 3); return False if it is out of view."""
        covered = view.covered_pixels(corners)
        if is_seen := min(covered[2:]) > 0:
            self.surface.target.use(view.viewport, covered, has_numbers=True)
        return is_seen


def _kind_of(placed: PlacedBuffers, style: Style) -> tuple[str, tuple[str, ...]]:
    """Return the kind of a part, and the defines of the opening that lets light in."""
    kind = placed.buffers.kind
    opening = placed.part.opening
    if kind != "RIGID" or opening is None or not style.skin_maps:
        return kind, ()
    return kind, opening.defines


def _groups_with_maps(skin: Skin, style: Style) -> list[tuple[TriangleGroup, dict[BumpMap, float]]]:
    """Return pairs of a share of the triangles, and the maps with which it is drawn.

    Triangles that are coloured by values are drawn together, because values have their order.
    """
    maps = skin.shown_maps(style)
    smooth = {each: strength for each, strength in maps.items() if each is not skin.maps.bumps}
    if len(smooth) == len(maps) or style.colour_by is not ColourBy.NONE:
        return [(TriangleGroup.ALL, maps)]
    return [(TriangleGroup.BUMPED, maps), (TriangleGroup.SMOOTH, smooth)]
