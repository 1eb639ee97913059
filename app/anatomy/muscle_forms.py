"""How each muscle of the face is drawn: widths, thickness, depth; and muscles that are no controls.

All is millimetres of a head whose outer eye corners are 90 mm apart. Measures: chosen by eye, after
anatomical plates. Muscles that are named here and not in a rig are not drawn.
"""

from typing import NamedTuple


class Linear(NamedTuple):
    """How a muscle of fibres is drawn."""

    width: tuple[float, float, float]  # [mm] at the origin, in the belly, at the insertion
    thickness: float  # [mm] of the belly at rest
    depth: float = 3.0  # [mm] of its middle below the skin at the insertion
    origin: float | None = None  # [mm] the same at the origin; None: on the bone
    tendon: tuple[float, float] = (0.12, 0.06)  # share of its length at both ends
    fibres: tuple[int, ...] | None = None  # which of the rig's; None: all


LINEAR = {
    "frontalis_medial": Linear((17, 17, 13), 2.4, 2.6, 3.2, (0.34, 0.0), (0, 1, 2)),
    "frontalis_lateral": Linear((17, 17, 14), 2.4, 2.6, 3.2, (0.34, 0.0)),
    "corrugator_supercilii": Linear((4, 7, 5), 3.0, 3.6),
    "procerus": Linear((5, 7, 8), 2.2, 2.2, 2.4),
    "depressor_supercilii": Linear((4, 6, 5), 2.4, 2.8, None, (0.12, 0.06), (0,)),
    "levator_labii_superioris_alaeque_nasi": Linear((4, 6, 7), 2.6, 3.0, 3.4),
    "nasalis": Linear((5, 7, 5), 2.0, 2.2, 5.0),
    "nasalis_transverse": Linear((5, 9, 8), 1.6, 1.8, 1.8, (0.3, 0.1), (0,)),
    "levator_labii_superioris": Linear((9, 9, 7), 3.0, 4.2),
    "zygomaticus_minor": Linear((5, 6, 5), 3.2, 3.4),
    "zygomaticus_major": Linear((7, 9, 7), 4.2, 3.4, None, (0.14, 0.06), (0, 1)),
    "levator_anguli_oris": Linear((10, 9, 7), 3.0, 6.0),
    "buccinator": Linear((16, 18, 11), 3.0, 7.0, 18.0),
    "risorius": Linear((4, 6, 5), 2.2, 2.8, 2.6, (0.3, 0.06), (0,)),
    "depressor_anguli_oris": Linear((9, 8, 6), 3.0, 3.0, 5.0, (0.1, 0.04), (0, 2, 3)),
    "depressor_labii_inferioris": Linear((10, 9, 9), 2.8, 4.6, 7.0),
    "mentalis": Linear((6, 9, 9), 3.6, 3.4, None, (0.1, 0.05), (0, 2)),
}


class Rigid(NamedTuple):
    """A muscle from bone to bone, which is no control: ends (x, y, z) [mm off the condyles]."""

    origin: tuple[float, float, float]
    insertion: tuple[float, float, float]
    bones: tuple[str, str]
    form: Linear
    control: str = ""  # without its side


_CHEWING, _NECK = ("cranium", "mandible"), ("mandible", "neck")
RIGID = (
    *(
        Rigid((62, y, z), (50, -14, 23), _CHEWING, Linear((w, 17, 8), 5.5, 15.0, 6.5, (0.1, 0.36)))
        for y, z, w in (
            (20, -46, 20), (42, -40, 24), (58, -24, 26), (65, -2, 26), (60, 19, 24), (46, 33, 20),
            (28, 40, 14),
        )
    ),
    Rigid((56, -9, 40), (50, -62, 20), _CHEWING, Linear((17, 20, 16), 8.0, 8.0, 9.5, (0.26, 0.08))),
    Rigid((58, -7, 24), (50, -58, 8), _CHEWING, Linear((17, 20, 15), 7.0, 9.5, 11.0, (0.16, 0.08))),
    *(
        Rigid(top, low, ("cranium", "neck"), Linear((w, 1.2 * w, w), thick, 10.5, 9.5, (0.1, 0.02)))
        for top, low, w, thick in (
            ((54, -26, -20), (12, -161, 24), 17, 9), ((48, -34, -34), (50, -161, -24), 20, 9),
            ((36, -30, -62), (48, -161, -44), 24, 9), ((11, -24, -88), (32, -161, -66), 26, 9),
            ((7, -92, 44), (9, -161, 26), 13, 6), ((22, -92, 36), (24, -161, 22), 14, 6),
        )
    ),
    *(
        Rigid(top, low, _NECK, Linear((w, 15, 15), 1.5, 4.2, 2.6, (0.12, 0)), "platysma")
        for top, low, w in (
            ((21, -92, 68), (8, -157, 30), 8), ((31, -84, 58), (20, -157, 26), 11),
            ((40, -76, 46), (32, -157, 18), 12), ((49, -70, 32), (42, -157, 4), 12),
            ((56, -60, 14), (50, -157, -14), 10),
        )
    ),
)  # fmt: skip
# Sphincters: the shares of the way outward that their bands cover, thickness and depth [mm].
EYE_BANDS = ((0.02, 0.40, 1.5, 1.9), (0.34, 0.70, 2.0, 2.2), (0.64, 1.0, 2.2, 2.6))
MOUTH_BANDS = ((-0.04, 0.50, 4.4, 3.4), (0.42, 1.0, 3.4, 3.8))
EYE_REACH = (30.0, 19.0, 25.0, 29.0)  # [mm] of the ring from the eye: aside, to the nose, up, down
MOUTH_REACH = (38.0, 38.0, 17.0, 22.0)
UPPER_LIP, LOWER_LIP = (48, 49, 50, 51, 52, 53, 54), (54, 55, 56, 57, 58, 59, 48)
UPPER_INNER, LOWER_INNER = (60, 61, 62, 63, 64), (64, 65, 66, 67, 60)
EYE_LIDS = {1.0: ((45, 44, 43, 42), (42, 47, 46, 45)), -1.0: ((36, 37, 38, 39), (39, 40, 41, 36))}
