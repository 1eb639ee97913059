"""The sub-commands of `risorius`.

Modules that need OpenGL or compiled code are imported inside the commands, so that --help is fast.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING

import click
from click.core import ParameterSource

from ..errors import UserError
from ..live.protocols import LOOPBACK_ADDRESS, PROTOCOLS, Listening
from ..playback import Playback
from ..text import counted, in_one_line
from .batch import batch
from .capture import capture, demo
from .dataset import dataset
from .export import export
from .help import GroupedCommand
from .options import (
    GAIN_OPTION,
    MIRROR_OPTION,
    QUIET_OPTION,
    SCENE_NAMES,
    SOUND_OPTION,
    DrawingOptions,
    option,
    packed,
    played,
    with_playback,
)
from .rig import rig
from .value_types import PATH_TYPE, Size

if TYPE_CHECKING:
    from risorius.assets.fitting import FittedHead

    from ..script import Script


@dataclass(frozen=True)
class Live:
    """Options of a window that follows a face over the network."""

    live: str | None = option(
        type=click.Choice(list(PROTOCOLS)),
        help="Follow a face that arrives over the network by this protocol.",
    )
    port: int | None = option(
        type=click.IntRange(1, 65535), help="Port to listen on; by default the protocol's own."
    )
    address: str = option(
        default=LOOPBACK_ADDRESS,
        show_default=True,
        help="Address of this computer to listen on. 0.0.0.0 listens on all its networks.",
    )

    def listening(self, gains: tuple[str, ...], mirror: bool) -> Listening | None:
        """Return the address and protocol of a live face, or None without --live.

        gains: factors of channels, as "NAME=x". mirror: whether to swap left and right. Raises
        UserError if another option needs --live.
        """
        if self.live is None:
            source = click.get_current_context().get_parameter_source
            for name in ("port", "address"):
                if source(name) is not ParameterSource.DEFAULT:
                    raise UserError(f"--{name} needs --live; add --live with a protocol")
            if gains or mirror:
                option = "--gain" if gains else "--mirror"
                raise UserError(
                    f"{option} needs --live; for a recording give it to `risorius convert`"
                )
            return None
        PROTOCOLS[self.live].check()
        return Listening(self.live, self.address, self.port, gains, mirror)


@click.command(cls=GroupedCommand)
@click.option("--size", type=Size(), help="Size of the window; by default its last size.")
@click.option("--scene", type=SCENE_NAMES, help="The scene to animate; by default the face.")
@click.option("--script", type=PATH_TYPE, help="The script or recording that the space key plays.")
@SOUND_OPTION
@QUIET_OPTION
@packed("live", Live)
@GAIN_OPTION
@MIRROR_OPTION
@packed("drawing", DrawingOptions)
def view(
    size: tuple[int, int] | None,
    scene: str | None,
    script: Path | None,
    sound: Path | None,
    live: Live,
    gains: tuple[str, ...],
    mirror: bool,
    quiet: bool,
    drawing: DrawingOptions,
) -> None:
    """Open the window: a face with a slider for every muscle.

    If --head is a mesh without --landmarks, you mark its landmarks in the window. A head of
    MakeHuman or ICT-FaceKit needs none. With --live the face copies a face that a phone or
    `risorius send` sends; --gain and --mirror change its values.
    """
    listening = live.listening(gains, mirror)
    mesh = None
    if isinstance(drawing.head, Path):
        mesh = drawing.head
    is_plain = (script, scene, sound) == (None, None, None)
    performance = None if is_plain else played(script, scene, sound=sound, quiet=quiet)
    open_window(performance, size, drawing, listening=listening, mesh=mesh)


@click.command()
@click.argument("recording", type=PATH_TYPE, required=False)
@click.option(
    "--port", type=click.IntRange(1, 65535), help="Port to send to; by default the protocol's own."
)
@click.option(
    "--address",
    default=LOOPBACK_ADDRESS,
    show_default=True,
    help="Address of the receiving computer.",
)
@click.option("--loop", is_flag=True, help="Repeat until Ctrl-C.")
def send(recording: Path | None, port: int | None, address: str, loop: bool) -> None:
    """Send RECORDING over the network, as the app Live Link Face does.

    `risorius view --live livelink` receives it. Without RECORDING a short built-in one is sent.
    """
    from ..live.sender import Sender
    from ..recordings.reading import read_take

    if recording is None:  # `risorius export` made it of scripts/speech.toml
        recording = Path(str(files("risorius.assets") / "data" / "speech.csv"))
    take = read_take(recording)
    with Sender(address, port, recording.stem) as sender:
        click.echo(
            f"{in_one_line(recording)}: {take.kind}, {take.duration:.2f} s, to {address}, port "
            f"{sender.port}; Ctrl-C ends it"
        )
        sender.play(take, is_looping=loop)


@click.command(cls=GroupedCommand)
@click.argument("script", type=PATH_TYPE)
@click.option("--size", type=Size(), help="Size of the window; by default its last size.")
@click.option("--once", is_flag=True, help="Close the window at the end of the script.")
@SOUND_OPTION
@QUIET_OPTION
@packed("drawing", DrawingOptions)
def replay(
    script: Path,
    size: tuple[int, int] | None,
    once: bool,
    sound: Path | None,
    quiet: bool,
    drawing: DrawingOptions,
) -> None:
    """Play SCRIPT, or a recording of a face, in the window."""
    performance = played(script, None, sound=sound, quiet=quiet)
    open_window(performance, size, drawing, playing=True, once=once)


@click.command()
@click.argument("recording", type=PATH_TYPE)
@click.option("-o", "--output", type=PATH_TYPE, required=True, help="The script: script.toml.")
@click.option("--overwrite", is_flag=True, help="Replace an existing script.")
@QUIET_OPTION
@with_playback
def convert(
    recording: Path, output: Path, overwrite: bool, quiet: bool, playback: Playback
) -> None:
    """Turn the RECORDING of a face into a script.

    RECORDING is a file of Live Link Face, OpenFace, py-feat, MediaPipe or another tracker.
    """
    from ..files import check_apart, check_file
    from ..script.script_file import save_script

    check_apart((output,), (recording,))
    check_file(output)
    if output.suffix.lower() != ".toml":
        raise UserError(f"{output}: scripts are written as .toml; choose a name that ends so")
    if output.exists() and not overwrite:  # a user may have edited it
        raise UserError(f"{output}: exists already; choose another name, or add --overwrite")
    script = played(recording, None, playback, quiet=quiet)
    if not script.is_converted:
        raise UserError(f"{recording}: is a script already")
    save_script(output, script)
    if not quiet:
        keys = sum(len(channel) for channel in script.tracks.values())
        tracks = counted(len(script.tracks), "track")
        content = f"{tracks} with {counted(keys, 'key')}" if keys else "a pose"
        click.echo(f"{in_one_line(output)}: {content}")


def open_window(
    performance: Script | None,
    size: tuple[int, int] | None,
    drawing: DrawingOptions,
    *,
    playing: bool = False,
    once: bool = False,
    listening: Listening | None = None,
    mesh: Path | None = None,
) -> None:
    """Open the viewer on a script's scene, or on a mesh whose landmarks must be marked.

    performance: None for a new script of the face at rest.
    """
    from ..performances import new_script
    from ..viewer.settings import settings_path
    from ..viewer.window.splash_screen import SplashScreen

    def load() -> tuple[Script, FittedHead | None, str]:
        """Load the head and modules, which takes long."""
        script = performance or new_script()
        head, complaint = fitted_head_of(drawing, may_be_marked=mesh is not None)
        import risorius.app.viewer.window.window  # noqa: F401

        return script, head, complaint

    if listening is not None and performance is not None:
        from ..viewer.session.live_commands import check_scene

        check_scene(performance.scene)
    drawn = None
    if drawing.is_given:
        drawn = drawing.refinement(), drawing.anatomy_view(), drawing.style_options
        drawn[0].check("face" if performance is None else performance.scene)
    drawing.check_head()
    path = settings_path()
    with SplashScreen(size, path) as splash:
        script, head, complaint = splash.run(load)
        for opened in drawing.opened_files:
            splash.settings.note_recent(*opened)
        from ..viewer import Viewer
        from ..viewer.settings import display_of

        display = None  # as in the last window
        if drawn is not None:
            refinement, anatomy, style = drawn
            display = display_of(refinement, script.scene, anatomy, **style)
        viewer = Viewer(script, size, display, head=head, settings_path=path, splash=splash)
        with viewer:
            if listening is not None:
                line = viewer.context.live.start(listening)
                if line and not viewer.messages.text:  # an error stays on screen
                    viewer.messages.show(line)
            if mesh is not None and head is None:
                viewer.read(mesh, drawing.landmarks)()
                if complaint:
                    viewer.messages.show(complaint, stays=True)
            viewer.run(playing=playing, once=once)


def fitted_head_of(
    drawing: DrawingOptions, *, may_be_marked: bool
) -> tuple[FittedHead | None, str]:
    """Return the head that the options choose, and a message if its known landmarks do not fit.

    The head is None for the built-in head, and for a head whose landmarks may still be marked.
    """
    from risorius.assets.fitting.landmark_file import MisfitError, UnfinishedError

    try:
        return drawing.fitted_head(), ""
    except UnfinishedError as error:
        if not may_be_marked:
            raise
        return None, str(error) if isinstance(error, MisfitError) else ""


@click.command()
@click.option(
    "--scene",
    type=SCENE_NAMES,
    default="face",
    show_default=True,
    help="The scene whose controls are listed.",
)
def controls(scene: str) -> None:
    """List the names of all controls that a script may use.

    Controls are muscles, action units, expressions, visemes and ARKit's shapes.
    """
    from ..scenes import controls_of

    listed = controls_of(scene)
    for title, names in listed.groups.items():
        click.echo(title)
        for name in names:
            low, high = listed.limits[name]
            action = listed.actions.get(name, "")
            click.echo(f"  {name}  {low:g}..{high:g}  {action}".rstrip())


@click.command()
@click.option("--offscreen", is_flag=True, help="Examine only offscreen OpenGL.")
@click.option("--quiet", is_flag=True, help="Print nothing; only set the exit code.")
def doctor(offscreen: bool, quiet: bool) -> None:
    """Report which commands work here, and how to enable the others.

    The exit code is 0 if all commands work, 1 if some work, 2 if nothing can be drawn.
    """
    from .doctor import examine

    health, lines = examine(offscreen_only=offscreen)
    if not quiet:
        for line in lines:
            click.echo(line)
    sys.exit(int(health))


ALL_COMMANDS = (
    capture,
    export,
    rig,
    batch,
    dataset,
    view,
    replay,
    convert,
    send,
    demo,
    controls,
    doctor,
)
