"""Hair that stands off the head: locks over a lining, both rigid; they go with the cranium.

parts = grown("bob", person.vertices, person.faces, colour)

cuts      how hair is cut and combed
envelope  the surface around head and ears on which it lies
combing   the line of each lock, from its root to the hem
locks     flat bands along these lines
"""

from __future__ import annotations

import numpy as np

from ...generator.fields import Points, smooth_step
from ...generator.sections import rays
from ...generator.solids import grid_faces
from ...model import IndexArray, Part
from .combing import combed, curl, layers_of, roots_of
from .cuts import CUTS, Cut
from .envelope import Envelope
from .locks import locks_along

__all__ = ["CUTS", "HAIR", "grown"]

HAIR = "hair"  # how the names of its parts begin
SHINE = 0.25
SEED = 19
TOP, ROWS, COLUMNS = 55.0, 10, 48  # of the lining: height of its upper edge [mm], size of its grid
ENDED = 15.0  # [mm] over the hem, where it ends
OPENED = 6.0  # [deg] behind the edges of the locks beside the face
SHADES = 0.9, 0.5  # of its colour, outside and inside


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
    envelope = Envelope(vertices, faces)
    roots = roots_of(cut, vertices, faces, receded, random)
    layer = layers_of(cut, roots, random)
    lines = combed(cut, envelope, roots, layer, random)
    arrays = locks_along(lines, layer, cut.look, colour, random)
    locks = Part(name=f"{HAIR}_locks", bone="cranium", shine=SHINE, **arrays)
    return (locks, _lining(cut, envelope, colour)) if cut.hangs else (locks,)


def _lining(cut: Cut, envelope: Envelope, colour: Points) -> Part:
    """The inside of hair that hangs: a curtain behind the locks, open toward the face."""
    first = cut.opening[0] + OPENED
    angles = np.radians(np.linspace(first, 360.0 - first, COLUMNS))
    angle = np.tile(np.where(angles > np.pi, angles - 2.0 * np.pi, angles), ROWS)
    share = np.repeat(np.linspace(0.0, 1.0, ROWS), COLUMNS)
    hem = cut.end(angle) + ENDED
    height = TOP + (hem - TOP) * share
    origin, out = rays(angle, height)
    off = (1.0 + 0.9 * cut.volume) * smooth_step(0.0, 0.4, share) - curl(height - hem, height)
    radius = envelope.radius(angle, height) + off
    points = origin + radius[:, None] * out
    outside = grid_faces(ROWS, COLUMNS)[:, ::-1]
    outer, inner = (np.tile(np.float32(shade * colour), (len(points), 1)) for shade in SHADES)
    return Part(
        name=f"{HAIR}_lining",
        vertices=np.vstack([points, points]).astype(np.float32),
        normals=np.vstack([out, -out]).astype(np.float32),
        faces=np.vstack([outside, outside[:, ::-1] + len(points)]).astype(np.int32),
        colours=np.vstack([outer, inner]),
        bone="cranium",
        shine=SHINE,
        fibres=np.tile(np.stack([angle * radius, -height], axis=1), (2, 1)).astype(np.float32),
    )
