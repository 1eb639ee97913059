"""Teeth, gums and tongue get darker toward the back, where less light from all around gets in."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

IN_MOUTH = ("teeth", "gums", "tongue")  # names begin so; the cavity is painted dark
LIT, DARK = 2.0, 34.0  # [mm] behind the front teeth, where it begins to get dark and no darker
DIMMED = 0.4  # of the colour (sRGB) that is lost there


def shaded_mouth(parts: Sequence[Any]) -> tuple[Any, ...]:
    """The parts, those of the mouth the darker the farther back they are."""
    front = max((part.vertices[:, 2].max() for part in parts if "teeth" in part.name), default=0.0)

    def shaded(part: Any) -> Any:
        """The part itself where it is not of the mouth."""
        if not part.name.startswith(IN_MOUTH):
            return part
        share = np.clip((front - part.vertices[:, 2] - LIT) / (DARK - LIT), 0.0, 1.0)
        light = 1.0 - DIMMED * share * share * (3.0 - 2.0 * share)
        return replace(part, colours=(part.colours * light[:, None]).astype(np.float32))

    return tuple(shaded(part) for part in parts)
