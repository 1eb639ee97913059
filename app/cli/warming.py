"""`risorius warm`: compile every kernel that the application runs; what is there is read."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from tqdm import tqdm

from ..refining.presets import PAPERS_PRESET, PRESETS, Refinement

if TYPE_CHECKING:
    from ..scenes import FaceScene, Scene

CHOICES = (
    "blend=on", "scheme=cubic", "scheme=cubic criterion=displacement", "scheme=detail",
    "scheme=detail criterion=displacement", "coherent=on", "criterion=rest",
    "criterion=curvature", "criterion=silhouette", "criterion=border",
)  # fmt: skip
"""Options of the paper's refiner that have kernels of their own."""


def warm(quiet: bool) -> None:
    """Do everything once, with a bar."""
    logging.getLogger("risorius.jit").setLevel(logging.WARNING)  # the bar tells of the rest
    with tqdm(
        [*_jobs()], disable=quiet or None, unit="part", bar_format="{l_bar}{bar}| {postfix}"
    ) as bar:
        for name, run in bar:
            bar.set_postfix_str(name)
            run()
        bar.set_postfix_str("everything is compiled", refresh=True)


def _jobs() -> Iterator[tuple[str, Callable[[], object]]]:
    """Everything that compiles kernels of its own, by name."""
    from risorius import refine

    from ..refining.refiners import parse_options
    from ..scenes import FaceScene, PlaneScene
    from ..scenes.ambient_occlusion import ambient_occlusion
    from ..script.thinning import thinned

    face, plane = FaceScene(), PlaneScene()
    yield "muscles and springs", partial(_simulate, face)
    yield "keys of recordings", partial(thinned, [0.0, 1.0], [0.0, 1.0])
    yield "light", partial(ambient_occlusion, face.head, face.simulation)
    for look in PRESETS:
        for scene in (face, plane):
            yield f"{look}, {scene.name}", partial(_refine, scene, Refinement(look))
    for text in CHOICES:
        options = parse_options(None, text.split())
        yield text, partial(_refine, face, Refinement(PAPERS_PRESET, options=options))
    yield "uniform subdivision", partial(_refine, face, Refinement(refiner="loop"))
    rest = face.rest_positions
    yield "strain", partial(refine.Tension(face.faces, rest).measure, rest)


def _simulate(face: FaceScene) -> None:
    """Move every control a little, and drag the skin."""
    face.pose(dict.fromkeys(face.limits, 0.1))
    face.step(1 / 60)
    face.simulation.drag([0], face.positions[:1] + 1.0, [1.0])
    face.step(1 / 60)
    face.simulation.end_drag()
    face.simulation.fibres()
    face.reset()


def _refine(scene: Scene, refinement: Refinement) -> None:
    from risorius import refine

    from ..refining.refiners import refiner_for

    view = refine.View(scene.focus + np.array([0.0, 0.0, 400.0]))
    refiner_for(scene, refinement).refine(scene.positions, view=view)
