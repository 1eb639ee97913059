"""Choose the programs of meshes and parts, and set their uniforms for light and colours."""

from collections.abc import Iterable

import moderngl
import numpy as np

from ..geometry.arrays import Unsigned8
from ..geometry.colour import to_linear
from .camera import PlacedView
from .parts import PartBuffers
from .programs import write_uniform
from .style import SPLIT_PALETTE, ColourBy, Light, Style
from .texture import BumpMap

SKIN_SHARPNESS = 28.0  # exponent of the skin's highlight: a soft sheen, chosen by eye
VALUES_PER_ROW = 1024  # texels per row of the value texture; surface.glsl has the same number
_LINEAR_PALETTE = np.array([to_linear(colour) for colour in SPLIT_PALETTE], np.float32)


def mesh_shader(
    style: Style, has_texture: bool, maps: Iterable[BumpMap], of_skin: Iterable[str]
) -> list[str]:
    """Return file and defines of a mesh's program.

    maps: maps that tilt normals. of_skin: defines for the mouth and the fading of the skin.
    """
    shader = ["surface.glsl", style.shading.name]
    if style.has_wires:
        shader.append("WIREFRAME")
    if style.colour_by is not ColourBy.NONE:
        shader.append(style.colour_by.name)
    if style.has_numbered_triangles:
        shader.append("TRIANGLES")
    if has_texture:
        shader.append("TEXTURED")
    if style.opacity < 1.0:
        shader.append("TRANSLUCENT")
    if style.shadows:
        shader.append("SHADOWS")
    shader += [each.define for each in maps]
    shader += of_skin
    if style.light.around:
        shader.append("AROUND")
    return shader


def part_shader(
    kind: str, opening: tuple[str, ...], has_shadow: bool, is_cut: bool, is_around: bool
) -> list[str]:
    """Return file and defines of the program for parts of a kind (see `PartBuffers`).

    opening: `Opening.defines` of the opening in front of the parts; empty if there is none.
    is_around: whether the ambient light is given by nine coefficients.
    """
    around = ["AROUND"] * is_around
    if kind in ("SHELLS", "LOCKS"):
        return [f"{kind.lower()}.glsl", *around]
    shadows = ["SHADOWS"] * (has_shadow and kind != "STRANDS")
    sunk = ["SUNK"] * (is_cut and kind != "STRANDS")
    return ["surface.glsl", "PIXEL", "COLOURED", kind, *opening, *shadows, *sunk, *around]


def set_mesh(program: moderngl.Program, style: Style, view: PlacedView, line_scale: float) -> None:
    """Set a mesh's uniforms by a style: reflection of light, wireframe, and colours by values.

    line_scale: pixels of the target per unit of line width.
    """
    set_light(program, style.light)
    if "albedo" in program:  # absent where a texture replaces it
        program["albedo"] = tuple(to_linear(style.albedo))
    if "inner_albedo" in program:  # absent where only front faces are drawn
        program["inner_albedo"] = tuple(to_linear(style.inside))
    program["subsurface"] = style.scattering
    program["gloss"] = 0.26 * style.gloss
    program["sharpness"] = SKIN_SHARPNESS
    if style.has_wires:
        program["viewport_size"] = view.viewport[2:]
        program["wire_half_width"] = 0.5 * style.wire_width * line_scale
        program["wire_colour"] = *style.wire_colour, style.wire_opacity * style.wireframe
    if style.colour_by is not ColourBy.NONE:
        write_uniform(program, "split_palette", _LINEAR_PALETTE)


def set_part(program: moderngl.Program, part: PartBuffers, light: Light, view: PlacedView) -> None:
    """Set the uniforms of a part; call `set_light` first.

    Highlights of dull parts are broad and faint, highlights of wet parts small and bright. Enclosed
    parts and fibres get no rim light.
    """
    kind = part.kind
    shine = part.shine
    if kind in ("STRANDS", "LOCKS", "SHELLS"):  # size of a pixel at distance 1
        _, _, width, height = view.viewport
        program["pixel_size"] = 1.0 / view.camera.focal(width / height, height)
    if kind in ("SHELLS", "LOCKS"):
        program["gloss"] = 2.0 * shine
        return
    is_rimless = part.is_enclosed or kind == "FIBRES"
    program["rim_light"] = (0.0, 0.0, 0.0) if is_rimless else light.rim
    program["subsurface"] = 0.3
    program["gloss"] = 0.04 + 0.9 * shine * shine
    # Dark vertex colours mean missing light in dull enclosed parts, and a dark albedo in others.
    program["least_mirrored"] = shine * shine if part.is_enclosed else 1.0
    program["sharpness"] = 20.0 * 40.0**shine
    if kind == "STRANDS":
        program["half_strand"] = part.strand_radius


def set_light(program: moderngl.Program, light: Light) -> None:
    """Set the directions and colours of lights."""
    program["to_key"] = light.to_key
    program["to_fill"] = light.to_fill
    program["key_light"] = light.key
    program["fill_light"] = light.fill
    program["rim_light"] = light.rim
    if light.around:
        write_uniform(program, "around", np.array(light.around))
    else:
        program["sky"] = light.sky
        program["ground"] = light.ground


def value_texture(
    gl: moderngl.Context, values: Unsigned8 | None, triangle_count: int
) -> moderngl.Texture:
    """Return a texture with one byte per triangle, which gl_PrimitiveID indexes.

    values: (M,), with M = `triangle_count`; None or another length raises ValueError.
    """
    if values is None:
        raise ValueError("the style colours by values, so the skin needs values, one per triangle")
    rows = np.zeros((max(-(-triangle_count // VALUES_PER_ROW), 1), VALUES_PER_ROW), np.uint8)
    rows.reshape(-1)[:triangle_count] = values
    return gl.texture((VALUES_PER_ROW, len(rows)), 1, rows.tobytes(), dtype="u1", alignment=1)
