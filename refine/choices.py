"""Schemes by name, and what is known of those that are built in."""

from typing import cast

import numpy as np
import numpy.typing as npt

from .butterfly import ButterflyScheme
from .criteria import CRITERIA, Maximum
from .criterion import Criterion, NormalDrop, raise_splits
from .cubic import CubicScheme
from .detail import DetailScheme, FinerMesh
from .native import Call
from .rest_curvature import RestCurvature
from .schemes import Frame, LoopScheme, Scheme

Floats = npt.NDArray[np.float32]
Small = npt.NDArray[np.uint8]

NAMES = ("loop", "butterfly", "cubic", "detail")


def scheme_of(chosen: str | Scheme, detail: FinerMesh | None) -> Scheme:
    """Return the scheme of a name, or the object itself; raises ValueError for anything else."""
    if (chosen == "detail") != (detail is not None):
        raise ValueError(
            'scheme="detail" and detail=(finer rest positions, finer triangles) go together, got '
            f"scheme={chosen!r} and detail {'given' if detail is not None else 'not given'}"
        )
    if detail is not None:
        return DetailScheme(detail)
    if not isinstance(chosen, str):
        is_made = not isinstance(chosen, type)
        if not (is_made and hasattr(chosen, "bind") and hasattr(chosen, "place")):
            raise ValueError(f"scheme must be one of {NAMES} or a refine.Scheme, got {chosen!r}")
        return chosen
    if chosen not in NAMES:
        raise ValueError(f"scheme {chosen!r} is unknown; there are {NAMES}")
    built_in: dict[str, Scheme] = {
        "loop": LoopScheme(),
        "butterfly": ButterflyScheme(),
        "cubic": CubicScheme(),
    }
    return built_in[chosen]


def may_renumber(scheme: Scheme, criterion: Criterion) -> bool:
    """Whether scheme and criterion are built in, and so go by nothing but what they are handed.

    One of somebody else may know vertices and edges by the numbers that the caller gave them.
    """
    if isinstance(criterion, Maximum):
        return all(may_renumber(scheme, one) for one in criterion.criteria)
    schemes = (LoopScheme, ButterflyScheme, CubicScheme, DetailScheme)
    return type(scheme) in schemes and type(criterion) in (NormalDrop, *CRITERIA.values())


def placing_of(scheme: Scheme, frame: Frame) -> tuple[list[Call], list[Call]] | None:
    """Return the compiled calls by which a built-in scheme places points, and those in triangles.

    None for one that places in Python. Not asked of subclasses, which may place otherwise.
    """
    if type(scheme) not in (LoopScheme, CubicScheme, DetailScheme):
        return None
    known = cast(LoopScheme | CubicScheme, scheme)
    return known.placing(frame), known.raising(frame) if frame.is_blended else []


def measuring_of(criterion: Criterion, normals: Floats, need: Floats) -> Call | None:
    """Return the compiled call by which the paper's criterion measures edges, shape (E,).

    None for the others, which measure in Python.
    """
    return criterion.measuring(normals, need) if type(criterion) is NormalDrop else None


def marking_of(criterion: Criterion, normals: Floats, splits: Small) -> list[Call] | None:
    """Return the compiled calls by which a built-in criterion marks edges in `splits`, shape (E,).

    None for one that marks in Python. Not asked of subclasses, which may mark otherwise.
    """
    if type(criterion) in (NormalDrop, RestCurvature):
        return [cast(NormalDrop | RestCurvature, criterion).marking(normals, splits)]
    if type(criterion) is not Maximum:
        return None
    calls: list[Call] = []
    for k, one in enumerate(criterion.criteria):
        asked = splits if k == 0 else np.zeros_like(splits)
        marking = marking_of(one, normals, asked)
        if marking is None:
            return None
        calls += marking if k == 0 else [*marking, raise_splits.bind(asked, splits)]
    return calls
