"""What sections 3 and 4 of the paper promise of a refined mesh, counted.

Face and plane play their own scripts, and the paper's refiner is held to its words in moments of
both. A broken promise is counted, so that 0 is what is hoped for, and the number tells how bad it
is.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from itertools import islice

import numpy as np
import numpy.typing as npt

from risorius import refine
from risorius.app.scenes import FaceScene, PlaneScene, Scene
from risorius.refine.kahler.coherence import sequence_tables
from risorius.refine.kahler.table import CONFIGURATIONS

from .experiments import Measured, Outcome
from .table1 import papers_refiner, played

Points = npt.NDArray[np.float64]

FRAMES_PER_SECOND = 60
EVERY = 60  # frames from one moment that is looked at to the next
TURN, SHIFT = np.radians(70.0), (200.0, -50.0, 400.0)  # of the motion that bends nothing, in mm


def outcome() -> Outcome:
    """Count on face and plane what the paper rules out, and what its tables hold."""
    counts: Counter[str] = Counter()
    splits = subtriangles = 0
    for scene in (FaceScene(), PlaneScene()):
        refiner = papers_refiner(scene)
        for title, still in (
            ("at rest", scene.rest_positions),
            ("turned and shifted", _moved(scene.rest_positions)),
        ):
            refiner.refine(still)
            counts[f"edges split {title}"] += int(np.count_nonzero(refiner.splits))
        for positions in _moments(scene):
            before = [array.tobytes() for array in (positions, scene.faces)]
            mesh = refiner.refine(positions)
            splits = max(splits, int(refiner.splits.max()))
            subtriangles = max(subtriangles, int(np.bincount(mesh.source).max()))
            changed = before != [array.tobytes() for array in (positions, scene.faces)]
            counts["frames that changed the mesh"] += changed
            anew = papers_refiner(scene).refine(positions)
            pairs = zip(mesh[:4], anew[:4], strict=True)
            is_other = any(one.tobytes() != other.tobytes() for one, other in pairs)
            counts["frames that remember others"] += is_other
            is_inside = (refiner.origins().weights > 0.0).all(axis=1)
            counts["points inside triangles"] += int(np.count_nonzero(is_inside))
            counts["frames with cracks"] += _is_broken(refiner, mesh, positions)
    lengths = [len(sequence) for sequence in sequence_tables().sequences]
    values: dict[str, Measured | float] = {
        **counts,
        "most splits of an edge": splits,
        "entries of the table": len(CONFIGURATIONS.counts),
        "longest entry": int(CONFIGURATIONS.counts.max()),
        "most subtriangles seen": subtriangles,
        "sequences": len(lengths),
        "shortest sequence": min(lengths),
        "longest sequence": max(lengths),
    }
    return Outcome(values)


def _moments(scene: Scene) -> Iterator[Points]:
    """Positions in moments of the scene's own script."""
    for positions in islice(played(scene, FRAMES_PER_SECOND), EVERY // 2, None, EVERY):
        yield positions.copy()


def _moved(positions: Points) -> Points:
    """The same body elsewhere."""
    cosine, sine = np.cos(TURN), np.sin(TURN)
    turn = np.array([[cosine, 0.0, sine], [0.0, 1.0, 0.0], [-sine, 0.0, cosine]])
    return np.asarray(positions @ turn.T + SHIFT)


def _is_broken(refiner: refine.Refiner, mesh: refine.RefinedMesh, positions: Points) -> bool:
    """Whether `refine.check` finds a crack."""
    try:
        refine.check(refiner, mesh, positions)
    except refine.BrokenMeshError:
        return True
    return False
