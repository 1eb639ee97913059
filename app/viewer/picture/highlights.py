"""Highlights of muscles under the mouse: their fibres, and the skin that they move."""

from __future__ import annotations

from collections.abc import Mapping

from risorius import render

from ...scenes import Drawable
from .skin import HoveredMuscle

LIT_COLOUR = (1.0, 0.66, 0.10)  # sRGB


def highlights(
    scene: Drawable, pointed: Mapping[str, float], hovered: HoveredMuscle | None
) -> list[render.Lines | render.Shade]:
    """Return the highlights of a pointed control's muscles, or else of the hovered muscle.

    pointed: name of a muscle -> its weight in the control under the mouse.
    """
    if pointed or hovered is None:
        return [*pointed_lines(scene, pointed)]
    if scene.face is None or scene.face.simulation is not hovered.simulation:
        return []  # the muscle of the face before
    return [shade_of(hovered), *pointed_lines(scene, {hovered.name: 1.0}, clarity=0.35)]


def shade_of(muscle: HoveredMuscle) -> render.Shade:
    """Return a shade of the simulated skin, whose opacity follows its motion by a muscle."""
    clearest = 0.3  # opacity where the muscle moves the skin most
    lift = 4.0  # [mm]; a refined or dense mesh lies nearer to the simulated one
    face = muscle.simulation
    return render.Shade(face.positions, face.faces, clearest * muscle.shares, LIT_COLOUR, lift)


def pointed_lines(
    scene: Drawable, weights: Mapping[str, float], clarity: float = 0.9
) -> list[render.Lines]:
    """Return the fibres of a control's muscles; muscles with larger weights are more opaque.

    weights: name of a muscle -> its weight; a name without side means both sides. clarity: the
    opacity of the muscle with the largest weight.
    """
    face = scene.face if weights else None
    fibres = {} if face is None else face.simulation.anatomy.courses()
    seen: dict[str, float] = {}
    for name, share in weights.items():
        for side in (name, f"{name}_left", f"{name}_right"):
            if side in fibres:
                seen[side] = max(share, seen.get(side, 0.0))
    most = max(seen.values(), default=1.0)
    drawn = []
    for name, share in seen.items():
        if share >= 0.2 * most:
            opacity = clarity * share / most
            drawn.append(render.Lines(fibres[name], LIT_COLOUR, 2.5, opacity, opacity))
    return drawn
