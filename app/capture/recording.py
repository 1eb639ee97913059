"""Offscreen capture: a script becomes a film, a folder of frames, a picture or a contact sheet."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Generator
from pathlib import Path

from ..errors import UserError
from ..files import check_file
from ..motion import scene_of
from ..passes.labels import check_wanted, files_beside, save_labelled
from ..pictures import Image, check_png, save_png
from ..script import Script
from ..sound.decoding import load_sound
from . import outputs, processes
from .captions import contact_sheet
from .drawing import Capture, CaptureOptions, DrawnFrame, check_camera
from .outputs import SOUND_FILM_SUFFIXES, FilmSound, check_name, format_of


def capture(
    script: Script,
    options: CaptureOptions,
    *,
    output: Path | None = None,
    sheet: Path | None = None,
    time: float | None = None,
    overwrite: bool = False,
    progress: bool = True,
) -> int:
    """Draw a script into `output`, in the format of its suffix, and its named poses into `sheet`.

    time: time of a picture [s]; None takes the first named pose, or else the end of the script.
    Returns the largest number of triangles of a frame. Raises UserError for impossible outputs.
    """
    _check(script, options, output, sheet, time)
    _check_passes(script, output, options)
    counts = [0]
    if sheet is not None:
        counts.append(_draw_sheet(script, options, sheet, progress))
    if output is not None and _is_image(output):
        counts.append(_draw_picture(script, options, output, time, progress))
    elif output is not None:
        counts.append(_draw_film(script, options, output, overwrite, progress))
    return max(counts)


def _draw_sheet(script: Script, options: CaptureOptions, sheet: Path, progress: bool) -> int:
    """Arrange pictures of the named poses in one; return the largest number of triangles."""
    half = 0.5 / options.frames_per_second
    most = 0
    wanted = list(script.key_poses)
    named = list[tuple[str, Image]]()
    for now, draw in _played(script, options, script.duration, progress):
        if wanted and wanted[0].time <= now + half:
            frame = draw()
            most = max(most, frame.triangle_count)
            while wanted and wanted[0].time <= now + half:
                named.append((wanted.pop(0).name or "", frame.image))
    most_columns = 2 if options.beside else 3
    save_png(sheet, contact_sheet(named, columns=min(len(named), most_columns)))
    return most


def _draw_picture(
    script: Script, options: CaptureOptions, output: Path, time: float | None, progress: bool
) -> int:
    """Draw the frame at a time [s]; return the number of its triangles."""
    if time is None:
        time = script.key_poses[0].time if script.key_poses else script.duration
    moment = round(time * options.frames_per_second) / options.frames_per_second
    playing = _played(script, options, moment, progress)
    (frame,) = [draw() for now, draw in playing if now == moment]
    save_labelled(output, frame.image, frame.known)
    return frame.triangle_count


def _draw_film(
    script: Script, options: CaptureOptions, output: Path, overwrite: bool, progress: bool
) -> int:
    """Draw a film or a folder of frames; return the largest number of triangles of a frame."""
    rate = options.frames_per_second
    most = 0
    begin, end = options.span or (0.0, script.duration)
    count = processes.process_count(options, round((end - begin) * rate + 0.5) + 1)
    if format_of(output):
        sink = outputs.film(output, options.size, rate, soundtrack_of(script, options.span))
    else:
        sink = outputs.folder(output, overwrite=overwrite)
    playing = _played(script, options, end, progress, count)
    with sink as add, contextlib.closing(playing):
        for now, draw in playing:
            if now >= begin - 0.5 / rate:
                frame = draw()
                add(frame.image, frame.known)
                most = max(most, frame.triangle_count)
    return most


def _played(
    script: Script, options: CaptureOptions, until: float, progress: bool, count: int = 1
) -> Generator[tuple[float, Callable[[], DrawnFrame]]]:
    """Play a script in `count` processes; yield each frame's time [s] and its drawing function."""
    if count > 1:
        yield from processes.drawing(script, options, until, count, progress=progress)
        return
    with Capture(scene_of(script, options.head), options) as recording:
        for now in recording.play(script, until=until, progress=progress):
            yield now, recording.next_frame


def _is_image(output: Path | None) -> bool:
    return output is not None and output.suffix.lower() == ".png"


def _check(
    script: Script,
    options: CaptureOptions,
    output: Path | None,
    sheet: Path | None,
    time: float | None,
) -> None:
    """Raise UserError, before any work is done, for an impossible output."""
    if time is not None and not _is_image(output):
        raise UserError(
            f"--time {time:g}: one time needs a picture.png as -o; for a film write --time FROM:TO"
        )
    if time is not None and time > script.duration:
        raise UserError(f"--time {time:g}: {script.source} ends at {script.duration:g} s")
    if options.span is not None:
        begin, end = options.span
        if sheet is not None or _is_image(output):
            raise UserError(
                f"--time {begin:g}:{end:g}: is for a film or a folder of frames; a picture has one "
                "time"
            )
        if not 0.0 <= begin < end <= script.duration:
            raise UserError(
                f"--time {begin:g}:{end:g}: give two times from 0 to {script.duration:g} s, "
                "the earlier one first"
            )
    if isinstance(options.camera, str):
        check_camera(options.camera, script.source if options.camera == script.camera else "")
    if output is None and sheet is None:
        raise UserError("nothing to write: give -o OUTPUT, --sheet PICTURE, or both")
    if sheet and not script.key_poses:
        raise UserError(f"{script.source}: no pose has a name; --sheet draws only named poses")
    if sheet is not None:
        check_png(sheet)
    if output is not None:
        check_name(output)
    if output is not None and _is_image(output):
        check_png(output)
    elif output is not None and format_of(output) and options.is_transparent:
        raise UserError(
            f"{output}: a film cannot be transparent; write a folder of pictures, or choose "
            "another --background"
        )
    elif (
        output is not None
        and script.sound is not None
        and output.suffix.lower() in SOUND_FILM_SUFFIXES
    ):
        try:
            load_sound(script.sound)
        except UserError as error:
            raise UserError(f"{script.source}, 'sound': {error}") from None


def _check_passes(script: Script, output: Path | None, options: CaptureOptions) -> None:
    """Raise UserError, before any work is done, if the passes cannot be made or written."""
    if not options.passes:
        return
    check_wanted(options.passes, script.scene)
    if output is None or format_of(output):
        raise UserError(
            "--passes are files beside each picture: give -o a folder, or one picture.png"
        )
    if options.beside:
        raise UserError("--passes and --compare exclude each other; leave one of them out")
    if _is_image(output):
        for path in files_beside(output):
            check_file(path)


def soundtrack_of(script: Script, span: tuple[float, float] | None = None) -> FilmSound | None:
    """Return the sound of a script or of its span [s]; the sound may end before the film."""
    begin, end = span or (0.0, script.duration)
    return None if script.sound is None else FilmSound(script.sound, end - begin, begin)
