"""The `risorius` command: one short function for each sub-command.

What needs OpenGL or compiled code is imported inside the commands, so that --help comes at once.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import click

from risorius import __version__

from .commands import bench_quality, bench_refine, reproduce, warm
from .compiling import announce
from .errors import OneLineGroup, UserError, in_one_line, told_in_one_line
from .parameters import FiniteRange, Size

Command = Callable[..., Any]


@click.group(cls=OneLineGroup, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, prog_name="risorius")
def main() -> None:
    """Physics-based facial animation with dynamically refined triangle meshes."""
    if sys.stderr is None:  # closed by whoever started us; progress bars ask it what it is
        sys.stderr = open(os.devnull, "w")
    announce()


def drawing_options(command: Command) -> Command:
    """The options that view, replay and capture share."""
    for option in (
        click.option(
            "--refiner",
            default="kahler",
            show_default=True,
            help="Refine plug-in; none draws the mesh as it is.",
        ),
        click.option(
            "--option",
            "settings_of_refiner",
            multiple=True,
            metavar="NAME=VALUE",
            help="Of the refiner: scheme=cubic, criterion=bulge, threshold_once=0.01, ...",
        ),
        click.option(
            "--shading",
            type=click.Choice(["flat", "gouraud", "pixel"]),
            default="pixel",
            show_default=True,
        ),
        click.option("--wireframe", is_flag=True, help="Draw the edges of every triangle."),
        click.option("--splits", is_flag=True, help="Colour triangles by their number of splits."),
        click.option(
            "--skin",
            type=click.Choice(["textured", "plain", "clay"]),
            default="textured",
            show_default=True,
            help="clay is plain grey, as in the paper's pictures.",
        ),
        click.option(
            "--wrinkles",
            type=FiniteRange(0, 1),
            default=1.0,
            show_default=True,
            help="How deep skin wrinkles where it is compressed; 0: not at all.",
        ),
    ):
        command = option(command)
    return command


def head_options(command: Command) -> Command:
    """The options that bring a head of one's own to view, replay and capture."""
    path = click.Path(path_type=Path)
    command = click.option(
        "--landmarks", type=path, help="The 68 iBug landmarks of --head, as JSON."
    )(command)
    return click.option("--head", type=path, help="A head of your own: any triangle mesh.")(command)


@main.command()
@click.argument("script", type=click.Path(path_type=Path), required=False)
@click.option("--set", "settings", multiple=True, metavar="NAME=VALUE", help="Instead of a SCRIPT.")
@click.option("-o", "--output", type=click.Path(path_type=Path), help="out.mp4, a folder, or .png")
@click.option("--sheet", type=click.Path(path_type=Path), help="Contact sheet of the named poses.")
@click.option("--scene", type=click.Choice(["face", "plane"]), help="What is animated.")
@click.option("--size", type=Size(), default=(1280, 720), help="1280x720 unless told.")
@click.option("--fps", type=FiniteRange(1, 240), default=30.0, show_default=True)
@click.option("--compare", is_flag=True, help="The mesh as it is on the left, refined right.")
@click.option("--captions/--no-captions", default=True, help="Words under a comparison.")
@click.option("--camera", help="Named view, or yaw,pitch[,zoom] in degrees.")
@click.option(
    "--time",
    "still_time",
    type=FiniteRange(0, 86_400),
    help="When a .png is taken [s]: else in the first named pose, or at the end.",
)
@click.option("--samples", type=click.IntRange(0, 16), default=4, show_default=True)
@click.option("--overwrite", is_flag=True, help="Replace the frames in a folder.")
@click.option("--quiet", is_flag=True, help="No progress bar.")
@head_options
@drawing_options
def capture(
    script: Path | None,
    settings: tuple[str, ...],
    output: Path | None,
    sheet: Path | None,
    scene: str | None,
    size: tuple[int, int],
    fps: float,
    compare: bool,
    captions: bool,
    camera: str | None,
    still_time: float | None,
    samples: int,
    overwrite: bool,
    quiet: bool,
    head: Path | None,
    landmarks: Path | None,
    refiner: str,
    settings_of_refiner: tuple[str, ...],
    **look: Any,
) -> None:
    """Render SCRIPT offscreen into a film, frames, a picture or a contact sheet.

    Without SCRIPT the scene's own one is played, or a pose of controls is held: --set AU12=0.8.
    """
    from . import capture as capturing
    from .choices import check_apart, head_for, known_refiner, script_for, style_of
    from .refining import options_in_words

    with told_in_one_line():
        check_apart((output, sheet), (script, head, landmarks))
        performance = script_for(script, scene, settings)
        options = capturing.CaptureOptions(
            size=size,
            frames_per_second=fps,
            refiner=known_refiner(refiner),
            refiner_options=options_in_words(refiner, settings_of_refiner),
            compare=compare,
            captions=captions,
            camera=camera or performance.camera,
            style=style_of(**look),
            samples=samples,
            head=head_for(head, landmarks),
        )
        if compare and refiner == "none":
            raise UserError("--compare sets the mesh as it is beside a --refiner other than none")
        most = capturing.write(
            performance,
            options,
            output=output,
            sheet=sheet,
            time=still_time,
            overwrite=overwrite,
            progress=not quiet,
        )
        written = in_one_line(" and ".join(str(path) for path in (output, sheet) if path))
        click.echo(f"{written}: {most} triangles at most")


@main.command()
@click.option("--size", type=Size(), help="Of the window: as it was last, or 1280x800.")
@click.option("--scene", type=click.Choice(["face", "plane"]), help="face, unless told.")
@click.option("--script", type=click.Path(path_type=Path), help="What the space key plays.")
@head_options
@drawing_options
def view(
    size: tuple[int, int] | None, scene: str | None, script: Path | None, **options: Any
) -> None:
    """Open the window: a face with a slider for every muscle."""
    open_viewer(script, scene, size, playing=False, **options)


@main.command()
@click.argument("script", type=click.Path(path_type=Path))
@click.option("--size", type=Size(), help="Of the window: as it was last, or 1280x800.")
@click.option("--once", is_flag=True, help="Close the window at the end of the script.")
@head_options
@drawing_options
def replay(script: Path, size: tuple[int, int] | None, once: bool, **options: Any) -> None:
    """Play SCRIPT in real time in the window."""
    open_viewer(script, None, size, playing=True, once=once, **options)


@main.command()
def demo() -> None:
    """Render the built-in head through its expressions to out/demo.mp4 and out/demo.png."""
    from . import capture as capturing
    from .choices import script_for

    with told_in_one_line():
        script = script_for(None, "face")
        options = capturing.CaptureOptions(compare=True, camera=script.camera)
        film, sheet = Path("out/demo.mp4"), Path("out/demo.png")
        most = capturing.capture(script, options, output=film, sheet=sheet)
        click.echo(f"{film} ({script.duration:g} s) and {sheet}: {most} triangles at most")


@main.command()
@click.option("--scene", type=click.Choice(["face", "plane"]), default="face", show_default=True)
def controls(scene: str) -> None:
    """List every control that a script may name: muscles, action units, expressions, visemes."""
    from .scenes import SCENES

    with told_in_one_line():
        built = SCENES[scene]()
        for title, names in built.groups.items():
            click.echo(title)
            for name in names:
                low, high = built.limits[name]
                action = built.actions.get(name, "")
                click.echo(f"  {name}  {low:g}..{high:g}  {action}".rstrip())


@main.command()
@click.option("--offscreen", is_flag=True, help="Only ask for offscreen OpenGL.")
@click.option("--quiet", is_flag=True, help="Say nothing; the exit code tells.")
def doctor(offscreen: bool, quiet: bool) -> None:
    """Say what there is, what works because of it, and the cure for what is missing.

    Exit code 0: everything is there. 1: some commands work. 2: nothing can be drawn.
    """
    from .doctor import examine

    health, lines = examine(offscreen_only=offscreen)
    if not quiet:
        for line in lines:
            click.echo(line)
    sys.exit(int(health))


REFERENCE_FILES = "a folder with face.npz: vertices, triangles, landmarks68, displacement fields"


@main.group()
def bench() -> None:
    """Measure; each command prints its figures and how they were taken."""


bench.add_command(bench_refine)
bench.add_command(bench_quality)
main.add_command(reproduce)
main.add_command(warm)


@bench.command("simulate")
@click.option("--rounds", type=click.IntRange(1, 100_000), default=100, show_default=True)
def bench_simulate(rounds: int) -> None:
    """Time a 60 Hz frame of the simulation: the head, and plain meshes up to 100k vertices."""
    from .benchmarks import simulate_table

    with told_in_one_line():
        click.echo(simulate_table(rounds))


@bench.command("motion")
@click.option(
    "--reference",
    type=click.Path(exists=True, file_okay=False, path_type=Path),
    required=True,
    help=REFERENCE_FILES,
)
def bench_motion(reference: Path) -> None:
    """Compare simulated with scanned skin motion, shape by shape."""
    from .benchmarks import motion_table

    with told_in_one_line():
        try:
            click.echo(motion_table(reference))
        except ValueError as error:
            raise UserError(f"--reference: {error}") from None


@bench.command("soak")
@click.option(
    "--minutes", type=FiniteRange(0.01, 1e4), default=60.0, show_default=True, help="Simulated."
)
def bench_soak(minutes: float) -> None:
    """Drive the face with random input for a simulated hour: does it stay sound, and come back."""
    from .benchmarks import soak_table

    with told_in_one_line():
        click.echo(soak_table(minutes))


@bench.command("gaps")
@click.option("--json", "json_file", type=click.Path(path_type=Path), help="Figures for programs.")
def bench_gaps(json_file: Path | None) -> None:
    """Look through lips and lids that ought to be shut, in every action unit."""
    from risorius.bench import gaps

    from .benchmarks import gaps_json, gaps_table
    from .outputs import check_file, save_text

    with told_in_one_line():
        if json_file is not None:
            check_file(json_file)
        poses = gaps.run()
        click.echo(gaps_table(poses))
        if json_file is not None:
            save_text(json_file, gaps_json(poses))
            click.echo(f"{in_one_line(json_file)}: written", err=True)


@bench.command("tearing")
@click.option("--mixtures", type=click.IntRange(0, 100_000), default=500, show_default=True)
def bench_tearing(mixtures: int) -> None:
    """Look for torn skin and for contacts that fail, in all expressions and random mixtures."""
    from .benchmarks import tearing_table

    with told_in_one_line():
        click.echo(tearing_table(mixtures))


@bench.command("meshes")
@click.argument("folder", type=click.Path(exists=True, file_okay=False, path_type=Path))
@click.option("--seed", type=click.IntRange(0, 2**32 - 1), default=2003, show_default=True)
@click.option(
    "--seconds", type=FiniteRange(0.1, 3600.0), default=20.0, show_default=True, help="Of a mesh."
)
@click.option(
    "--most",
    type=click.IntRange(1, 10_000_000),
    default=200_000,
    show_default=True,
    help="Triangles; larger meshes are left out.",
)
def bench_meshes(folder: Path, seed: int, seconds: float, most: int) -> None:
    """Refine every mesh in FOLDER and below, in noisy poses, and look for cracks: 1 if any."""
    from risorius.bench import meshes

    from .benchmarks import meshes_table
    from .commands import progress

    with told_in_one_line():
        try:
            seen = meshes.run(
                folder, seed=seed, seconds=seconds, most_triangles=most, progress=progress
            )
        except ValueError as error:
            raise UserError(str(error)) from None
        click.echo(meshes_table(seen))
        sys.exit(1 if any(each.broken for each in seen) else 0)


@bench.command("window")
@click.option("--size", type=Size(), default=(1280, 720), show_default="1280x720")
@click.option(
    "--seconds", type=FiniteRange(0.3, 600.0), default=5.0, show_default=True, help="Of each case."
)
def bench_window(size: tuple[int, int], seconds: float) -> None:
    """Time the window while a smile plays, and while nothing happens; needs a screen."""
    with told_in_one_line():
        from .window_report import window_table

        click.echo(window_table(seconds, size))


def open_viewer(
    script: Path | None,
    scene: str | None,
    size: tuple[int, int] | None,
    *,
    playing: bool,
    once: bool = False,
    head: Path | None,
    landmarks: Path | None,
    refiner: str,
    settings_of_refiner: tuple[str, ...],
    **look: Any,
) -> None:
    """Open the viewer on a script's scene."""
    with told_in_one_line():
        from .choices import head_for, known_refiner, script_for
        from .refining import options_in_words

        performance = script_for(script, scene)
        brought = head_for(head, landmarks)
        from .viewer import Viewer
        from .viewer.settings import look_of, settings_path

        options = options_in_words(refiner, settings_of_refiner)
        chosen = look_of(known_refiner(refiner), options, **look)
        path = settings_path()
        with Viewer(performance, size, chosen, head=brought, settings_path=path) as viewer:
            viewer.run(playing=playing, once=once)
