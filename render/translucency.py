"""Blend translucent meshes, and hide parts below them."""

import contextlib
from collections.abc import Iterator
from typing import Any

import moderngl
import numpy as np

from .camera import PlacedView
from .frame import CutPlane, Frame, Skin
from .render_target import intersection

CUT_WIDTH = 0.008  # visible thickness of cut skin, as a fraction of the scene's radius
# Greatest distance that parts may come out of the skin, as a fraction of the scene's radius.
SUNK_DEPTH = 0.08
NO_CUT: CutPlane = 0.0, 0.0, 0.0, -1.0  # no point lies in front of this plane
# Blends colours by their opacity; a transparent background collects premultiplied colours.
_PREMULTIPLYING_BLEND: Any = (
    moderngl.SRC_ALPHA,
    moderngl.ONE_MINUS_SRC_ALPHA,
    moderngl.ONE,
    moderngl.ONE_MINUS_SRC_ALPHA,
)


@contextlib.contextmanager
def blending(gl: moderngl.Context, *, hides: bool = False) -> Iterator[None]:
    """Blend drawings within this context over the picture by their opacity.

    hides: whether these drawings write depths, so that they hide later drawings.
    """
    gl.enable(moderngl.BLEND)
    gl.blend_func = _PREMULTIPLYING_BLEND
    gl.fbo.depth_mask = hides
    try:
        yield
    finally:
        gl.fbo.depth_mask = True
        gl.depth_func = "<="
        gl.disable(moderngl.BLEND)


@contextlib.contextmanager
def changing_depth_alone(gl: moderngl.Context) -> Iterator[None]:
    """Make drawings within this context write depths, but no colours."""
    gl.enable(moderngl.BLEND)
    gl.blend_func = moderngl.ZERO, moderngl.ONE
    try:
        yield
    finally:
        gl.disable(moderngl.BLEND)


def set_translucency(program: moderngl.Program, frame: Frame, view: PlacedView) -> None:
    """Set the opacity of a frame's skin, and the plane behind which the skin is translucent."""
    program["opacity"] = frame.style.opacity
    set_cut(program, view, frame.cut or NO_CUT, CUT_WIDTH)


def set_cut(program: moderngl.Program, view: PlacedView, cut: CutPlane, width: float) -> None:
    """Set the plane that cuts the skin; width: width of the cut, in radii of the scene."""
    program["cut"] = in_view(cut, view)
    if "cut_width" in program:
        program["cut_width"] = width * view.camera.scene_radius


def in_view(plane: CutPlane, view: PlacedView) -> CutPlane:
    """Transform a plane from the world to view space."""
    a, b, c, d = np.linalg.inv(view.world_to_view) @ plane
    return a, b, c, d


def fade_defines(skin: Skin, view: PlacedView) -> tuple[str, ...]:
    """Return the defines for a skin that fades; empty if the fading part is out of view.

    MOUTH is added if the fading part may overlap the mouth on the screen.
    """
    if skin.fading is None or not len(skin.fading):
        return ()
    fading = view.covered_pixels(skin.fading, 0.0)
    if min(fading[2:]) <= 0:
        return ()
    if skin.mouth is None:
        return ("FADED",)
    shared = intersection(fading, view.covered_pixels(skin.mouth))
    return ("FADED", "MOUTH") if min(shared[2:]) > 0 else ("FADED",)
