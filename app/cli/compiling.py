"""Compiled code: what is said while it is made, and `risorius warm`, which makes all of it.

Kernels are compiled by numba when they are first called, and kept on disk (`risorius/jit.py`). That
takes half a minute once, for which a user wants to know the reason.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator
from functools import partial
from typing import TYPE_CHECKING, Any

import click
import numpy as np

from ..refining.presets import PAPERS_PRESET, PRESETS, Refinement

if TYPE_CHECKING:
    from ..scenes import Scene

LOG = logging.getLogger("risorius.jit")  # where it is told what is compiled


class Announcer(logging.Handler):
    """Says once that code is compiled, and once that it cannot be kept."""

    def __init__(self) -> None:
        super().__init__(logging.INFO)
        self._said: set[int] = set()

    def emit(self, record: logging.LogRecord) -> None:
        """Say a line on the error stream."""
        if record.levelno in self._said:
            return
        self._said.add(record.levelno)
        line = "Compiling, this once; it takes half a minute (risorius warm: all at once)."
        if record.levelno >= logging.WARNING:
            line = f"risorius: {record.getMessage()}"
        click.echo(line, err=True)


def announce() -> None:
    """From here on tell the user when something is compiled, or cannot be kept."""
    LOG.handlers = [Announcer()]
    LOG.setLevel(logging.INFO)
    LOG.propagate = False


def warm(quiet: bool) -> None:
    """Compile everything that the application runs, with a bar; what is there already is read."""
    from tqdm import tqdm

    LOG.setLevel(logging.WARNING)  # the bar tells of the rest
    jobs = list(_jobs())
    with tqdm(
        jobs, disable=quiet or None, unit="part", bar_format="{l_bar}{bar}| {postfix}"
    ) as bar:
        for name, run in bar:
            bar.set_postfix_str(name)
            run()
        bar.set_postfix_str("everything is compiled", refresh=True)


def _jobs() -> Iterator[tuple[str, Callable[[], object]]]:
    """Everything that compiles kernels of its own, by name."""
    from risorius import refine

    from ..anatomy.muscle_bands import Muscles
    from ..scenes import ClothScene, FaceScene, PlaneScene
    from ..scenes.ambient_occlusion import ambient_occlusion
    from ..script import thinned

    face, plane, cloth = FaceScene(), PlaneScene(), ClothScene()

    def simulate() -> None:
        """Move every control a little, and drag the skin."""
        face.pose(dict.fromkeys(face.limits, 0.1))
        face.step(1 / 60)
        face.simulation.drag([0], face.positions[:1] + 1.0, [1.0])
        face.step(1 / 60)
        face.simulation.end_drag()
        face.simulation.fibres()
        face.reset()

    yield "muscles and springs", simulate
    yield "keys of recordings", partial(thinned, [0.0, 1.0], [0.0, 1.0])
    yield "muscles as solids", partial(Muscles.of, face)
    yield "light", partial(ambient_occlusion, face.head, face.simulation)
    for look in PRESETS:
        for scene in (face, plane):
            yield (
                f"refinement of the {scene.name}: {look}",
                partial(_refine, scene, Refinement(look)),
            )
    choices: tuple[dict[str, Any], ...] = (
        {"blend": True},
        {"scheme": "cubic"},
        {"scheme": "cubic", "criterion": "displacement"},
        {"scheme": "detail"},
        {"scheme": "detail", "criterion": "displacement"},
        {"coherent": True},
        *({"criterion": name} for name in ("rest", "curvature", "silhouette", "screen", "border")),
    )
    for options in choices:
        text = " ".join(f"{name}={value}" for name, value in options.items())
        asked = Refinement(PAPERS_PRESET, options=options)
        yield f"refinement {text}".rstrip(), partial(_refine, face, asked)
    yield "uniform subdivision", partial(_refine, face, Refinement(refiner="loop"))
    yield "the cloth", partial(cloth.step, 1 / 60)
    tension = refine.Tension(face.faces, face.rest_positions)
    yield "strain", partial(tension.measure, face.rest_positions)
    assert face.wrinkles is not None
    wrinkles = refine.Shortening(face.faces, face.rest_positions, face.wrinkles.across)
    yield "wrinkles", partial(wrinkles.measure, face.rest_positions)


def _refine(scene: Scene, refinement: Refinement) -> None:
    from risorius import refine

    from ..refining.refiners import refiner_for

    view = refine.View(scene.focus + np.array([0.0, 0.0, 400.0]))
    refiner_for(scene, refinement).refine(scene.positions, view=view)
