"""What a film can be written as, by the suffix of its name: how ffmpeg is told to code it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from ..errors import UserError

# AAC and Opus, as players want them, at a quality that nobody tells from the source.
AAC = "-acodec aac -b:a 192k"
OPUS = "-acodec libopus -b:a 160k"
# H.264; 4:2:0 as every player wants it, at a quality without blocks. The number of threads decides
# the bytes, and with it the memory: left to x264 it is that of the cores and a half, 1 GB on 64.
H264 = "-vcodec libx264 -threads 3 -pix_fmt yuv420p -crf 16 -preset veryfast -movflags +faststart"
PRORES = "-vcodec prores_ks -profile:v 4444 -pix_fmt yuva444p10le -alpha_bits 16"
VP9 = "-vcodec libvpx-vp9 -crf 18 -b:v 0 -deadline good -cpu-used 5 -row-mt 1"
# Each frame has colours of its own: nothing is kept until the end of a long film.
GIF = "-filter_complex split[a][b];[a]palettegen=stats_mode=single{0}[p];[b][p]paletteuse=new=1{1}"
WEBP = "-vcodec libwebp_anim -quality 88 -compression_level 4 -loop 0"


@dataclass(frozen=True)
class FilmFormat:
    """One kind of film.

    coding: for ffmpeg. transparent: the same where pictures have an alpha channel; None: it has
    none. sound: for ffmpeg; None: it is silent. has_even_sizes: unless transparent it needs an even
    width and height. fastest: [frames/s] that players show.
    """

    coding: str
    transparent: str | None = None
    sound: str | None = None
    has_even_sizes: bool = False
    fastest: float = 240.0


FORMATS = {
    ".mp4": FilmFormat(H264, None, AAC, has_even_sizes=True),
    ".mov": FilmFormat(H264, PRORES, AAC, has_even_sizes=True),
    ".mkv": FilmFormat(H264, None, AAC, has_even_sizes=True),
    ".webm": FilmFormat(
        f"{VP9} -pix_fmt yuv420p", f"{VP9} -pix_fmt yuva420p -auto-alt-ref 0", OPUS
    ),
    # Frames last whole hundredths of a second; what is shorter than two, players slow down.
    ".gif": FilmFormat(
        GIF.format("", "") + " -loop 0",
        GIF.format(":reserve_transparent=1", ":alpha_threshold=128") + " -loop 0",
        fastest=50.0,
    ),
    ".webp": FilmFormat(f"{WEBP} -pix_fmt yuv420p", f"{WEBP} -pix_fmt yuva420p"),
}
HEARD = tuple(suffix for suffix, each in FORMATS.items() if each.sound)
TRANSPARENT = tuple(suffix for suffix, each in FORMATS.items() if each.transparent)


def format_of(target: Path) -> FilmFormat | None:
    """What a file of this name is written as; None where it is no film."""
    return FORMATS.get(target.suffix.lower())


def check_name(output: Path) -> None:
    """Raise UserError for a name that is neither a film's, nor a picture's, nor a folder's."""
    suffix = output.suffix.lower()
    if suffix not in (*FORMATS, ".png", "") and not output.is_dir():
        raise UserError(
            f"{output}: what is '{suffix}'? Allowed are {', '.join(FORMATS)} (a film), "
            ".png (one picture) and a name without suffix (a folder of frames)"
        )


def check_format(target: Path, frames_per_second: float, *, is_transparent: bool) -> None:
    """Raise UserError where a film of this name cannot hold such pictures, or so many a second."""
    found = format_of(target)
    if found is None:
        return
    if is_transparent and not found.transparent:
        raise UserError(
            f"{target}: a film of this kind is not transparent; take one of "
            f"{', '.join(TRANSPARENT)}, a folder of pictures, or another --background"
        )
    if frames_per_second > found.fastest:
        raise UserError(
            f"{target}: has at most {found.fastest:g} frames a second, and --fps is "
            f"{frames_per_second:g}; take fewer, or a film of another kind"
        )


def size_of_film(
    target: Path, size: tuple[int, int], *, is_transparent: bool = False
) -> tuple[int, int]:
    """Width and height of a film of such pictures [pixels]: even, where its kind needs that."""
    found = format_of(target)
    if found is None or is_transparent or not found.has_even_sizes:
        return size
    return size[0] + size[0] % 2, size[1] + size[1] % 2
