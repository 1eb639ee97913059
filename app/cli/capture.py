"""`risorius capture`: films, frames, pictures and contact sheets; and `risorius demo`."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from ..errors import UserError, in_one_line
from ..recordings.playback import Playback
from ..refining.presets import STATIC, Refinement
from .options import (
    PATH,
    SCENE,
    SCRIPT,
    SETTINGS,
    SOUND,
    BackgroundName,
    Drawing,
    FiniteRange,
    Size,
    option,
    packed,
    played,
    with_playback,
)

if TYPE_CHECKING:
    from risorius import render

    from ..capture import CaptureOptions
    from ..script import Script


@dataclass(frozen=True)
class Filming:
    """Options of capture alone."""

    size: tuple[int, int] = option(
        type=Size(), default=(1280, 720), help="Size of pictures [pixels], 1280x720 by default."
    )
    fps: float = option(
        type=FiniteRange(1, 240), default=30.0, show_default=True, help="Frames a second."
    )
    compare: str | None = option(
        is_flag=False,
        flag_value=STATIC,
        metavar="[NAME,...]",
        help="Looks or refiners to show on the left; without a name the mesh as it is.",
    )
    captions: bool = option(
        "--captions/--no-captions",
        default=True,
        help="Names under a comparison, and a legend of colours.",
    )
    camera: str | None = option(help="Named view, or yaw,pitch[,zoom] in degrees.")
    turntable: bool = option(is_flag=True, help="The camera goes round once.")
    span: tuple[float, float] | None = option(
        "--range",
        type=FiniteRange(0, 86_400),
        nargs=2,
        metavar="FROM TO",
        help="The part of the script to draw [s].",
    )
    background: render.Background | None = option(
        type=BackgroundName(),
        default="light",
        help="light, dark, white, black, a colour as #00b140, or transparent.",
    )
    passes: str | None = option(
        metavar="NAME,...",
        help="Beside each picture: depth, normal, triangle, splits, segmentation, landmarks.",
    )
    alive: bool = option(
        is_flag=True,
        help="Idle life: eyes blink and look at the camera, unless the script moves them.",
    )
    still_time: float | None = option(
        "--time",
        type=FiniteRange(0, 86_400),
        help="Time of a .png [s]; by default the first named pose, or else the end.",
    )
    samples: int = option(
        type=click.IntRange(0, 16),
        default=4,
        show_default=True,
        help="Samples of each pixel, for smooth edges.",
    )
    overwrite: bool = option(is_flag=True, help="Replace the frames in a folder.")
    quiet: bool = option(is_flag=True, help="No progress bar.")

    def options(self, script: Script, drawing: Drawing) -> CaptureOptions:
        """All options that decide a script's frames; UserError for options that cannot be."""
        from ..capture import CaptureOptions
        from ..refining.refiners import parse_comparison

        refinement = drawing.refinement()
        refinement.check(script.scene)
        return CaptureOptions(
            size=self.size,
            frames_per_second=self.fps,
            refinement=refinement,
            beside=parse_comparison(self.compare, refinement),
            captions=self.captions,
            camera=self.camera or script.camera,
            is_turntable=self.turntable,
            span=self.span,
            style=replace(drawing.style(), background=self.background),
            anatomy=drawing.anatomy_view(),
            samples=self.samples,
            head=drawing.fitted_head(),
            is_alive=self.alive,
            passes=() if self.passes is None else tuple(self.passes.split(",")),
        )


@click.command()
@SCRIPT
@SETTINGS
@click.option("-o", "--output", type=PATH, help="out.mp4, .webm, .gif, .webp, a folder, or .png")
@click.option("--sheet", type=PATH, help="Contact sheet of the named poses.")
@SCENE
@SOUND
@packed(Filming)
@with_playback
@packed(Drawing)
def capture(
    script: Path | None,
    settings: tuple[str, ...],
    output: Path | None,
    sheet: Path | None,
    scene: str | None,
    sound: Path | None,
    filming: Filming,
    playback: Playback,
    drawing: Drawing,
) -> None:
    """Draw SCRIPT as a film, frames, a picture or a contact sheet.

    A recording of a face is a SCRIPT, too: Live Link Face, OpenFace, MediaPipe, ... Without SCRIPT
    the scene's own one is played, or a pose of controls is held: --set AU12=0.8.
    """
    from ..capture import capture as film_of
    from ..capture.outputs import HEARD
    from ..files import check_apart
    from ..passes.labels import beside

    written = [output, sheet, *(beside(output) if output and filming.passes is not None else ())]
    check_apart(written, (script, sound, drawing.head, drawing.landmarks))
    if sound is not None and (output is None or output.suffix.lower() not in HEARD):
        raise UserError(f"--sound {sound}: only a film is heard; end -o in {', '.join(HEARD)}")
    performance = played(
        script, scene, playback, settings=settings, sound=sound, quiet=filming.quiet
    )
    options = filming.options(performance, drawing)
    most = film_of(
        performance,
        options,
        output=output,
        sheet=sheet,
        time=filming.still_time,
        overwrite=filming.overwrite,
        progress=not filming.quiet,
    )
    made = in_one_line(" and ".join(str(path) for path in (output, sheet) if path))
    click.echo(f"{made}: {most} triangles at most")


@click.command()
def demo() -> None:
    """Draw the built-in head in its expressions.

    Writes out/demo.mp4 and out/demo.png.
    """
    from ..capture import CaptureOptions
    from ..capture import capture as film_of
    from ..performances import script_for

    script = script_for(None, "face")
    options = CaptureOptions(beside=(Refinement(refiner=STATIC),), camera=script.camera)
    film = Path("out/demo.mp4")
    sheet = Path("out/demo.png")
    most = film_of(script, options, output=film, sheet=sheet)
    click.echo(f"{film} ({script.duration:g} s) and {sheet}: {most} triangles at most")
