"""Files with random damage."""

import os
import random
from collections.abc import Sequence

SEED = int(os.environ.get("FUZZ_SEED", "20030214"))  # another seed gives other damage
MOST_PLACES = 6  # [damaged places] at most


def changed(
    content: bytearray,
    chance: random.Random,
    tokens: Sequence[bytes],
    reaches: Sequence[int] = (2**30,),
) -> bytes:
    """The content with a few places overwritten, cut out or doubled.

    tokens: possible replacements. reaches: limits in bytes from the beginning; each damaged place
    starts before one of them, chosen at random.
    """
    for _ in range(chance.randint(1, MOST_PLACES)):
        place = chance.randrange(min(len(content), chance.choice(reaches)) + 1)
        end = min(len(content), place + chance.choice((0, 1, 1, 3, 20)))
        kind = chance.random()
        if kind < 0.5:
            content[place:end] = chance.choice(tokens)
        elif kind < 0.7:
            content[place:end] = bytes([chance.randrange(256)])
        elif kind < 0.85:
            content[place:end] = b""
        else:
            content[place:place] = content[place : place + chance.randrange(60)]
    return bytes(content)
