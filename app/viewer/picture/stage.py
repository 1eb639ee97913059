"""The scene in the window: which meshes are drawn where, coloured and overlaid as the user wants.

Draws by `Pipeline.draw`, as films do, and keeps the time of each part of the paper's Figure 1.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from risorius import render

from ...capture.captions import SPLITS_BAR, Label, captioned, labels
from ...files import Image
from ...pipeline import Pipeline, Viewport
from ...refining.presets import STATIC, Refinement
from ...refining.refiners import open_choices, options_of
from ...scenes import FaceScene, Scene
from ..colours import COLOURS
from ..frame_times import FrameTimes
from ..settings import SKINS, TONES, Display
from .view import View

FULL = render.Detail(samples=4, scale=1.0)
LEAST_SHARE = 0.08  # of the picture that each side of a comparison keeps
POINTED_AT = np.array([1.0, 0.66, 0.10])  # sRGB
MOST_SEEN, LEAST_SEEN = 0.9, 0.2  # opacity of the muscle that does most; share that is seen


class Stage:
    """Draws a scene into a window's surface."""

    def __init__(
        self, surface: render.WindowSurface, scene: Scene, display: Display, times: FrameTimes
    ) -> None:
        self.surface = surface
        self._times = times
        self.set_scene(scene, display)

    def set_scene(self, scene: Scene, display: Display) -> None:
        """Draw this scene from here on."""
        self.scene = scene
        self.pipeline = Pipeline(scene, render.Renderer(self.surface))
        self._tone: float | None = None
        # The mesh as it is, and as the refiner that is chosen has it drawn.
        self.refined = self.static = self.pipeline.bind(Refinement(refiner=STATIC))
        self._asked: Refinement | None = None  # what it was bound for
        self.refiner_options: dict[str, Any] = {}  # of `refined`, with their defaults
        self.open_choices: dict[str, dict[str, Any]] = {}  # and what those may be that are open
        self.bind(display)

    def bind(self, display: Display) -> None:
        """Bind the refiners that `display` asks for; UserError if one refuses its options."""
        tone = TONES[display.tone]
        if tone != self._tone:
            self.pipeline.set_tone(tone)
            self._tone = tone
        chosen = display.refinement_on(self.scene)
        if chosen == self._asked:
            return
        self._asked = chosen  # refused options are refused once, not in every frame
        is_static = chosen.refiner == STATIC
        self.refined = self.static if is_static else self.pipeline.bind(chosen)
        self.refiner_options = options_of(display.refiner_on(self.scene))
        self.open_choices = open_choices(display.refiner_on(self.scene))

    def viewports(self, display: Display, area: render.Rectangle) -> list[Viewport]:
        """What is drawn where in an area of the frame."""
        left, bottom, width, height = area
        if display.compare == "off" or width < 2:  # less than a pixel for each
            return [Viewport(self.refined if display.is_refined else self.static, area)]
        share = min(max(display.share, LEAST_SHARE), 1.0 - LEAST_SHARE)
        middle = min(max(round(share * width), 1), width - 1)
        first = (left, bottom, middle, height)
        second = (left + middle, bottom, width - middle, height)
        if display.compare == "wipe":
            return [Viewport(self.static, area, first), Viewport(self.refined, area, second)]
        return [Viewport(self.static, first), Viewport(self.refined, second)]

    def draw(self, view: View, *, is_photo: bool = False) -> None:
        """Draw the scene as finely as the surface's `detail` says; a photo without the mouse's."""
        display, timed = view.display, self._times.timed
        viewports = self.viewports(display, view.viewport)
        style = style_of(display, view.background)
        with timed("draw"):
            self.surface.begin()
            overlays = [] if is_photo else pointed_lines(self.scene, view.pointed)
        self.pipeline.draw(
            view.camera,
            style,
            viewports,
            anatomy=display.anatomy,
            values=COLOURS[display.colours].of_source,
            overlays=overlays,
            timer=timed,
        )
        with timed("draw"):
            self.surface.target.flush()
            self.surface.gl.finish()
        self.surface.labels = self._labels(view, viewports, style)

    def _labels(
        self, view: View, viewports: Sequence[Viewport], style: render.Style
    ) -> list[Label]:
        """What each side of a comparison is, and what colours stand for."""
        texts = [each.drawn.caption for each in viewports if len(viewports) > 1]
        places, bar = [each.seen for each in viewports], COLOURS[view.display.colours].bar
        if bar is SPLITS_BAR and all(each.drawn is self.static for each in viewports):
            bar = None  # nothing is split there
        return labels(texts, places, bar, style, least=view.letter)

    def draw_image(self, view: View) -> Image:
        """The picture without panels, in full detail, with captions and a colour bar."""
        self.surface.detail = FULL
        self.draw(view, is_photo=True)
        left, bottom, width, height = view.viewport
        top = self.surface.size[1] - bottom - height
        channels = 3 if view.background else 4  # premultiplied
        frame = self.surface.read_scene(channels)[top : top + height, left : left + width]
        shown = [(x - left, y - bottom, image) for x, y, image in self.surface.labels]
        seen = [each.seen for each in self.viewports(view.display, view.viewport)]
        return captioned(frame, shown, [x - left for x, *_ in seen])


def pointed_lines(scene: Scene, shares: Mapping[str, float]) -> list[render.Lines]:
    """The fibres of muscles, for whoever points at a control: the clearer the more each does.

    shares: name -> how far it goes. One without sides stands for both.
    """
    fibres = scene.simulation.fibres() if shares and isinstance(scene, FaceScene) else {}
    seen: dict[str, float] = {}
    for name, share in shares.items():
        for side in (name, f"{name}_left", f"{name}_right"):
            if side in fibres:
                seen[side] = max(share, seen.get(side, 0.0))
    most, drawn = max(seen.values(), default=1.0), []
    for name, share in seen.items():
        if share >= LEAST_SEEN * most:
            opacity, colours = MOST_SEEN * share / most, np.tile(POINTED_AT, (len(fibres[name]), 1))
            drawn.append(render.Lines(fibres[name], colours, 2.5, opacity, opacity))
    return drawn


def style_of(display: Display, background: render.Background | None) -> render.Style:
    """The renderer's style for what the user wants to see."""
    is_textured, albedo = SKINS[display.skin]
    return render.Style(
        shading=render.Shading(display.shading),
        wireframe=display.wireframe,
        colour_by=COLOURS[display.colours].kind,
        textured=is_textured,
        occlusion=display.occlusion,
        albedo=albedo,
        bumps=display.wrinkles,
        light=render.LIGHTS[display.light],
        background=background,
    )
