"""`risorius capture`: films, frames, pictures and contact sheets; and `risorius demo`."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from ..errors import UserError
from ..refining.presets import PAPERS_PRESET, STATIC_REFINER, Refinement
from ..text import in_one_line
from .help import GroupedCommand
from .options import (
    SCENE_OPTION,
    SCRIPT_ARGUMENT,
    SETTINGS_OPTION,
    SOUND_OPTION,
    DrawingOptions,
    option,
    packed,
    played,
)
from .value_types import MAP_BACKGROUND, PATH_TYPE, BackgroundName, FiniteRange, Size, Times

if TYPE_CHECKING:
    from risorius import render

    from ..capture import CaptureOptions
    from ..script import Script


@dataclass(frozen=True)
class Filming:
    """Options that only `capture` has."""

    size: tuple[int, int] = option(
        type=Size(), default=(1280, 720), help="Size of pictures [pixels]; by default 1280x720."
    )
    fps: float = option(
        type=FiniteRange(1, 240),
        default=30.0,
        show_default=True,
        help="Frames per second, such as 25 or 30000/1001.",
    )
    compare: str | None = option(
        is_flag=False,
        flag_value=STATIC_REFINER,
        metavar="[NAME,...]",
        help="Looks or refiners to show on the left; without a name the unrefined mesh.",
    )
    camera: str | None = option(
        help="The view, by name or as yaw,pitch[,zoom], angles in degrees. turntable, alone or "
        "after a view and a comma, moves the camera once around the head.",
    )
    times: tuple[float, ...] | None = option(
        "--time",
        type=Times(),
        help="Time of a .png [s]; by default that of the first named pose, or else the end. "
        "FROM:TO: the part of the script that a film or a folder shows [s].",
    )
    background: render.Background | str | None = option(
        type=BackgroundName(),
        default="light",
        help="light, dark, white, black, a colour such as #00b140 or grey, transparent, or map: "
        "the light map of the scene, out of focus.",
    )
    passes: str | None = option(
        metavar="NAME,...",
        help="Files to write beside each picture: depth, normal, triangle, splits, segmentation, "
        "landmarks.",
    )
    alive: bool | None = option(
        "--alive/--not-alive",
        default=None,
        help="Add idle life: eyes blink and look at the camera, and the head nods with speech, "
        "unless the script moves them. By default, scripts with alive = true and recordings "
        "without motion of the head have it.",
    )
    overwrite: bool = option(is_flag=True, help="Replace the frames in a folder.")
    quiet: bool = option(is_flag=True, help="No progress bar.")

    @property
    def still_time(self) -> float | None:
        """The time of a picture [s]; None: the script decides."""
        return self.times[0] if self.times is not None and len(self.times) == 1 else None

    @property
    def span(self) -> tuple[float, float] | None:
        """The part of the script to draw [s]; None: all of it."""
        if self.times is None or len(self.times) == 1:
            return None
        begin, end = self.times
        return begin, end

    def view(self) -> tuple[str | None, bool]:
        """Split --camera into its view, and whether it ends with the word turntable."""
        if self.camera is None:
            return None, False
        words = self.camera.split(",")
        is_turntable = words[-1] == "turntable"
        if is_turntable:
            words.pop()
        return ",".join(words) or None, is_turntable

    def _style(self, drawing: DrawingOptions) -> render.Style:
        """Return the style of pictures, with its background."""
        from risorius import render

        from ..light_maps import scene_light

        style = drawing.style()
        if not isinstance(self.background, str):
            return replace(style, background=self.background)
        behind = scene_light(drawing.style_options["light"]).behind
        if behind is None:
            raise UserError(
                f"--background {MAP_BACKGROUND}: no map lights the scene; add --style light=FILE, "
                f"or light={' or '.join(render.LIGHT_MAPS)}"
            )
        return replace(style, background=behind)

    def options(
        self,
        script: Script,
        drawing: DrawingOptions,
        *,
        is_recorded: bool = False,
        is_still: bool = False,
    ) -> CaptureOptions:
        """Return the options for a script's frames; raise UserError for impossible options.

        is_still: whether only one picture is made, which could show a blink.
        """
        from ..capture import CaptureOptions
        from ..refining.refiners import parse_comparison

        refinement = drawing.refinement()
        refinement.check(script.scene)
        camera, is_turntable = self.view()
        has_head = any(name.startswith("head_") for name in script.names)
        lives = not is_still and (script.alive or (is_recorded and not has_head))
        return CaptureOptions(
            size=self.size,
            frames_per_second=self.fps,
            refinement=refinement,
            beside=parse_comparison(self.compare, refinement),
            camera=camera or script.camera,
            is_turntable=is_turntable,
            span=self.span,
            style=self._style(drawing),
            anatomy=drawing.anatomy_view(),
            head=drawing.fitted_head(),
            is_alive=lives if self.alive is None else self.alive,
            passes=() if self.passes is None else tuple(self.passes.split(",")),
        )


@click.command(cls=GroupedCommand)
@SCRIPT_ARGUMENT
@SETTINGS_OPTION
@click.option(
    "-o",
    "--output",
    type=PATH_TYPE,
    help="The film: out.mp4, .webm, .gif or .webp; a .png; or a folder of frames.",
)
@click.option("--sheet", type=PATH_TYPE, help="A .png with the named poses side by side.")
@SCENE_OPTION
@SOUND_OPTION
@packed("filming", Filming)
@packed("drawing", DrawingOptions)
def capture(
    script: Path | None,
    settings: tuple[str, ...],
    output: Path | None,
    sheet: Path | None,
    scene: str | None,
    sound: Path | None,
    filming: Filming,
    drawing: DrawingOptions,
) -> None:
    """Draw SCRIPT as a film, frames, a picture or a contact sheet.

    SCRIPT is a .toml, or a recording of a face by Live Link Face, OpenFace, MediaPipe or others;
    `risorius convert` calibrates recordings. Without SCRIPT the built-in script of the scene is
    played, or --set AU12=0.8 holds a pose.
    """
    from ..capture import capture as film_of
    from ..capture.outputs import SOUND_FILM_SUFFIXES
    from ..files import check_apart
    from ..passes.labels import files_beside

    written = [output, sheet]
    if output and filming.passes is not None:
        written += files_beside(output)
    check_apart(written, (script, sound, drawing.light_file, *drawing.files))
    if sound is not None and (output is None or output.suffix.lower() not in SOUND_FILM_SUFFIXES):
        raise UserError(
            f"--sound {sound}: only films with sound can hold it; end -o in "
            f"{', '.join(SOUND_FILM_SUFFIXES)}"
        )
    performance = played(script, scene, settings=settings, sound=sound, quiet=filming.quiet)
    is_recording = script is not None and script.suffix.lower() != ".toml"
    is_still = output is not None and output.suffix.lower() == ".png"
    options = filming.options(performance, drawing, is_recorded=is_recording, is_still=is_still)
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
    """Film the coarse head three times: unrefined, by the paper's rule, and smooth.

    The head speaks in out/demo.mp4; out/demo.png has its expressions. Wires outline triangles that
    are split because muscles bend the skin.
    """
    from risorius import render

    from ..capture import CaptureOptions
    from ..capture import capture as film_of
    from ..performances import examples, script_for
    from ..scenes import COARSE_NAME, called_head

    clay = render.Style(textured=False, albedo=render.CLAY)
    beside = Refinement(refiner=STATIC_REFINER), Refinement(PAPERS_PRESET)
    camera = "-32,3,1.6"  # a close three-quarter view
    still = CaptureOptions(beside=beside, camera=camera, style=clay, head=called_head(COARSE_NAME))
    wired = replace(clay, colour_by=render.ColourBy.SPLIT_WIRES)
    speech = next(path for path in examples("face") if path.stem == "speech")
    script = script_for(speech, None)
    film = Path("out/demo.mp4")
    sheet = Path("out/demo.png")
    most = film_of(script, replace(still, style=wired, is_alive=True), output=film)
    film_of(script_for(None, "face"), still, sheet=sheet)
    click.echo(f"{film} ({script.duration:g} s) and {sheet}: {most} triangles at most")
