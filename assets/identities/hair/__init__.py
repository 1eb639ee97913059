"""Hair that stands off the head: locks over a lining, both rigid; they go with the cranium.

parts = grown("bob", person.vertices, person.faces, colour)

cuts      how hair is cut and combed
envelope  the surface around head and ears on which it lies
combing   the line of each lock, from its root to the hem
locks     flat bands along these lines
lining    what is under them
parting   where the scalp is bare
covered   which of their faces are never seen
shade     how much light from all around it takes away from the skin
"""

from __future__ import annotations

import numpy as np

from ...model import IndexArray, Part
from ...smooth import Points
from .combing import combed, layers_of, roots_of
from .covered import is_seen
from .cuts import CUTS
from .envelope import Envelope
from .lining import lining_of
from .locks import locks_along
from .parting import bared
from .shade import shaded

__all__ = ["CUTS", "HAIR", "bared", "grown", "shaded"]

HAIR = "hair"  # how the names of its parts begin
SHINE = 0.25
SEED = 19


def grown(
    name: str, vertices: Points, faces: IndexArray, colour: Points, *, receded: float = 0.0
) -> tuple[Part, ...]:
    """The hair of a cut on a head; nothing for cropped hair, which is painted.

    name: one of `CUTS`. vertices, faces: of a head in the built-in one's place. colour: sRGB,
    shape (3,). receded: how far behind the usual hairline it begins [mm].
    """
    cut = CUTS[name]
    if cut is None:
        return ()
    random = np.random.default_rng(SEED)
    envelope = Envelope(vertices, faces, over_ears=cut.hangs)
    roots = roots_of(cut, vertices, faces, receded, random)
    layer = layers_of(cut, roots, random)
    lines = combed(cut, envelope, roots, layer, random)
    lining = lining_of(cut, envelope, colour, receded)
    locks = locks_along(lines, layer, cut.look, colour, random)
    locks["faces"] = locks["faces"][is_seen(cut, locks, lining)]
    return tuple(
        Part(name=f"{HAIR}_{name}", bone="cranium", shine=SHINE, **arrays)
        for name, arrays in (("locks", locks), ("lining", lining))
    )
