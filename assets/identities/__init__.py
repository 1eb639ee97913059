"""Make persons: heads whose shape, skin, eyes and hair differ from those of the built-in head.

    person = make_person(sample_identity(7))        # the shape of person number 7
    person = coloured(person, angle=-20.0, irises="brown")

A person can replace the built-in head everywhere: `sim.create(person)`, `FaceScene(person)`.
"""

from ..model import GLASSES_NAME, MASK_NAME
from .beards import BEARD_NAME
from .complexion import built_in_hair, coloured, recoloured
from .features import Features, features_of
from .hair import HAIR_NAME
from .lids import with_lids
from .mask import MASK_COLOURS
from .named import (
    NAMED_PERSONS,
    Colours,
    colours_of_number,
    in_colours,
    person_called,
    person_in_words,
    with_colours_of_number,
)
from .person import Person, make_person
from .population import DARKEST_TONE, EVERYBODY, LIGHTEST_TONE, Population, drawn_irises
from .shirts import COLLAR_BUILDERS, SHIRT_COLOURS
from .space import Identity, Sex, sample_identity
from .wear import GLASSES_FRAMES, wearing

__all__ = [
    "BEARD_NAME",
    "COLLAR_BUILDERS",
    "DARKEST_TONE",
    "EVERYBODY",
    "GLASSES_FRAMES",
    "GLASSES_NAME",
    "HAIR_NAME",
    "LIGHTEST_TONE",
    "MASK_COLOURS",
    "MASK_NAME",
    "NAMED_PERSONS",
    "SHIRT_COLOURS",
    "Colours",
    "Features",
    "Identity",
    "Person",
    "Population",
    "Sex",
    "built_in_hair",
    "coloured",
    "colours_of_number",
    "drawn_irises",
    "features_of",
    "in_colours",
    "make_person",
    "person_called",
    "person_in_words",
    "recoloured",
    "sample_identity",
    "wearing",
    "with_colours_of_number",
    "with_lids",
]
