"""Opens the window: makes the scene behind a splash screen, and then the shared parts."""

from __future__ import annotations

import contextlib
from functools import partial

from risorius import refine
from risorius.assets.fitting import FittedHead

from ...errors import UserError
from ...light_maps import scene_light
from ...refining.plug_ins import plug_ins_of, reported
from ...refining.refiners import refiner_for
from ...scenes import Scene, build_scene
from ...script import Script
from ..context import ApplicationContext
from ..session.session import Session
from ..settings import Display
from .splash_screen import SplashScreen


def open_window(
    splash: SplashScreen, script: Script, head: FittedHead | None, display: Display | None
) -> tuple[ApplicationContext, contextlib.ExitStack, str]:
    """Make the scene, and the shared parts in the open window.

    display: None for the remembered display. Returns the parts, a stack that closes them and the
    window, and a complaint about remembered settings, or "". Raises UserError if script or display
    does not fit the scene; the window is then closed.
    """
    settings = splash.settings
    complaint = splash.complaint
    scene = splash.run(partial(_ready_scene, script, head, display or settings.display))
    with contextlib.ExitStack() as stack:
        stack.push(splash)
        if display is not None:
            settings.display = display
            scene_light(display.light)
            _refine_once(scene, display)
        else:
            dark = settings.display.remove_missing_light()
            complaint = complaint or dark or without_refused_options(settings.display, scene)
        settings.display.remove_missing_overlays(scene)
        context = ApplicationContext(Session(scene, script), settings, splash.surface)
        stack.callback(context.close)
        return context, stack.pop_all(), complaint


def without_refused_options(display: Display, scene: Scene) -> str:
    """Use only the look's refinement if the scene refuses the display; return the reason, or ""."""
    try:
        _refine_once(scene, display)
    except UserError as error:
        display.choose_preset(display.look)
        return f"{error}; the defaults are used"
    return ""


def _ready_scene(script: Script, head: FittedHead | None, display: Display) -> Scene:
    """Return the scene at rest, after its first frames ran once to compile their code.

    A light map is read too.
    """
    scene = build_scene(script.scene, head)
    script.check(scene.limits)
    scene.step(1.0 / 60.0)
    scene.reset()
    with contextlib.suppress(UserError):  # reported when the window is open
        scene_light(display.light)
        _refine_once(scene, display)
    return scene


def _refine_once(scene: Scene, display: Display) -> None:
    """Refine the current scene; raises UserError if the refiner refuses it, or fails."""
    refinement = display.refinement_on(scene)
    refiner = refiner_for(scene, refinement)
    with reported(plug_ins_of(*refinement.for_scene(scene.name))):
        refiner.refine(scene.positions, view=refine.View(scene.framing.focus + 400.0))
