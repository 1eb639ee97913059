"""The ffmpeg that films and sounds go through: which program it is, and how it is told of a sound.

`imageio_ffmpeg` brings one along.
"""

from __future__ import annotations

from pathlib import Path

from .errors import UserError, needed

RATE = 48_000  # [samples/s] of sounds; what devices and films have, too


def program() -> str:
    """The ffmpeg that is used here; UserError where there is none."""
    imageio_ffmpeg = needed("imageio_ffmpeg", "film or sound", "films", package="imageio-ffmpeg")
    try:
        return str(imageio_ffmpeg.get_ffmpeg_exe())
    except RuntimeError:
        raise UserError(
            "no film without ffmpeg: install it, or write frames to a folder (-o NAME)"
        ) from None


def sound_form() -> tuple[str, ...]:
    """Options for a sound at `RATE`; of both sides, where it has them.

    What begins late in its file (the sound of a film, say) begins as late here.
    """
    form = f"aformat=sample_rates={RATE}:channel_layouts=mono|stereo"
    return "-af", f"aresample=async=1:first_pts=0,{form}"


def sound_input(file: Path, seconds: float, begin: float = 0.0) -> tuple[str, ...]:
    """Options for an input of so much sound: of a file, and of nothing that this may point to."""
    skipped = ("-ss", f"{begin:.6f}") if begin else ()
    return "-protocol_whitelist", "file", *skipped, "-t", f"{seconds:.6f}", "-i", f"file:{file}"
