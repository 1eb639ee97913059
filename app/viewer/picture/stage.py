"""The scene in the window: which meshes are drawn where, coloured and overlaid as the user wants.

Draws by `Pipeline.draw`, as films do, and keeps the time of each part of the paper's Figure 1.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from risorius import render

from ...capture.captions import SPLITS_BAR, Label, captioned, labels
from ...files import Image
from ...pipeline import DrawnMesh, Pipeline, Viewport
from ...refining.presets import STATIC, Refinement
from ...refining.refiners import open_choices, options_of
from ...scenes import Scene
from ..colours import COLOURS
from ..frame_times import FrameTimes
from ..overlays import LINES, pointed_lines
from ..setting_rules import SKINS, TONES
from ..settings import Display
from .painter import FULL
from .view import View

LEAST_SHARE = 0.08  # of the picture that each side of a comparison keeps


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
        self.static = self.pipeline.bind(Refinement(refiner=STATIC))
        # By name: what is chosen, what else is compared; and what each was bound for.
        self._bound = dict.fromkeys(("refined", "a", "b"), self.static)
        self._asked: dict[str, Refinement] = {}
        self.refiner_options: dict[str, Any] = {}  # of `refined`, with their defaults
        self.open_choices: dict[str, dict[str, Any]] = {}  # and what those may be that are open
        self.bind(display)

    @property
    def refined(self) -> DrawnMesh:
        """The mesh as the refiner that is chosen has it drawn."""
        return self._bound["refined"]

    def bind(self, display: Display) -> None:
        """Bind the refiners that `display` asks for; UserError if one refuses its options."""
        tone = TONES[display.tone]
        if tone != self._tone:
            self.pipeline.set_tone(tone)
            self._tone = tone
        chosen = display.refinement_on(self.scene)
        if self._is_rebound("refined", chosen):
            self.refiner_options = options_of(display.refiner_on(self.scene))
            self.open_choices = open_choices(display.refiner_on(self.scene))
        for side in ("a", "b"):
            asked = display.side_on(self.scene, side)
            is_there = display.compare == "off" or asked == chosen
            self._is_rebound(side, Refinement(refiner=STATIC) if is_there else asked)

    def _is_rebound(self, name: str, asked: Refinement) -> bool:
        """Bind `refined`, `a` or `b` if something else is asked for than before; whether it was."""
        if asked == self._asked.get(name):
            return False
        self._asked[name] = asked  # refused options are refused once, not in every frame
        is_static = asked.refiner == STATIC
        self._bound[name] = self.static if is_static else self.pipeline.bind(asked)
        return True

    def viewports(self, display: Display, area: render.Rectangle) -> list[Viewport]:
        """What is drawn where in an area of the frame."""
        left, bottom, width, height = area
        if display.compare == "off" or width < 2:  # less than a pixel for each
            return [Viewport(self.refined if display.is_refined else self.static, area)]
        chosen = display.refinement_on(self.scene)
        a, b = (
            self.refined if display.side_on(self.scene, side) == chosen else self._bound[side]
            for side in ("a", "b")
        )
        if display.compare.endswith("alone"):
            return [Viewport(a if display.compare == "A alone" else b, area)]
        share = min(max(display.share, LEAST_SHARE), 1.0 - LEAST_SHARE)
        middle = min(max(round(share * width), 1), width - 1)
        first = (left, bottom, middle, height)
        second = (left + middle, bottom, width - middle, height)
        if display.compare == "wipe":
            return [Viewport(a, area, first), Viewport(b, area, second)]
        return [Viewport(a, first), Viewport(b, second)]

    def draw(self, view: View, *, is_photo: bool = False) -> None:
        """Draw the scene as finely as the surface's `detail` says; a photo without the mouse's."""
        display, timed = view.display, self._times.timed
        viewports = self.viewports(display, view.viewport)
        style = style_of(display, view.background)
        with timed("draw"):
            self.surface.begin()
            overlays = self._overlays(view, {} if is_photo else view.pointed)
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
        letters = "AB" if len(viewports) == 2 else view.display.compare.removeprefix("off")
        texts = [f"{a}   {each.drawn.caption}" for a, each in zip(letters, viewports, strict=False)]
        places, bar = [each.seen for each in viewports], COLOURS[view.display.colours].bar
        if bar is SPLITS_BAR and all(each.drawn is self.static for each in viewports):
            bar = None  # nothing is split there
        return labels(texts, places, bar, style, least=view.letter)

    def _overlays(self, view: View, pointed: Mapping[str, float]) -> list[render.Lines]:
        edges, names = self.static.refiner.edges, view.display.overlays
        lines = [LINES[name](self.scene, edges, view.camera) for name in names if name in LINES]
        return [*lines, *pointed_lines(self.scene, pointed)] if pointed else lines

    def draw_image(self, view: View, *, has_captions: bool = True) -> Image:
        """The picture without panels, in full detail, with captions and a colour bar."""
        self.surface.detail = FULL
        self.draw(view, is_photo=True)
        left, bottom, width, height = view.viewport
        top = self.surface.size[1] - bottom - height
        channels = 3 if view.background else 4  # premultiplied
        frame = self.surface.read_scene(channels)[top : top + height, left : left + width]
        labels = self.surface.labels if has_captions else ()
        shown = [(x - left, y - bottom, image) for x, y, image in labels]
        seen = [each.seen for each in self.viewports(view.display, view.viewport)]
        return captioned(frame, shown, [x - left for x, *_ in seen])


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
