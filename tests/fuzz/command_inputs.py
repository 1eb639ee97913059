"""Inputs of the command line: mistakes with the words of their messages, and hostile values.

Every option of every command gets each hostile value.
"""

import shlex
from collections.abc import Iterator

import click

from risorius.__main__ import command as risorius

CAPTURE = "capture good.toml -o x.png --size 16x16 --fps 5 --quiet"

ACCEPTED_COMMANDS = (
    "--help",
    "bench --help",
    "reproduce figure8",
    "reproduce figure10 -o new/folder",
    "reproduce all -o new/folder",
    "doctor --offscreen --quiet",
    "view --size 320x200",
    "replay good.toml --once",
    CAPTURE,
    f"{CAPTURE} --time 0.1 --camera 1e3,-1e3,1e-3",
    f"{CAPTURE} --style wrinkles=0,skin=clay --style splits,wireframe",
    f"{CAPTURE} --refiner loop --option levels=2",
    f"{CAPTURE} --look paper --compare smooth,none,loop",
    f"{CAPTURE} --option scheme=cubic --option blend=OFF",
    f"{CAPTURE} --option criterion=displacement+normal+rest --option scheme=cubic",
    f"{CAPTURE} --look paper --option threshold_once=1e-300 --option coherent=true",
    "capture good.toml -o full --overwrite --size 16x16 --fps 5 --quiet",
    "capture good.toml -o x.mp4 --size 16x16 --fps 5 --quiet",
    "capture good.toml --sheet new/x.png --size 16x16 --fps 5 --quiet",
    "capture --scene plane --set amplitude=1 -o x.png --size 16x16 --quiet",
)

REFUSED_COMMANDS = {
    # Unknown commands and options.
    "captur good.toml": "No such command 'captur'",
    "replay": "Missing argument 'SCRIPT'",
    "bench motion": "Missing option '--reference'",
    "bench reference folder -o x": "has no FaceXModel/generic_neutral_mesh.obj",
    # Numbers.
    f"{CAPTURE} --fps 0": "is not in the range",
    f"{CAPTURE} --fps fast": "'fast' is not a valid number",
    f"{CAPTURE} --fps 1/0": "'1/0' is not a valid number",
    f"{CAPTURE} --style wrinkles={'9' * 5000}": "write a number from 0 to 1",
    f"{CAPTURE} --style skin=red": "'red' is none of textured, plain, clay",
    f"{CAPTURE} --style shiny": "'shiny' is unknown; allowed are wireframe, splits, wires, skin=",
    f"{CAPTURE} --time 1:2": "a picture has one time",
    # Options that commands had before.
    f"{CAPTURE} --gain all=1": "--gain was removed: convert the recording first: risorius convert",
    f"{CAPTURE} --wireframe": "--wireframe was removed: write --style wireframe",
    f"{CAPTURE} --light side": "--light was removed: write --style light=VALUE",
    f"{CAPTURE} --style light=x.hdr": "x.hdr: no such light map",
    f"{CAPTURE} --style light=sunny": "'sunny' is none of studio, side, overcast, window, hard,",
    "view --light x.hdr": "--light was removed: write --style light=VALUE",
    "export good.toml -o x.glb --light side": "No such option",
    "dataset -o set --count 1 --light none": "--light none: no such file or folder",
    "view --person 3": "--person was removed: write --head NUMBER",
    "rig --person 7 -o seven.glb": "`risorius rig` takes it as HEAD",
    "replay good.toml --no-skin-maps": "--no-skin-maps was removed: pictures always have skin maps",
    "export good.toml -o x.npz --rate 30": "--rate was removed: convert the recording first",
    "view --mirror": "--mirror needs --live",
    "bench window --size 9x9": "each 16 to 8192",
    # Live faces.
    "view --live vmc --scene plane": "moves the scene 'face'",
    "send good.toml": "is neither a table nor JSON",
    # Cameras.
    f"{CAPTURE} --camera behind": "camera 'behind': allowed are",
    f"{CAPTURE} --camera 0,0,0": "zoom above 0",
    # Options of refiners (looks).
    f"{CAPTURE} --look Paper": "'Paper' is not one of 'smooth', 'paper'",
    f"{CAPTURE} --compare none,none": "would be compared with itself",
    f"{CAPTURE} --refiner magic": "refiner 'magic' is unknown; there are",
    f"{CAPTURE} --option ''": "write NAME=VALUE",
    f"{CAPTURE} --option scheme=1": "option scheme was 1, must be a word",
    f"{CAPTURE} --option scheme=loop": "the look smooth has criterion=displacement+rest",
    f"{CAPTURE} --option threshold_once=nan": "not a finite number",
    f"{CAPTURE} --option threshold_once=0.01": "is an option of the criterion normal",
    f"{CAPTURE} --option uv=1": "unknown option uv; it takes",
    f"{CAPTURE} --option coherent=on --option blend=on": "coherent",
    f"{CAPTURE} --refiner loop --option levels=0": "levels",
    f"{CAPTURE} --compare --refiner none": "other than none",
    # Options that exclude each other.
    "capture": "nothing to write",
    "capture good.toml -o x.mp4 --time 1": "for a film write --time FROM:TO",
    "capture good.toml --set joy -o x.png": "a script and --set exclude each other",
    "capture --head head.obj -o x.png": "needs a landmark file",
    "view --script nowhere.toml": "no such script",
    # Poses.
    "capture --set joy=nan -o x.png": "'nan' is not a number",
    "capture --set joy=2 -o x.png": "must be from 0 to 1",
    "capture --set Joy=1 -o x.png": "unknown name 'Joy'; did you mean joy",
    # Outputs.
    "capture good.toml -o x.avi": "unknown suffix '.avi'",
    "capture good.toml -o good.toml": "is both an input and an output",
    "capture good.toml -o full": "exists and is not empty",
    "capture good.toml -o folder.png": "is a folder",
    "capture good.toml --sheet x": "pictures are written as .png",
    "capture good.toml -o x.png --sheet x.png": "is the name of two outputs",
    "capture good.toml -o x.png --sound hum.wav": "only films with sound can hold it",
    "capture good.toml -o x.mp4 --sound notes.txt": "holds no sound",
    "capture good.toml -o pipe.png": "is a device",
    "capture good.toml -o /dev/full": "/dev/full",
    "capture good.toml -o loop.png": "loop.png",
    f"capture good.toml -o {'x' * 300}.png": "File name too long",
    "bench quality --expression nobody": "--expression nobody: there are joy, ",
    # Values refused by other parts of the program.
    "capture --compare good.toml -o x.mp4": "a SCRIPT goes before --compare",
    "capture good.toml -o x.mp4 --size ²x²": "'²x²' is not a size",
    "capture good.toml -o x.png --time 86400": "good.toml ends at",
    "capture --scene plane -o x.mp4 --background transparent": "a film cannot be transparent",
    "capture --background map -o x.png": "no map lights the scene; add --style light=FILE",
    "convert nothing.csv -o c.png": "c.png: scripts are written as .toml",
    "convert good.toml -o out.toml": "is a script already",
    # Persons.
    "capture --head nobody -o x.png": "'nobody' is not a head; give ada, kofi, maria, coarse, the",
    "rig Coarse -o x.glb": "'Coarse' is not a head; give ada",
    "capture --head 3 --landmarks marks.json -o x.png": "--head 3: its landmarks are known",
    "capture --head 3 --scene plane -o x.png": "--head needs the scene face",
    # Recordings.
    "convert take.csv -o out.toml --neutral last": "--neutral last: allowed are",
    "convert take.csv -o out.toml --gain mouth=1": "--gain mouth=1: no channel",
    "convert good.toml -o out.toml --gain all=2": "is a script, but --gain needs a recording",
    "send take.csv --address nobody.invalid": "address 'nobody.invalid'",
    # Passes and data sets.
    "capture good.toml --passes depth -o x.mp4": "--passes are files beside each picture: give -o ",
    "capture good.toml --passes depth --compare -o x.png": "--passes and --compare exclude each",
    "capture --scene plane --passes depth,landmarks -o x.png": "the scene plane has no face; ",
    "dataset --count 2 -o set --passes colour": "'colour' is not a pass",
    "dataset --count 2 -o set --background 'no such'": "neither a folder nor a colour",
    "dataset --count 2 -o set --background broken": "face.png: cannot be read as a picture",
    "dataset --count 2 -o set --sample nowhere.toml": "no such table",
    # Exports.
    "export good.toml -o x.pc2 --refined --changing": "allowed are usd, obj, vtkhdf",
    "export good.toml -o x.obj": "and folders with --as obj",
    "export good.toml -o x": "x: has no suffix. Allowed are .glb",
    "export good.toml -o x.usdc --as npz": "numpy arrays is written as .npz",
    # More options and outputs.
    f"{CAPTURE} --look paper --option threshold_once=0.2": "0 <= threshold_once <= threshold_twice",
    f"{CAPTURE} --refiner kahler-gl --option scheme=detail": "option scheme was detail, must be",
    f"{CAPTURE} --compare papre": "'papre' is neither a look (smooth, paper) nor a refiner (",
    "capture good.toml -o notes.txt/x.mp4": "cannot be written: Not a directory",
}

HOSTILE_VALUES = {
    "empty": "",
    "nan": "nan",
    "inf": "-inf",
    "long_number": "9" * 5000,
    "line_end": "a\nb",
    "no_unicode": "x\udcff",
    "format": "%s%n{}{0}",
    "long": "x" * 5000,
}

NEEDED_OPTIONS = {  # other options that a command needs before the tested option has an effect
    "capture": "good.toml -o x.png --size 16x16 --fps 5 --time 0 --quiet",
    "replay": "good.toml",
    "bench motion": "--reference folder",
    "bench reference": "folder -o made",
}
REPLACED_OPTIONS = {  # options in place of those above, where the tested option excludes one
    ("capture", "--set"): "-o x.png --size 16x16 --fps 5 --time 0 --quiet",
    ("capture", "--sound"): "good.toml -o x.mp4 --size 16x16 --fps 5 --quiet",
    ("capture", "--head"): f"{NEEDED_OPTIONS['capture']} --landmarks marks.json",
    ("capture", "--landmarks"): f"{NEEDED_OPTIONS['capture']} --head head.obj",
}


def hostile_values() -> Iterator[tuple[str, tuple[str, ...]]]:
    """Each hostile value for each option and argument that takes a value.

    Yields a name, and the words of the command.
    """
    for path, command in commands(risorius(), ()):
        words = " ".join(path)
        for option in command.params:
            is_option = isinstance(option, click.Option)
            if is_option and (option.is_flag or option.name == "help"):
                continue
            for name, value in HOSTILE_VALUES.items():
                if is_option:
                    given = REPLACED_OPTIONS.get(
                        (words, option.opts[-1]), NEEDED_OPTIONS.get(words, "")
                    )
                    arguments = (*path, *shlex.split(given), f"{option.opts[-1]}={value}")
                else:  # the argument replaces the first word
                    arguments = (
                        *path,
                        *shlex.split(NEEDED_OPTIONS.get(words, ""))[1:],
                        "--",
                        value,
                    )
                yield f"{'-'.join(path)}-{option.name}-{name}", arguments


def commands(
    command: click.Command, path: tuple[str, ...]
) -> Iterator[tuple[tuple[str, ...], click.Command]]:
    """Every command that is not a group, with the words that call it."""
    if isinstance(command, click.Group):
        for name, below in command.commands.items():
            yield from commands(below, (*path, name))
    else:
        yield path, command
