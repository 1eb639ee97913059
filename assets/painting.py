"""The skin of the built-in head in any complexion, painted anew."""

from .files import Image
from .loading import load
from .model import Tone

SMALLEST = 64  # [texels] below this an eye would be smaller than a texel


def paint(*, tone: Tone | str = Tone.MEDIUM_LIGHT, size: int | None = None) -> Image:
    """Paint the skin of the built-in head, shape (size, size, 3), uint8, sRGB; row 0 is v = 1.

    tone: a Tone or its value. size: of the image [texels]; None for that of the shipped one.
    It takes about ten seconds. Raises ValueError for an unknown tone and for too small a size.
    """
    # Only who paints needs the generator, and scipy with it.
    from .generator.painting import SIZE, paint_skin

    tones = [known.value for known in Tone]
    if not isinstance(tone, Tone) and tone not in tones:
        raise ValueError(f"tone is {tone!r}; it must be one of {', '.join(tones)}")
    if size is not None and size < SMALLEST:
        raise ValueError(f"size is {size} texels; it must be at least {SMALLEST}, or be left out")
    return paint_skin(load("head"), tone=Tone(tone), size=size or SIZE)
