"""The scene in the window: which meshes are drawn where, coloured and overlaid as the user wants.

Uses the paper's Figure 1 part by part (refine, upload, draw) and keeps the time of each.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from risorius import render

from ..capture.captions import SPLITS_BAR, Label, captioned, labels
from ..files import Image
from ..pipeline import DrawnMesh, Pipeline, Viewport
from ..refining.looks import STATIC, Refinement
from ..refining.refiners import open_choices, options_of
from ..scenes import Scene
from .colours import COLOURS, Amounts
from .frame_times import FrameTimes
from .level_of_detail import FULL
from .overlays import LINES, Lines, pointed_lines
from .setting_rules import SKINS, TONES
from .settings import Display
from .view import View

LEAST_SHARE = 0.08  # of the picture that each side of a comparison keeps


class Shot(NamedTuple):
    """One mesh in the picture, and the part of it in which it is seen."""

    drawn: DrawnMesh
    viewport: Viewport
    clip: Viewport


class Stage:
    """Draws a scene into a window's surface."""

    def __init__(
        self, surface: render.WindowSurface, scene: Scene, display: Display, times: FrameTimes
    ) -> None:
        self.surface = surface
        self._times = times
        self._bind_scene(scene, display)

    def _bind_scene(self, scene: Scene, display: Display) -> None:
        self.scene = scene
        self.renderer = render.Renderer(self.surface)
        self._pipeline = Pipeline(scene, self.renderer, [Refinement(refiner=STATIC)])
        self._tone: float | None = None
        self.static = self._pipeline.meshes[0]
        self.refined = self.a = self.b = self.static  # what is chosen, what else is compared
        self.refiner_options: dict[str, Any] = {}  # of `refined`, with their defaults
        self.open_choices: dict[str, dict[str, Any]] = {}  # and what those may be that are open
        self._asked: dict[str, Refinement] = {}  # what each of the three was bound for
        self.bind(display)

    def set_scene(self, scene: Scene, display: Display) -> None:
        """Take another scene in place of this one."""
        for drawn in (self.refined, self.a, self.b):
            if drawn is not self.static:
                drawn.stream.release()
        self._pipeline.release()
        self.renderer.release()
        self._bind_scene(scene, display)

    def bind(self, display: Display) -> None:
        """Bind the refiners that `display` asks for; UserError if one refuses its options."""
        tone = TONES[display.tone]
        if tone != self._tone:
            self._pipeline.set_tone(tone)
            self._tone = tone
        chosen = display.refinement_on(self.scene)
        if self._is_rebound("refined", chosen):
            self.refiner_options = options_of(display.refiner_on(self.scene))
            self.open_choices = open_choices(display.refiner_on(self.scene))
        for side in ("a", "b"):
            asked = display.side_on(self.scene, side)
            is_there = display.compare == "off" or asked == chosen
            self._is_rebound(side, Refinement(refiner=STATIC) if is_there else asked)

    def _is_rebound(self, place: str, asked: Refinement) -> bool:
        """Bind `refined`, `a` or `b` if something else is asked for than before; whether it was."""
        if asked == self._asked.get(place):
            return False
        self._asked[place] = asked  # refused options are refused once, not in every frame
        drawn = self.static
        if asked.refiner != STATIC:
            drawn = DrawnMesh.of(self.scene, self.renderer, asked)
        previous: DrawnMesh = getattr(self, place)
        if previous is not self.static:
            previous.stream.release()
        setattr(self, place, drawn)
        return True

    def shots(self, display: Display, viewport: Viewport) -> list[Shot]:
        """What is drawn where."""
        left, bottom, width, height = viewport
        if display.compare == "off" or width < 2:  # less than a pixel for each
            drawn = self.refined if display.is_refined else self.static
            return [Shot(drawn, viewport, viewport)]
        chosen, both = display.refinement_on(self.scene), (viewport, viewport)
        a, b = (
            Shot(self.refined if display.side_on(self.scene, side) == chosen else own, *both)
            for side, own in (("a", self.a), ("b", self.b))
        )
        if display.compare.endswith("alone"):
            return [a if display.compare == "A alone" else b]
        share = min(max(display.share, LEAST_SHARE), 1.0 - LEAST_SHARE)
        middle = min(max(round(share * width), 1), width - 1)
        first = (left, bottom, middle, height)
        second = (left + middle, bottom, width - middle, height)
        if display.compare == "wipe":
            return [a._replace(clip=first), b._replace(clip=second)]
        return [Shot(a.drawn, first, first), Shot(b.drawn, second, second)]

    def draw(self, view: View, *, is_photo: bool = False) -> None:
        """Draw the scene as finely as the surface's `detail` says; a photo without the mouse's."""
        camera, display, viewport, times = view.camera, view.display, view.viewport, self._times
        shots = self.shots(display, viewport)
        style = style_of(display, view.background)
        with times.timed("refinement"):
            amounts = self._pipeline.amounts(style)
        for shot in shots:
            with times.timed("refinement"):
                shot.drawn.refine(self.scene.positions, camera, shot.viewport)
            with times.timed("upload"):
                shot.drawn.upload(amounts, style.wrinkles)
        with times.timed("draw"):
            self.surface.begin()
            overlays = self._overlays(view, {} if is_photo else view.pointed)
            self._pipeline.solids.follow(display.dissection)
            self.renderer.draw_background(style, viewport)
            for shot in shots:
                values = COLOURS[display.colours].values(self.scene, shot.drawn)
                self._draw_shot(shot, view, style, values)
                for lines in overlays:
                    self.renderer.draw_lines(
                        camera=camera, viewport=shot.viewport, clip=shot.clip, **lines._asdict()
                    )
            self.surface.target.flush()
            self.surface.gl.finish()
        self.surface.labels = self._labels(view, shots, style)

    def _labels(self, view: View, shots: Sequence[Shot], style: render.Style) -> list[Label]:
        """What each side of a comparison is, and what colours stand for."""
        letters = "AB" if len(shots) == 2 else view.display.compare.removeprefix("off")
        texts = [f"{a}   {shot.drawn.caption}" for a, shot in zip(letters, shots, strict=False)]
        places, bar = [shot.clip for shot in shots], COLOURS[view.display.colours].bar
        if bar is SPLITS_BAR and all(shot.drawn is self.static for shot in shots):
            bar = None  # nothing is split there
        return labels(texts, places, bar, style, least=view.letter)

    def _draw_shot(
        self, shot: Shot, view: View, style: render.Style, values: Amounts | None
    ) -> None:
        camera, dissection, stream = view.camera, view.display.dissection, shot.drawn.stream
        where = {"viewport": shot.viewport, "clip": shot.clip}
        skin, solids = self._pipeline.skin_of(shot.drawn, values), self._pipeline.solids
        solids.draw(self.renderer, stream, camera, style, dissection, where=where, skin=skin)
        if not (self.surface.samples or dissection.is_on(self.scene)):
            texture, fade = skin["texture"], skin["fade"]
            self.renderer.draw_outline(stream, camera, style, texture=texture, fade=fade, **where)

    def _overlays(self, view: View, pointed: Mapping[str, float]) -> list[Lines]:
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
        shots = self.shots(view.display, view.viewport)
        return captioned(frame, shown, [(s.clip[0] - left, *s.clip[1:]) for s in shots])


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
        wrinkles=display.wrinkles,
        light=render.LIGHTS[display.light],
        background=background,
    )
