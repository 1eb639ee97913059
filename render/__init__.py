"""Draw triangle meshes by OpenGL, offscreen or in a window.

The package takes arrays from any source. It needs OpenGL 3.3 core and GLSL 330.

    with render.open_offscreen((1280, 720)) as surface:
        renderer = render.Renderer(surface)
        stream = renderer.lend_stream(vertex_capacity, triangle_capacity, 6)
        ...write stream.vertices and stream.triangles...
        stream.upload(vertex_count, triangle_count)
        camera = render.OrbitCamera.framing(vertices, view="three-quarter")
        view = render.CameraView(camera)
        renderer.draw(render.Frame(view, render.Style(), render.Skin(stream)))
        image = surface.read()

Source: Kähler et al. 2003, Fig. 1, the rendering stage.
"""

from .camera import VIEWS, CameraView, OrbitCamera
from .compositor import Detail
from .errors import GLError
from .frame import NO_MAPS, CutPlane, DrawnPart, Frame, PlacedPart, Skin, SkinMaps
from .geometry_buffer import Geometry
from .light_map import LIGHT_MAPS, LightMap
from .lights import LAMPS, LIGHTS
from .lines import Lines
from .opening import Opening
from .probe import Finding, probe
from .render_target import Rectangle
from .renderer import Renderer
from .shade import Shade
from .stream import GpuStream, Stream
from .style import (
    BLACK,
    CLAY,
    DARK,
    LIGHT,
    SKIN,
    SPLIT_PALETTE,
    WHITE,
    Background,
    Colour,
    ColourBy,
    Light,
    MapBackground,
    Shading,
    Style,
)
from .surface import Image, OffscreenSurface, Surface, open_offscreen
from .texture import BumpMap, SkinTexture
from .window import WindowSurface, open_window

__all__ = [
    "BLACK",
    "CLAY",
    "DARK",
    "LAMPS",
    "LIGHT",
    "LIGHTS",
    "LIGHT_MAPS",
    "NO_MAPS",
    "SKIN",
    "SPLIT_PALETTE",
    "VIEWS",
    "WHITE",
    "Background",
    "BumpMap",
    "CameraView",
    "Colour",
    "ColourBy",
    "CutPlane",
    "Detail",
    "DrawnPart",
    "Finding",
    "Frame",
    "GLError",
    "Geometry",
    "GpuStream",
    "Image",
    "Light",
    "LightMap",
    "Lines",
    "MapBackground",
    "OffscreenSurface",
    "Opening",
    "OrbitCamera",
    "PlacedPart",
    "Rectangle",
    "Renderer",
    "Shade",
    "Shading",
    "Skin",
    "SkinMaps",
    "SkinTexture",
    "Stream",
    "Style",
    "Surface",
    "WindowSurface",
    "open_offscreen",
    "open_window",
    "probe",
]
