"""The window: one turn of the loop, and what menus and panels ask for.

Physics goes in steps of its own, apart from frames (clock.py). The scene is drawn only when
something in it has changed, with less detail while it moves if the machine is slow (quality.py);
panels are drawn around it less often then (kept.py). A window in which nothing happens waits for
events.
"""

from __future__ import annotations

import contextlib
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict
from pathlib import Path

import numpy as np
from imgui_bundle import imgui

from risorius import refine, render, sim
from risorius.assets.fitting import FittedHead

from ..cameras import whole_scene
from ..errors import UserError
from ..pipeline import Viewport
from ..scenes import Scene, build_scene
from ..script import Script
from ..stopping import cleaned_up_if_stopped
from . import commands
from .actions import actions_of, run_pressed
from .clock import STEP, Clock
from .dropped import Dropped, open_dropped
from .files import Files
from .gui import THEMES, Gui, em, on_drop, poll_events, wait_for_event
from .kept import KeptPanels
from .overlays import overlays_of
from .panels import layout
from .panels.chrome import Messages, Question, draw_help
from .panels.face import FacePanel
from .panels.mechanism import MechanismPanel
from .panels.offer import draw_offer
from .panels.timeline import Timeline
from .placement import Placement, first_size
from .quality import FULL, Quality
from .recovery import Recovery
from .session import Session
from .settings import Look, Settings, drop_refused_options, load_settings
from .stage import SceneView, Stage, checked
from .take import FRAMES_PER_SECOND, Film
from .touch import Touch

STILL = 2e-4  # [mm] if no vertex moves further in a step, the face is at rest
CALM = 0.15  # [s] without change before physics rests and the scene is drawn in full
IDLE_WAIT = 2.0  # [s] between two frames while nothing happens
WATCHFUL_WAIT = 0.1  # [s] the same while a file dialog is open, or words are typed
FRAMES_AFTER_EVENT = 3  # the GUI answers an event within so many frames
WHITE = (1.0, 1.0, 1.0)
SMOOTHING = 0.9  # of the shown frame rate, from frame to frame


class Viewer:
    """The window with everything in it; a context manager."""

    session: Session
    look: Look
    settings: Settings
    is_help_open: bool
    is_bare: bool  # without panels
    placement: Placement
    film: Film | None

    def __init__(
        self,
        script: Script,
        size: tuple[int, int] | None = None,
        look: Look | None = None,
        *,
        head: FittedHead | None = None,
        settings_path: Path | None = None,
    ) -> None:
        """Open the window.

        head: one that somebody brought, None for the built-in one. size, look: None takes what was
        remembered. settings_path: where that is kept, and beside it what is not saved; None for
        nowhere. Raises UserError for a script that names what the scene has not.
        """
        self.settings_path = settings_path
        self.settings, complaint = Settings(), ""
        if settings_path is not None:
            self.settings, complaint = load_settings(settings_path)
        self.scene = build_scene(script.scene, head)
        self.session = Session(self.scene, script)
        self.recovery = Recovery(settings_path and settings_path.parent / "unsaved")
        self.recovery.look(self.session)
        known = overlays_of(self.scene)
        self.look = checked(look or self.settings.look, refine.available(), known)
        if look is None:
            refused = drop_refused_options(self.look, self.scene)
            complaint = "; ".join(filter(None, (complaint, refused)))
        with contextlib.ExitStack() as stack:  # whatever fails here closes the window again
            title = f"Risorius: {self.session.name}"
            self.surface = render.open_window(size or first_size(self.settings.size), title)
            stack.callback(self.surface.close)
            self.gui = Gui(self.surface.handle)
            stack.callback(self.gui.close)
            self.stage = Stage(self.surface, self.scene, self.look)
            self._resources = stack.pop_all()
        self.camera = commands.remembered_camera(self) or whole_scene(self.scene, script.camera)
        self.placement = Placement(self.surface.handle)
        self.quality = Quality(is_software=self.surface.is_software)
        self.touch = Touch(self)
        self.kept = KeptPanels()
        self.files, self.messages, self.question = Files(), Messages(), Question()
        self.face_panel, self.mechanism_panel = FacePanel(self), MechanismPanel(self)
        self.timeline = Timeline(self)
        self.actions = actions_of(self)
        self.film: Film | None = None
        self.is_help_open = self.is_leaving = self.is_bare = False
        self.frames_per_second = 0.0
        self.picture_area = (0.0, 0.0, 1.0, 1.0)  # left, top, width, height [window units]
        self._clock = Clock()
        self.generator = np.random.default_rng()
        self.wanted_tab = self.settings.tab
        self._last = time.perf_counter()
        self._drawn: tuple[object, render.Detail] = (None, FULL)  # what the scene's pixels show
        self._posed: dict[str, float] = {}  # the values at the last step of physics
        self._has_stepped = False
        self._to_fit: Dropped | None = None  # a head, in the next frame
        self._still_for = 0.0  # [s] that no vertex has moved
        self._calm_for = 0.0  # [s] that the picture has not changed
        self._awake = FRAMES_AFTER_EVENT
        on_drop(self.surface.handle, self.drop)
        if complaint:
            self.messages.say(complaint, error=True)
        for _ in range(2):  # panels and tabs find their places before the first picture
            self._draw_gui(is_seen=False)

    def __enter__(self) -> Viewer:
        return self

    def __exit__(self, *_: object) -> None:
        with contextlib.suppress(UserError):  # a disk that is full must not keep the window open
            commands.remember(self)
        if self.film is not None:
            self.film.close()
        self.recovery.close()
        self._resources.close()

    def run(self, *, playing: bool = False, once: bool = False) -> None:
        """Show the window until it is closed (with `once`: until the script has ended)."""
        if playing:
            self.session.toggle_playing()
        self._last = time.perf_counter()
        remembered = cleaned_up_if_stopped(lambda: commands.remember(self))
        with self.recovery.guarding(self.session), remembered:
            while True:
                if self.placement.is_minimised:  # time stands still, and nothing is drawn
                    self._wait()
                else:
                    self.frame()
                self.attempt(lambda: self.recovery.watch(self.session))
                if self.surface.should_close:
                    self.surface.should_close = False
                    commands.close_politely(self)
                    if self.surface.should_close:
                        break
                    self.placement.bring_back()  # to be asked
                is_over = playing and not self.session.is_playing
                if once and is_over and not self.session.unsaved:
                    break
                if self.is_idle:
                    self._wait()

    def rest(self) -> None:
        """Wait until something happens, or it is time to look around; then show a frame."""
        self._wait()
        self.frame()

    # One turn of the loop

    def frame(self) -> None:
        """Input, time, picture, panels."""
        poll_events()
        if self.gui.has_events:
            self._awake = FRAMES_AFTER_EVENT
        now = time.perf_counter()
        elapsed, self._last = now - self._last, now
        if elapsed > 0.0:
            # The mean of times, not of rates: a few quick frames must not outweigh the slow ones.
            shown = 1.0 / self.frames_per_second if self.frames_per_second else elapsed
            self.frames_per_second = 1.0 / (SMOOTHING * shown + (1.0 - SMOOTHING) * elapsed)
        mark = " *" if self.session.unsaved else ""
        self.placement.call(f"Risorius: {self.session.name}{mark}")
        self._let_time_pass(elapsed if self.film is None else 1.0 / FRAMES_PER_SECOND)
        is_moving = self._draw_scene(elapsed)
        self._show_panels(elapsed, is_moving=is_moving)
        self.surface.end()
        self._fit_dropped()
        if is_moving:
            self.quality.note(time.perf_counter() - now)
        if self.film is not None:  # on a fast machine a film is made in real time
            time.sleep(max(1.0 / FRAMES_PER_SECOND - (time.perf_counter() - now), 0.0))
        self._awake = max(self._awake - 1, 0)

    def _draw_gui(self, *, is_seen: bool) -> None:
        """Panels, and what the user does to them and to the face; is_seen: see Gui.frame."""
        with self.gui.frame(is_seen=is_seen):
            self.gui.dress(self.settings.theme, self.settings.zoom)
            self._draw_panels(imgui.get_io().delta_time)
            if not self._is_asking:
                run_pressed(self, self.actions)
                self.touch.follow()

    @property
    def is_idle(self) -> bool:
        """Whether nothing moves, and nothing is about to."""
        return (
            self._still_for > CALM
            and self._awake == 0
            and self._drawn == (self._shown(), FULL)
            and not self.session.is_recording
            and not self.messages.is_fading
            and self.film is None
        )

    def _wait(self) -> None:
        """Sleep until an event comes, or for a while; the clock does not run on meanwhile."""
        is_watching = self.files.is_waiting or imgui.get_io().want_text_input  # a cursor blinks
        patience = WATCHFUL_WAIT if is_watching else IDLE_WAIT
        patience = min(patience, max(self.recovery.due_in(), 0.0))
        begin = time.perf_counter()
        wait_for_event(patience)
        self._last = time.perf_counter()
        if self._last - begin < patience:
            self._awake = FRAMES_AFTER_EVENT

    def _let_time_pass(self, seconds: float) -> None:
        """As many steps of physics as are due; none for a face at rest that nobody moves."""
        steps = self._clock.steps(seconds)
        session, scene = self.session, self.scene
        wanted = dict(session.values)
        is_driven = session.is_playing or session.is_recording or self.touch.is_pulling
        is_driven = is_driven or wanted != self._posed
        self._has_stepped = steps > 0 and (is_driven or self._still_for <= CALM)
        if not self._has_stepped:
            return
        self._posed = wanted
        self.stage.next_frame()
        before = scene.positions
        with self.stage.timed("simulation"):
            try:
                for _ in range(steps):
                    before = scene.positions.copy()
                    session.advance(STEP)
            except sim.SimulationUnstable as error:
                session.neutral()
                scene.reset()
                self.messages.say(str(error), error=True)
        moved = float(np.abs(scene.positions - before).max(initial=0.0))
        # Muscles follow late: what has not moved yet may still be about to.
        self._still_for = 0.0 if is_driven or moved > STILL else self._still_for + steps * STEP

    def _shown(self) -> object:
        """Everything that the picture depends on, but for the motion of the scene."""
        camera = self.camera
        place = (camera.yaw, camera.pitch, camera.distance, *camera.target.tolist())
        look = repr(asdict(self.look))
        return place, look, self.settings.theme, self.viewport, self.face_panel.pointed

    def _draw_scene(self, elapsed: float) -> bool:
        """Draw the scene if it has changed, or is not drawn in full yet; whether it changed."""
        self.surface.area = self.viewport
        self.surface.rules = self._divider()
        shown = self._shown()
        drawn, detail = self._drawn
        has_changed = shown != drawn or self._has_stepped or self.surface.is_resized
        if has_changed and self._calm_for > CALM:
            self.quality.begin_motion()
        self._calm_for = 0.0 if has_changed else self._calm_for + elapsed
        if has_changed or self.film is not None:
            self._paint(self.quality.detail, shown)
        elif detail != FULL and self._calm_for > CALM:
            self._paint(FULL, shown)
        return has_changed

    def _paint(self, detail: render.Detail, shown: object) -> None:
        self.attempt(lambda: self.stage.adopt(self.look))
        if self.film is None:
            self.surface.detail = detail
            self.stage.draw(*self.scene_view)
        else:
            detail, film = FULL, self.film
            frame = self.stage.photograph(*self.scene_view)
            self.attempt(lambda: film.add(frame), otherwise=lambda: commands.toggle_film(self))
        self._drawn = shown, detail

    def _divider(self) -> list[tuple[Viewport, render.Colour]]:
        """The line between the two halves of a comparison, and what to drag it by."""
        if self.look.compare == "off":
            return []
        left, bottom, width, height = self.viewport
        unit = max(round(em(0.13) * width / max(self.picture_area[2], 1.0)), 2)
        x, y = left + round(self.look.divider * width), bottom + height // 2
        line = (x - unit // 2, bottom, unit, height)
        grip = (x - unit // 2 - unit, y - 10 * unit, 3 * unit, 20 * unit)
        return [(line, WHITE), (grip, self.gui.theme.accent)]

    @property
    def scene_view(self) -> SceneView:
        """What the stage draws: camera, look, background, viewport, muscles pointed at."""
        background = THEMES[self.settings.theme].background
        return self.camera, self.look, background, self.viewport, self.face_panel.pointed

    @property
    def viewport(self) -> Viewport:
        """The picture's part of the framebuffer."""
        display = imgui.get_io().display_size
        width, height = self.surface.size
        across, along = width / max(display.x, 1.0), height / max(display.y, 1.0)
        left, top, wide, high = self.picture_area
        x, y = round(left * across), round((display.y - top - high) * along)
        return max(x, 0), max(y, 0), max(round(wide * across), 1), max(round(high * along), 1)

    def _show_panels(self, elapsed: float, *, is_moving: bool) -> None:
        """Answer the user, and draw the panels around the scene where their picture is not kept."""
        size, is_answering = self.surface.size, self._awake > 0 or imgui.is_any_item_active()
        self.kept.age(elapsed)
        # What is dragged in the scene moves no slider.
        is_touched = is_answering and not self.touch.is_dragging
        is_seen = self.kept.are_due(size, is_moving=is_moving, is_touched=is_touched)
        if not (is_seen or is_answering):
            return
        if is_seen:
            self.surface.resolve()
            left, bottom, width, _ = self.viewport
            if not self.is_bare:
                self.surface.fill((0, 0, left, size[1]), self.gui.theme.panel)
                self.surface.fill((left, 0, width, bottom), self.gui.theme.panel)
        self._draw_gui(is_seen=is_seen)
        if is_seen:
            self.kept.note_drawn(size, is_over_scene=self.gui.covers(self.picture_area))

    def _draw_panels(self, elapsed: float) -> None:
        layout.draw(self)
        self.messages.draw(self, elapsed)
        draw_offer(self)
        self.attempt(lambda: self.files.draw(self.gui))
        self.attempt(lambda: self.question.draw(self))
        if self.is_help_open:
            self.is_help_open = draw_help(self, self.actions)

    # What actions and panels share

    def attempt(
        self, run: Callable[[], None], otherwise: Callable[[], None] = lambda: None
    ) -> None:
        """Do something that the user may have to mend: the error is shown, the window lives on."""
        try:
            run()
        except (UserError, OSError) as error:
            self.messages.say(str(error), error=True)
            otherwise()

    def drop(self, paths: Sequence[str]) -> None:
        """Open files that were dropped onto the window."""
        self._awake = FRAMES_AFTER_EVENT
        dropped = Dropped.of([Path(path) for path in paths])
        if dropped.brings_head:  # which takes a while: first say so
            self._to_fit = dropped
            self.messages.say("fitting the muscles to this head ...")
        else:
            self.attempt(lambda: open_dropped(self, dropped))

    def _fit_dropped(self) -> None:
        """Open what has been announced."""
        dropped, self._to_fit = self._to_fit, None
        if dropped is not None:
            self.messages.text = ""
            self.attempt(lambda: open_dropped(self, dropped))
            self._last = time.perf_counter()

    def move_to(self, scene: Scene) -> None:
        """Show another scene with the same controls in place of this one."""
        self.session.move_to(scene)
        self.stage.release()
        self.scene, self.look = scene, checked(self.look, refine.available(), overlays_of(scene))
        self.stage = Stage(self.surface, scene, self.look)
        self.camera = whole_scene(scene, self.session.script.camera)
        self.touch, self.actions = Touch(self), actions_of(self)
        self._drawn, self._posed, self._still_for = (None, FULL), {}, 0.0

    @property
    def _is_asking(self) -> bool:
        return self.files.is_waiting or self.question.is_open
