"""The scene in the window: camera, viewports, colours, overlays, and the times of drawing.

`Pipeline.draw` draws it, as for films; each part of the paper's Figure 1 is timed. The scene is
drawn only after a change. A scene at rest, a screenshot and a film always have full detail.
During motion, slow frames reduce the detail at once to the level that is expected to be fast
enough. After fast frames, the detail rises by one level when a new motion begins, or after a second
or two. The limits for slow and fast frames are more than one level apart, so the detail does not
oscillate.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from types import MappingProxyType

from imgui_bundle import imgui

from risorius import render

from ...capture.captions import Label, captioned, labels
from ...capture.drawing import camera_for_whole_scene, check_camera
from ...light_maps import SceneLight, scene_light
from ...pictures import Image
from ...pipeline import Pipeline, Viewport
from ...refining.plug_ins import PlugInError
from ...refining.presets import STATIC_REFINER, Refinement
from ...scenes import Drawable
from ..interface.gui import THEMES, em
from ..messages import Messages
from ..session.physics import CALM_SECONDS, FrameTimes
from ..session.session import Session
from ..settings import BACKGROUND_CHOICES, SKIN_CHOICES, TONE_ANGLES, Display, Settings
from .highlights import highlights
from .skin import HoveredMuscle


class SceneView:
    """One view of a session's scene.

    area: the scene's part of the window: left, top, width, height [window units].
    pointed: the muscles of the control under the mouse, with their weights.
    hovered: the muscle of the skin under the mouse; None beside the skin.
    """

    camera: render.OrbitCamera
    area: tuple[float, float, float, float] = (0.0, 0.0, 1.0, 1.0)
    pointed: Mapping[str, float] = MappingProxyType({})
    hovered: HoveredMuscle | None = None

    def __init__(self, session: Session, settings: Settings, surface: render.WindowSurface) -> None:
        self._session = session
        self._settings = settings
        self._surface = surface
        self.fit_scene()

    def fit_scene(self) -> None:
        """Frame the whole scene from the script's view; raises UserError for an unknown view."""
        script = self._session.script
        check_camera(script.camera, script.source)
        self.camera = camera_for_whole_scene(self._session.scene, script.camera)

    def look_from(self, label: str) -> None:
        """Turn the camera to one of `render.VIEWS`, about its target."""
        self.camera.yaw, self.camera.pitch = render.VIEWS[label.lower().replace(" ", "-")]

    @property
    def display(self) -> Display:
        """The display settings of the scene."""
        return self._settings.display

    @property
    def light(self) -> SceneLight:
        """The light of the scene."""
        return scene_light(self.display.light)

    @property
    def background(self) -> render.Background | render.MapBackground:
        """The background of the picture."""
        wanted = self.display.background
        behind = self.light.behind if wanted == "map" else BACKGROUND_CHOICES[wanted]
        return behind or THEMES[self._settings.theme].background

    @property
    def viewport(self) -> render.Rectangle:
        """The part of the framebuffer that shows the scene."""
        return self.pixels(self.area)

    def pixels(self, area: tuple[float, float, float, float]) -> render.Rectangle:
        """Convert a part of the window to pixels of the framebuffer."""
        display = imgui.get_io().display_size
        width, height = self._surface.frame_size  # size of the next picture
        across = width / max(display.x, 1.0)
        along = height / max(display.y, 1.0)
        left, top, wide, high = area
        x = round(left * across)
        y = round((display.y - top - high) * along)
        return max(x, 0), max(y, 0), max(round(wide * across), 1), max(round(high * along), 1)

    @property
    def letter_size(self) -> float:
        """Size of letters in the window [pixels]; captions have at least this size."""
        return self.pixels((0.0, 0.0, em(), 1.0))[2]

    @property
    def state(self) -> object:
        """All that the picture depends on, except the motion of the scene."""
        display = repr(asdict(self.display))
        camera = self.camera
        lens = camera.field_of_view
        place = camera.yaw, camera.pitch, camera.distance, lens, *camera.target.tolist()
        lit = self.pointed, self.hovered
        return place, display, self.light, self._settings.theme, self.viewport, lit

    def divider(self) -> list[tuple[render.Rectangle, render.Colour]]:
        """Return the line between the halves of a comparison, and the knob of a wipe."""
        if self.display.compare == "off":
            return []
        left, bottom, width, height = self.viewport
        unit = max(round(em(0.13) * width / max(self.area[2], 1.0)), 2)
        x = left + round(self.display.share * width)
        y = bottom + height // 2
        line = (x - unit // 2, bottom, unit, height)
        grip = (x - unit // 2 - unit, y - 10 * unit, 3 * unit, 20 * unit)
        white = (1.0, 1.0, 1.0)
        rules = [(line, white), (grip, THEMES[self._settings.theme].accent)]
        return rules if self.display.compare == "wipe" else rules[:1]


FULL_DETAIL = render.Detail(samples=4, scale=1.0)


class Stage:
    """Draws a scene into a window's surface."""

    def __init__(
        self, surface: render.WindowSurface, scene: Drawable, display: Display, times: FrameTimes
    ) -> None:
        self.surface = surface
        self._times = times
        self.set_scene(scene, display)

    def set_scene(self, scene: Drawable, display: Display) -> None:
        """Draw this scene from now on."""
        self.scene = scene
        self.pipeline = Pipeline(scene, render.Renderer(self.surface))
        self._tone: float | None = None
        # The unrefined mesh, and the mesh of the chosen refiner.
        self.refined = self.static = self.pipeline.bind(Refinement(refiner=STATIC_REFINER))
        self.beside = self.static  # at the left of a comparison
        self._asked: Refinement | None = None  # the bound refinement
        self._asked_beside = Refinement(refiner=STATIC_REFINER)
        self.bind(display)

    def bind(self, display: Display) -> None:
        """Bind the refiners of `display`; raises UserError if a refiner refuses its options."""
        tone = TONE_ANGLES[display.tone]
        if tone != self._tone:
            self.pipeline.set_tone(tone)
            self._tone = tone
        beside = display.refinement_beside
        if beside != self._asked_beside:
            self._asked_beside = beside
            is_static = beside.refiner == STATIC_REFINER
            self.beside = self.static if is_static else self.pipeline.bind(beside)
        chosen = display.refinement_on(self.scene)
        if chosen == self._asked:
            return
        self._asked = chosen  # so wrong options give one error, not one in every frame
        is_static = chosen.refiner == STATIC_REFINER
        self.refined = self.static if is_static else self.pipeline.bind(chosen)

    def give_up_refinement(self) -> None:
        """Draw the unrefined mesh until another refinement is requested."""
        self.refined = self.static

    def viewports(self, display: Display, area: render.Rectangle) -> list[Viewport]:
        """Return the viewports in an area of the frame: one, or two for a comparison."""
        left, bottom, width, height = area
        if display.compare == "off" or width < 2:  # a side would have less than a pixel
            return [Viewport(self.refined if display.is_refined else self.static, area)]
        least_fraction = 0.08  # smallest share of the picture for each side
        share = min(max(display.share, least_fraction), 1.0 - least_fraction)
        middle = min(max(round(share * width), 1), width - 1)
        first = (left, bottom, middle, height)
        second = (left + middle, bottom, width - middle, height)
        if display.compare == "wipe":
            return [Viewport(self.beside, area, first), Viewport(self.refined, area, second)]
        return [Viewport(self.beside, first), Viewport(self.refined, second)]

    def draw(self, view: SceneView, *, is_photo: bool = False) -> None:
        """Draw the scene with the surface's `detail`; a photo omits muscles under the mouse."""
        display = view.display
        timed = self._times.timed
        viewports = self.viewports(display, view.viewport)
        style = style_of(display, view.background)
        overlays = [] if is_photo else highlights(self.scene, view.pointed, view.hovered)
        self.pipeline.draw(
            view.camera, style, viewports, anatomy=display.anatomy, overlays=overlays, timer=timed
        )
        with timed("draw"):
            self.surface.gl.finish()
        self.surface.labels = self._labels(view, viewports, style)

    def _labels(
        self, view: SceneView, viewports: Sequence[Viewport], style: render.Style
    ) -> list[Label]:
        """Return a label for each side of a comparison, and the key of colours."""
        texts = [each.drawn.caption for each in viewports if len(viewports) > 1]
        places = [each.seen for each in viewports]
        has_splits = any(each.drawn is not self.static for each in viewports)
        has_bar = view.display.splits and has_splits
        return labels(texts, places, has_bar=has_bar, least=view.letter_size)

    def draw_image(self, view: SceneView) -> Image:
        """Return the picture without panels, in full detail, with captions and a colour bar."""
        self.surface.detail = FULL_DETAIL
        self.draw(view, is_photo=True)
        left, bottom, width, height = view.viewport
        top = self.surface.size[1] - bottom - height
        channels = 3 if view.background else 4  # colours are premultiplied by alpha
        frame = self.surface.read_scene(channels)[top : top + height, left : left + width]
        shown = [(x - left, y - bottom, image) for x, y, image in self.surface.labels]
        seen = [each.seen for each in self.viewports(view.display, view.viewport)]
        return captioned(frame, shown, [x - left for x, *_ in seen])


def style_of(
    display: Display, background: render.Background | render.MapBackground | None
) -> render.Style:
    """Return the renderer's style for the user's display settings."""
    is_textured, albedo = SKIN_CHOICES[display.skin]
    return render.Style(
        shading=render.Shading(display.shading),
        wireframe=display.wireframe,
        colour_by=render.ColourBy.from_switches(splits=display.splits, wires=display.wires),
        textured=is_textured,
        skin_maps=display.skin_maps,
        albedo=albedo,
        bumps=display.wrinkles,
        light=scene_light(display.light).light,
        background=background,
    )


# After full detail: one sample with smoothed edges (edges.glsl), then smaller, blurred pictures.
# Two samples would not be faster, because software OpenGL then draws four. With four samples at
# scale 0.75, a frame takes 0.8 of the first level's time.
DETAIL_LEVELS = (
    FULL_DETAIL,
    render.Detail(samples=0, scale=1.0),
    render.Detail(samples=0, scale=0.75),
    render.Detail(samples=0, scale=0.6),
    render.Detail(samples=0, scale=0.5),
)
# Processor time of a whole frame at 1280 x 720, relative to the first level (measured 2026-11-29).
LEVEL_COSTS = 1.0, 0.8, 0.7, 0.61, 0.54
COARSEST_IDLE_LEVEL = 2  # chosen by eye: with fewer pixels, outlines of a face at rest have steps
PATIENCE_FRAMES = 4  # slow frames in a row that reduce the detail
CALM_FRAMES = 40  # fast frames in a row after which a moving picture becomes finer


class LevelOfDetail:
    """Picks a level of detail by the time that frames took."""

    FIRST_SOFTWARE_LEVEL = 1  # avoids stutter in the first second

    def __init__(self, *, is_software: bool) -> None:
        self.level = self.FIRST_SOFTWARE_LEVEL if is_software else 0
        self._slow: list[float] = []  # times of the last frames [s], all too slow
        self._fast = 0

    @property
    def detail(self) -> render.Detail:
        """The detail for a scene that moves."""
        return DETAIL_LEVELS[self.level]

    @property
    def unhurried(self) -> render.Detail:
        """The detail for idle life, whose slow motion makes missing pixels more visible."""
        return DETAIL_LEVELS[min(self.level, COARSEST_IDLE_LEVEL)]

    def begin_motion(self) -> None:
        """Note that a motion begins, when nobody notices a rise of the detail."""
        if self._fast >= PATIENCE_FRAMES:
            self._rise()
        self._forget()

    def note(self, seconds: float) -> None:
        """Note the whole time of a frame of a moving scene [s]."""
        slow_seconds = 0.045  # [s] for a frame; more than 20 frames a second are promised
        ample_seconds = 0.03  # [s] for a frame: the next finer level is then fast enough
        self._slow = [*self._slow, seconds] if seconds > slow_seconds else []
        self._fast = self._fast + 1 if seconds < ample_seconds else 0
        if len(self._slow) >= PATIENCE_FRAMES:
            allowed = LEVEL_COSTS[self.level] * slow_seconds / min(self._slow)
            coarser = range(self.level + 1, len(DETAIL_LEVELS))
            fitting = (each for each in coarser if LEVEL_COSTS[each] <= allowed)
            self.level = next(fitting, len(DETAIL_LEVELS) - 1)
            self._forget()
        elif self._fast >= CALM_FRAMES:
            self._rise()
            self._forget()

    def _rise(self) -> None:
        """Raise the detail by one level."""
        self.level = max(self.level - 1, 0)

    def _forget(self) -> None:
        """Forget the times of earlier frames, which had another level or motion."""
        self._slow = []
        self._fast = 0


class Painter:
    """Keeps the picture of the scene up to date, as finely as the machine can."""

    def __init__(self, stage: Stage, view: SceneView, messages: Messages) -> None:
        self._stage = stage
        self._view = view
        self._messages = messages
        self.level_of_detail = LevelOfDetail(is_software=stage.surface.is_software)
        self._calm_for = 0.0  # [s] without a change of the picture
        self.forget()

    def forget(self) -> None:
        """Note that the last picture is out of date."""
        self._painted: tuple[object, render.Detail] = (None, FULL_DETAIL)

    @property
    def is_complete(self) -> bool:
        """Whether the picture shows the current view, in full detail."""
        return self._painted == (self._view.state, FULL_DETAIL)

    def paint(self, elapsed: float, *, has_moved: bool, is_alive: bool) -> bool:
        """Draw the scene if it has changed or lacks full detail; return whether it has changed.

        elapsed: time since the last frame [s]. has_moved: whether the scene has moved visibly.
        is_alive: whether the face only has idle life: it moves again soon, and full detail in
        between would flicker.
        """
        surface = self._stage.surface
        surface.area = self._view.viewport
        surface.rules = self._view.divider()
        state = self._view.state
        painted, detail = self._painted
        has_changed = state != painted or has_moved or surface.frame_size != surface.size
        if has_changed and self._calm_for > CALM_SECONDS:
            self.level_of_detail.begin_motion()
        self._calm_for = 0.0 if has_changed else self._calm_for + elapsed
        if has_changed:
            level = self.level_of_detail
            is_unhurried = is_alive and state == painted
            self._draw(level.unhurried if is_unhurried else level.detail, state)
        elif detail != FULL_DETAIL and self._calm_for > CALM_SECONDS and not is_alive:
            self._draw(FULL_DETAIL, state)
        return has_changed

    def _draw(self, detail: render.Detail, state: object) -> None:
        self._messages.attempt(lambda: self._stage.bind(self._view.display))
        self._stage.surface.detail = detail
        self._stage.surface.labels = ()
        try:
            self._stage.draw(self._view)
        except PlugInError as error:  # work goes on, with the unrefined mesh
            self._messages.show(str(error), error=True)
            self._stage.give_up_refinement()
            self._stage.draw(self._view)
        self._painted = state, detail
