"""The factory of the refiner `kahler`: it turns option names into objects.

By default the refiner follows the paper exactly (`refine.Kahler`). Options choose other criteria
and schemes, by name or as objects, and let new points appear gradually (`Blended`).
"""

from collections.abc import Sequence
from typing import Annotated, Literal, Unpack

import numpy.typing as npt

from ..border.corner_values import Values
from ..border.option import Option
from ..kahler.coherence import Coherent
from ..kahler.criterion import (
    THRESHOLD_ONCE,
    THRESHOLD_TWICE,
    Criterion,
    DropOnce,
    DropTwice,
    NormalDrop,
    criteria,
)
from ..kahler.cutting import Cutting
from ..kahler.given_splits import GivenSplits
from ..kahler.refiner import Kahler
from ..kahler.scheme import Scheme, schemes
from .blending import Blended
from .measuring import Maximum
from .surface_normals import RefinedNormals

CriterionLike = str | Criterion | Sequence[str | Criterion]
CRITERION_OPTION = Option(
    "chooses the split edges; normal: where the mesh bends (the paper's), rest: where it is curved "
    "at rest, for round outlines, displacement: where the scheme moves edges"
)
BLEND_OPTION = Option("new points move gradually out of edges, so nothing pops")
NORMALS_OPTION = Option(
    "normals for shading; linear: interpolated on the mesh (the paper's), refined: of the refined "
    "surface"
)
COHERENT_OPTION = Option(
    "triangles are cut in the order in which their edges split, and no line turns; for flat shading"
)


def create_kahler(
    faces: npt.ArrayLike,
    rest_positions: npt.ArrayLike,
    *,
    threshold_once: DropOnce = THRESHOLD_ONCE,
    threshold_twice: DropTwice = THRESHOLD_TWICE,
    criterion: Annotated[CriterionLike, CRITERION_OPTION] = "normal",
    splits: npt.ArrayLike | None = None,
    scheme: Annotated[str | Scheme, Option("where the new points go")] = "loop",
    blend: Annotated[bool | None, BLEND_OPTION] = None,
    normals: Annotated[Literal["linear", "refined"] | None, NORMALS_OPTION] = None,
    coherent: Annotated[bool, COHERENT_OPTION] = False,
    **values: Unpack[Values],
) -> Kahler:
    """Bind the paper's refiner to a mesh, changed by the options (see `registry.create`).

    - `threshold_once`, `threshold_twice`: drop of the normals' dot product above which an edge is
      split once or twice, for the paper's criterion, "normal".
    - `criterion`: "normal", "rest", "silhouette", "displacement", another name of
      `refine.criteria`, an object, or a list of these; each edge is split as often as any of
      them requires. "normal+rest" is such a list.
    - `splits`: 0, 1 or 2 for every edge, shape (E,), in place of a criterion: all frames have the
      same vertices and triangles (`splits_of_clip`).
    - `scheme`: "loop", the paper's, "cubic", another name of `refine.schemes`, or an object such as
      `DetailScheme((finer_positions, finer_faces))`.
    - `blend`: whether points move gradually out of their edges, so that nothing pops. None, the
      default, chooses True for the schemes that interpolate, and False for the paper's.
    - `normals`: "linear" interpolates between the ends of an edge, as in the paper; "refined"
      computes the normals of the refined surface. None, the default, chooses "linear" for the
      paper's scheme, and "refined" for schemes that interpolate.
    - `coherent`: whether triangulations continue those of the frame before (section 4.4).
    - `values`: `uv`, `face_uv`, `attributes` and `crease_angle`, as `create` takes them.
    """
    chosen = with_normals(scheme_of(scheme), normals)
    decides = criterion_of(criterion, NormalDrop(threshold_once, threshold_twice), splits)
    if blend and coherent:
        raise ValueError(
            "coherent=True and blend=True exclude each other: one continues the triangulation of "
            "the last frame, the other never turns a diagonal; set one of the two"
        )
    if blend is None:
        blend = chosen.interpolates and not coherent
    cutting: Cutting | None = None
    if blend:
        cutting = Blended()
    elif coherent:
        cutting = Coherent()
    return Kahler(
        faces, rest_positions, criterion=decides, scheme=chosen, cutting=cutting, **values
    )


def scheme_of(chosen: str | Scheme) -> Scheme:
    """Return the scheme with this name, or the given object; raises ValueError otherwise."""
    if isinstance(chosen, str):
        chosen = schemes.find(chosen)()
    if not isinstance(chosen, Scheme):
        raise ValueError(
            f"scheme must be one of {schemes.available()} or a refine.Scheme, got {chosen!r}"
        )
    return chosen


def with_normals(chosen: Scheme, normals: str | None) -> Scheme:
    """Return the scheme, wrapped in `RefinedNormals` if `normals` requires it."""
    if normals not in (None, "linear", "refined"):
        raise ValueError(f'normals must be "linear" or "refined", got {normals!r}')
    is_refined = chosen.interpolates if normals is None else normals == "refined"
    return RefinedNormals(chosen) if is_refined else chosen


def criterion_of(
    chosen: CriterionLike,
    normal_drop: NormalDrop,
    splits: npt.ArrayLike | None = None,
) -> Criterion:
    """Return the criterion for one or more names, for an object, or for given splits, shape (E,).

    `normal_drop`: the factory of the criterion "normal".
    """
    if splits is not None:
        if not (isinstance(chosen, str) and chosen == "normal"):
            raise ValueError(
                "splits= and criterion= both set how often each edge is split; pass one of "
                f"the two, got criterion={chosen!r} as well"
            )
        return GivenSplits(splits)
    if isinstance(chosen, str) and "+" in chosen:
        chosen = chosen.split("+")
    if isinstance(chosen, str):
        chosen = normal_drop if chosen == "normal" else criteria.find(chosen)()
    if isinstance(chosen, Sequence):
        return Maximum([criterion_of(one, normal_drop) for one in chosen])
    if not isinstance(chosen, Criterion):
        raise ValueError(f"criterion must be a name, a refine.Criterion, or a list, got {chosen!r}")
    return chosen
