"""Options that several commands share, and the dataclasses that hold their values."""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field, fields
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
from click.core import ParameterSource

from ..errors import UserError
from ..playback import LEAD_TIME, Playback
from ..refining.presets import FIRST_PRESET, PRESETS, Refinement
from .styles import LIGHT_NAMES, STRUCTURE_NAMES, anatomy_in, style_in
from .value_types import PATH_TYPE, FiniteRange, HeadName

if TYPE_CHECKING:
    from risorius import render
    from risorius.assets.fitting import FittedHead

    from ..anatomy import AnatomyView
    from ..recordings.report import Report
    from ..script import Script

CommandFunction = Callable[..., Any]
SCENE_NAMES = click.Choice(["face", "plane"])
SOUND_OPTION = click.option(
    "--sound",
    type=PATH_TYPE,
    help="The sound: a WAV, an MP3, another sound file, or a film with sound.",
)
QUIET_OPTION = click.option("--quiet", is_flag=True, help="Print no report of a recording.")
SILENT_OPTION = click.option("--quiet", is_flag=True, help="No progress bar.")
SCRIPT_ARGUMENT = click.argument("script", type=PATH_TYPE, required=False)
SETTINGS_OPTION = click.option(
    "--set",
    "settings",
    multiple=True,
    metavar="NAME=VALUE",
    help="Hold a control at this value, in place of a SCRIPT.",
)
SCENE_OPTION = click.option("--scene", type=SCENE_NAMES, help="The scene to animate.")


def option(*names: str, **about: Any) -> Any:
    """Declare a dataclass field as a command-line option; default name: the field's name."""
    return field(metadata={"option": (names, about)})


def options_of(settings: type[Any]) -> Iterator[CommandFunction]:
    """Yield the command-line options that the fields of a dataclass declare."""
    for each in fields(settings):
        names, about = each.metadata["option"]
        names = names or (f"--{each.name.replace('_', '-')}",)
        yield click.option(*names, each.name, **about)


def packed(
    name: str, settings: type[Any], options: Iterable[CommandFunction] = ()
) -> Callable[[CommandFunction], CommandFunction]:
    """Add the options of a dataclass to a command, which receives them as one argument.

    - name: of the argument.
    - options: options in place of those that the fields declare.
    """
    keys = [each.name for each in fields(settings)]
    decorators = list(options or options_of(settings))

    def decorate(command: CommandFunction) -> CommandFunction:
        """Wrap a command, so that it receives these options as one object."""

        @functools.wraps(command)
        def call(**given: Any) -> Any:
            packed_in = settings(**{key: given.pop(key) for key in keys})
            return command(**given, **{name: packed_in})

        wrapped: CommandFunction = call
        for each in reversed(decorators):
            wrapped = each(wrapped)
        return wrapped

    return decorate


@dataclass(frozen=True)
class HeadOptions:
    """Options that choose the head, and how its mesh is refined."""

    head: Path | int | str | None = option(
        type=HeadName(),
        help="The head: a triangle mesh of yours; a person, by any number or name (ada, kofi, "
        "maria); or coarse, the built-in head with a quarter of its triangles.",
    )
    landmarks: Path | None = option(
        type=PATH_TYPE,
        help="The 68 iBug landmarks of --head, as JSON. Heads of MakeHuman, ICT-FaceKit and "
        "MediaPipe need none.",
    )
    look: str = option(
        type=click.Choice(list(PRESETS)),
        default=FIRST_PRESET,
        show_default=True,
        help="How the mesh is refined: smooth, or by the paper's own rule.",
    )
    refiner: str | None = option(
        metavar="NAME",
        help="A refiner in place of the look's; `risorius doctor` lists them. none draws the mesh "
        "unrefined.",
    )
    refiner_settings: tuple[str, ...] = option(
        "--option",
        multiple=True,
        metavar="NAME=VALUE",
        help="An option of the refiner, in place of the look's: scheme=cubic, "
        "criterion=displacement, rest.levels=1, ... --option help lists all with their values.",
    )

    @property
    def files(self) -> tuple[Path, ...]:
        """The files of a user's head."""
        return tuple(each for each in (self.head, self.landmarks) if isinstance(each, Path))

    def check_head(self) -> None:
        """Raise UserError for options that exclude or need each other."""
        is_named = self.head is not None and not isinstance(self.head, Path)
        if is_named and self.landmarks is not None:
            raise UserError(f"--head {self.head}: its landmarks are known; leave --landmarks out")
        if self.head is None and self.landmarks is not None:
            raise UserError(
                f"--landmarks {self.landmarks}: needs --head; add the mesh of these landmarks"
            )

    def fitted_head(self) -> FittedHead | None:
        """Return the user's fitted head, or a head by its name; None for the built-in head."""
        self.check_head()
        if self.head is None:
            return None
        if not isinstance(self.head, Path):
            from ..scenes import called_head

            return called_head(self.head)
        from ..scenes import fit_users_head

        return fit_users_head(self.head, self.landmarks)

    def refinement(self) -> Refinement:
        """Return how the mesh is refined; raise UserError for an unknown refiner."""
        from ..refining.refiners import help_of_options, parse_options

        if "help" in self.refiner_settings:
            click.echo(help_of_options(Refinement(self.look, self.refiner).for_scene("face")[0]))
            raise click.exceptions.Exit(0)
        options = parse_options(self.refiner, self.refiner_settings)
        return Refinement(self.look, self.refiner, options)


@dataclass(frozen=True)
class DrawingOptions(HeadOptions):
    """Options that view, replay and capture share: the head, its refinement and its style."""

    anatomy: str | None = option(
        is_flag=False,
        flag_value=",".join(STRUCTURE_NAMES),
        metavar="[NAME,...]",
        help="Draw muscles, skull or both under translucent skin. opacity=0..1: opacity of the "
        "skin, 0.25 by default. dissect=left or right: only this side of the subject has "
        "translucent skin.",
    )
    style_settings: tuple[str, ...] = option(
        "--style",
        multiple=True,
        metavar="NAME[=VALUE],...",
        help="How the head looks: wireframe; splits, colours by the number of splits; wires, "
        "outlines of triangles that are split more than at rest; skin=textured, plain or clay; "
        f"light={', '.join(LIGHT_NAMES)}, or your light map (.hdr or .exr), twice as wide as high, "
        "with its middle behind the head; wrinkles=0..1, their depth.",
    )

    @property
    def light_file(self) -> Path | None:
        """The user's light map; None for a built-in light. Raises UserError for unknown words."""
        light = style_in(self.style_settings)["light"]
        return light if isinstance(light, Path) else None

    @property
    def opened_files(self) -> list[tuple[Path, ...]]:
        """The user's files, grouped as they are opened: a head with its landmarks, a light map."""
        groups = [self.files] if self.files else []
        if self.light_file is not None:
            groups.append((self.light_file,))
        return groups

    @property
    def style_options(self) -> dict[str, Any]:
        """The settings of --style by name; a light map is named by its absolute path.

        Raises UserError for unknown words, and for a file that is not a light map.
        """
        settings = style_in(self.style_settings)
        path = self.light_file
        if path is None:
            return settings
        from ..light_maps import check_light_map

        check_light_map(path)
        return settings | {"light": str(path.absolute())}

    @property
    def is_given(self) -> bool:
        """Whether the command line sets an option of refinement, style or anatomy."""
        source = click.get_current_context().get_parameter_source
        names = ("look", "refiner", "refiner_settings", "style_settings", "anatomy")
        return any(source(name) is not ParameterSource.DEFAULT for name in names)

    def style(self) -> render.Style:
        """Return the style that these options set; raise UserError for unknown words."""
        from risorius import render

        from ..light_maps import scene_light

        wanted = self.style_options
        skin = wanted["skin"]
        return render.Style(
            wireframe=wanted["wireframe"],
            colour_by=render.ColourBy.from_switches(splits=wanted["splits"], wires=wanted["wires"]),
            textured=skin == "textured",
            albedo=render.CLAY if skin == "clay" else render.SKIN,
            bumps=wanted["wrinkles"],
            light=scene_light(wanted["light"]).light,
        )

    def anatomy_view(self) -> AnatomyView:
        """Return the structures visible through the skin; raise UserError for unknown words."""
        from ..anatomy import SKIN_ALONE, SKIN_OPACITY, AnatomyView

        if self.anatomy is None:
            return SKIN_ALONE
        structures, opacity, side = anatomy_in(self.anatomy)
        return AnatomyView(structures, SKIN_OPACITY if opacity is None else opacity, side)


GAIN_OPTION = click.option(
    "--gain",
    "gains",
    multiple=True,
    metavar="NAME=x",
    help="Multiply the values of a channel by x. NAME is a channel, a pattern (mouth*, *Left), or "
    "all.",
)
MIRROR_OPTION = click.option("--mirror", is_flag=True, help="Swap left and right.")
PLAYBACK_OPTIONS = (
    click.option(
        "--neutral",
        metavar="HOW",
        help="The face at rest, which is subtracted: first:1 (median of the first second), "
        "percentile (the 5th of each channel) or none. The default depends on the kind of file.",
    ),
    GAIN_OPTION,
    MIRROR_OPTION,
    click.option(
        "--lead",
        type=FiniteRange(0, 0.5),
        default=LEAD_TIME,
        show_default=True,
        help="Time [s] by which muscles move ahead of the recording, because skin follows late.",
    ),
    click.option("--face", metavar="ID", help="The face to read, if the file has several."),
    click.option(
        "--rate", type=FiniteRange(1, 1000), help="Frames per second, in place of the file's times."
    ),
)
with_playback = packed("playback", Playback, PLAYBACK_OPTIONS)


def _print_report(report: Report) -> None:
    """Print the report of a recording on the error stream."""
    for line in report.lines:
        click.echo(line, err=True)


def played(
    script: Path | None,
    scene: str | None,
    playback: Playback | None = None,
    *,
    settings: tuple[str, ...] = (),
    sound: Path | None = None,
    quiet: bool,
) -> Script:
    """Return the script to play, with its sound; print a recording's report unless `quiet`."""
    from ..performances import script_for
    from ..sound.decoding import with_sound

    on_report = None if quiet else _print_report
    performance = script_for(script, scene, settings, playback=playback, on_report=on_report)
    return with_sound(performance, sound)


def printing(name: str, package: str, file: str, what: str) -> CommandFunction:
    """Return an option that prints a file of a package and ends the program.

    what: help text of the option.
    """

    def show(context: click.Context, _: click.Parameter, asked: bool) -> None:
        """Print the file, if the option is given."""
        if asked:
            click.echo((files(package) / file).read_text("utf-8"), nl=False)
            context.exit()

    return click.option(
        name, is_flag=True, is_eager=True, expose_value=False, callback=show, help=what
    )
