"""Schemes by name."""

from .cubic import CubicScheme
from .detail import DetailScheme, FinerMesh
from .schemes import LoopScheme, Scheme

NAMES = ("loop", "cubic", "detail")


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
    return LoopScheme() if chosen == "loop" else CubicScheme()
