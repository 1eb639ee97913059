"""The window: a face that answers to sliders, keys, the mouse and a script.

The simulation runs at the pace of the clock but never by more than a few steps at a time, so that
a window that was stalled (dragged, covered, stopped in a debugger) goes on calmly.
"""

from __future__ import annotations

import contextlib
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from imgui_bundle import imgui

from .cameras import camera_for
from .gui import Gui, poll_events, time_now  # before anything opens a window, see there
from .panels import WIDTH, Panel
from .pipeline import Picture, Pipeline, texture_of
from .scenes import build_scene, within
from .script import Script

import render  # isort: skip - after imgui_bundle
from assets.fitting import FittedHead  # isort: skip

LONGEST_FRAME = 0.1  # [s] what a stalled window catches up at most
DEGREES_PER_PIXEL = 0.35
SMOOTHING = 0.9  # of the shown frame rate, from frame to frame
EXPRESSION_KEYS = tuple(getattr(imgui.Key, f"_{digit}") for digit in range(1, 10))


class Viewer:
    """The window with everything in it; a context manager."""

    def __init__(
        self,
        script: Script,
        size: tuple[int, int],
        refiner: str,
        style: render.Style,
        refiner_options: Mapping[str, float] | None = None,
        head: FittedHead | None = None,
    ) -> None:
        self.script = script
        self.scene = build_scene(script.scene, head)
        script.check_names(self.scene.limits)
        self.refiner = refiner if refiner != "none" else "kahler"
        self.is_refined = refiner != "none"
        self.style = style
        with contextlib.ExitStack() as stack:  # whatever fails here closes the window again
            self.surface = render.open_window(size, f"Risorius: {script.title}")
            stack.callback(self.surface.close)
            self.gui = Gui(self.surface.handle)
            stack.callback(self.gui.close)
            renderer = render.Renderer(self.surface)
            texture = texture_of(self.scene, renderer)
            self.pipelines = {
                name: Pipeline(self.scene, renderer, {name: options}, texture)
                for name, options in (("none", None), (self.refiner, refiner_options))
            }
            self._resources = stack.pop_all()
        self.panel = Panel(self)
        self.camera = self._framed()
        self.controls = dict.fromkeys(self.scene.limits, 0.0)
        self.expression: str | None = None
        self.is_playing = False
        self.script_time = 0.0
        self.frames_per_second = 0.0
        self._last = time_now()

    def __enter__(self) -> Viewer:
        return self

    def __exit__(self, *_: object) -> None:
        self._resources.close()

    @property
    def pipeline(self) -> Pipeline:
        """Figure 1 with the refiner that is switched on."""
        return self.pipelines[self.refiner if self.is_refined else "none"]

    @property
    def picture(self) -> Picture:
        """What was drawn last."""
        return self.pipeline.pictures[0]

    def run(self, *, playing: bool = False, once: bool = False) -> None:
        """Show the window until it is closed (with `once`: until the script has ended)."""
        self.is_playing = playing
        self._last = time_now()
        while not self.surface.should_close:
            self.frame()
            if once and playing and not self.is_playing:
                break

    def frame(self) -> None:
        """One turn of the loop: input, time, picture, panel."""
        poll_events()
        now = time_now()
        elapsed, self._last = now - self._last, now
        if elapsed > 0.0:
            rate = SMOOTHING * self.frames_per_second + (1.0 - SMOOTHING) / elapsed
            self.frames_per_second = rate
        seconds = min(elapsed, LONGEST_FRAME)
        self._play(seconds)
        self.scene.pose({name: value for name, value in self.controls.items() if value})
        if seconds > 0.0:
            self.pipeline.step(seconds)
        self.surface.begin()
        self.pipeline.draw(self.camera, self.style, [self._viewport()])
        self.surface.resolve()  # the panel lies on top of the finished picture
        with self.gui.frame():
            self.panel.draw(imgui.get_io().display_size.y)
            self._keys()
            self._mouse()
        self.surface.end()

    # What the panel and the keys do

    def set_control(self, name: str, value: float) -> None:
        """Take one control by hand; a script that plays is paused."""
        self.is_playing = False
        self.expression = None
        self.controls[name] = value

    def toggle_expression(self, name: str) -> None:
        """Show an expression, or go back to neutral if it is shown already."""
        self.is_playing = False
        self.expression = None if self.expression == name else name
        self.controls = dict.fromkeys(self.scene.limits, 0.0)
        if self.expression is not None:
            self.controls[self.expression] = 1.0

    def neutral(self) -> None:
        """All controls to zero; the skin swings back by itself."""
        self.is_playing = False
        self.expression = None
        self.controls = dict.fromkeys(self.scene.limits, 0.0)

    def toggle_playing(self) -> None:
        """Play or pause; at the end of the script, play it again."""
        self.is_playing = not self.is_playing
        self.expression = None
        if self.is_playing and self.script_time >= self.script.duration:
            self.script_time = 0.0

    def seek(self, time: float) -> None:
        """Go to a time of the script and take its pose."""
        self.script_time = time
        self.expression = None
        self._take_script_pose()

    def restyle(self, **changes: Any) -> None:
        """Change how the picture is drawn: fields of `render.Style`."""
        self.style = replace(self.style, **changes)

    def next_shading(self) -> None:
        """Flat, Gouraud, per pixel, and round again."""
        order = list(render.Shading)
        self.restyle(shading=order[(order.index(self.style.shading) + 1) % len(order)])

    def toggle_splits(self) -> None:
        """Colour triangles by their number of splits, or not."""
        is_on = self.style.colour_by is render.ColourBy.SPLITS
        self.restyle(colour_by=render.ColourBy.NONE if is_on else render.ColourBy.SPLITS)

    def toggle_refinement(self) -> None:
        """Draw the refined mesh, or the mesh as it is."""
        self.is_refined = not self.is_refined

    # One frame's parts

    def _play(self, seconds: float) -> None:
        if not self.is_playing:
            return
        self.script_time += seconds
        if self.script_time >= self.script.duration:
            self.script_time = self.script.duration
            self.is_playing = False
        self._take_script_pose()

    def _take_script_pose(self) -> None:
        channels = within(self.scene.limits, self.script.at(self.script_time))
        self.controls = {**dict.fromkeys(self.scene.limits, 0.0), **channels}

    def _keys(self) -> None:
        if imgui.get_io().want_text_input:
            return
        actions: dict[Any, Any] = {
            imgui.Key.space: self.toggle_playing,
            imgui.Key.s: self.next_shading,
            imgui.Key.n: self.neutral,
            imgui.Key.r: self.toggle_refinement,
            imgui.Key.c: self.toggle_splits,
            imgui.Key.w: lambda: self.restyle(wireframe=not self.style.wireframe),
            imgui.Key.t: lambda: self.restyle(textured=not self.style.textured),
        }
        for key, action in actions.items():
            if imgui.is_key_pressed(key, False):
                action()
        if imgui.is_key_pressed(imgui.Key.f, False):
            self.camera = self._framed()
        for key, expression in zip(EXPRESSION_KEYS, self.scene.expressions, strict=False):
            if imgui.is_key_pressed(key, False):
                self.toggle_expression(expression)

    def _mouse(self) -> None:
        io = imgui.get_io()
        if io.want_capture_mouse:
            return
        if imgui.is_mouse_dragging(0, 0.0):
            self.camera.orbit(
                -io.mouse_delta.x * DEGREES_PER_PIXEL, io.mouse_delta.y * DEGREES_PER_PIXEL
            )
        if imgui.is_mouse_dragging(1, 0.0) or imgui.is_mouse_dragging(2, 0.0):
            height = max(io.display_size.y, 1.0)
            self.camera.pan(-io.mouse_delta.x / height, io.mouse_delta.y / height)
        if io.mouse_wheel:
            self.camera.zoom(1.1**io.mouse_wheel)

    def _framed(self) -> render.OrbitCamera:
        return camera_for(self.scene, self.script.camera)

    def _viewport(self) -> tuple[int, int, int, int]:
        """The part of the framebuffer to the right of the panel."""
        width, height = self.surface.size
        window_width = max(imgui.get_io().display_size.x, 1.0)
        left = min(round(WIDTH * width / window_width), width - 1)
        return (left, 0, width - left, height)
