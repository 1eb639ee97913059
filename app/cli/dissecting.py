"""Options for what is seen under the skin."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from ..errors import UserError
from .parameters import FiniteRange

if TYPE_CHECKING:
    from ..anatomy import Dissection

SOLIDS = ("muscles", "skull")  # anatomy.SOLIDS, not imported yet
DISSECTION_OPTIONS = ("anatomy", "skin_opacity", "dissect")
DISSECTING = (
    click.option(
        "--dissect",
        type=click.Choice(["both", "left", "right"]),
        help="With --anatomy: the subject's side whose skin is translucent; both unless told.",
    ),
    click.option(
        "--skin-opacity",
        type=FiniteRange(0, 1),
        help="With --anatomy: how much of the skin is seen, 0.25 unless told; 0: none.",
    ),
    click.option(
        "--anatomy",
        is_flag=False,
        flag_value=",".join(SOLIDS),
        metavar="[NAME,...]",
        help="Draw muscles, skull or both under translucent skin.",
    ),
)


def dissection_of(drawing: Any) -> Dissection:
    """What is seen under the skin; UserError for what is not there."""
    from ..anatomy import OPACITY, Dissection

    if drawing.anatomy is None:
        for name in ("skin_opacity", "dissect"):
            if getattr(drawing, name) is not None:
                option = name.replace("_", "-")
                raise UserError(
                    f"--{option} goes with --anatomy, which says what is under the skin"
                )
        return Dissection()
    names = drawing.anatomy.split(",")
    for name in names:
        if name not in SOLIDS:
            raise UserError(f"--anatomy: '{name}' is not there; it takes {', '.join(SOLIDS)}")
    opacity = OPACITY if drawing.skin_opacity is None else drawing.skin_opacity
    return Dissection(tuple(names), opacity, drawing.dissect or "both")
