"""`risorius batch`: many commands, in parallel."""

from __future__ import annotations

import contextlib
import io
import sys
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import click

from ..batch.listing import Job, clashes, lines_of, words_of
from ..errors import UserError
from ..files import cannot_be_written, check_apart, check_folder
from ..stopping import cleaned_up_if_stopped
from ..text import counted, in_one_line
from .options import SILENT_OPTION
from .value_types import PATH_TYPE

LISTED_COMMANDS = ("capture", "export", "convert")  # commands that a line may hold
OUTPUT_PARAMETERS = ("output", "sheet")  # names of their parameters for output files


@click.command()
@click.argument("listing", metavar="LIST", type=PATH_TYPE)
@click.option(
    "--jobs",
    type=click.IntRange(1, 1024),
    help="Number of lines to run at once; by default one for each core.",
)
@click.option(
    "--scheduler",
    metavar="ADDRESS",
    help="Address of a Dask cluster that does the work: tcp://host:8786.",
)
@click.option(
    "--resume",
    is_flag=True,
    help="Skip lines whose outputs exist and are not older than their inputs.",
)
@click.option(
    "--logs",
    type=PATH_TYPE,
    help="Folder for the logs of the lines; by default LIST_logs beside LIST.",
)
@SILENT_OPTION
def batch(
    listing: Path,
    jobs: int | None,
    scheduler: str | None,
    resume: bool,
    logs: Path | None,
    quiet: bool,
) -> None:
    """Run a list of commands in parallel.

    LIST is a text file. Each line is a capture, export or convert command without the word
    risorius; lines that begin with # are ignored. Paths are relative to the current folder. All
    lines are checked before the first one runs.
    """
    from tqdm import tqdm

    from ..batch.running import FAILED_STATE, in_words, run_lines, save_summary
    from ..workers import share_of_cores

    if jobs is not None and scheduler is not None:
        raise UserError(
            "--jobs and --scheduler exclude each other: the cluster has its own workers"
        )
    start = time.monotonic()
    logs = (logs or listing.parent / f"{listing.stem}_logs").absolute()
    listed = jobs_in(listing, logs, resume=resume)
    with cannot_be_written(logs):
        logs.mkdir(parents=True, exist_ok=True)
    results = []
    processes = jobs or share_of_cores()
    lines = run_lines(listed, processes=processes, scheduler=scheduler, resume=resume)
    with tqdm(total=len(listed), unit="line", disable=quiet or None) as bar:
        with cleaned_up_if_stopped(bar.close):
            for result in lines:
                results.append(result)
                bar.update()
                if result.status == FAILED_STATE:
                    bar.write(
                        f"risorius: {in_one_line(listing)}:{result.job.number}: {result.error}",
                        file=sys.stderr,
                    )
    click.echo(in_words(results, time.monotonic() - start))
    summary = logs / "summary.csv"
    save_summary(summary, results)
    click.echo(in_one_line(summary))
    if any(result.status == FAILED_STATE for result in results):
        sys.exit(1)


def jobs_in(listing: Path, logs: Path, *, resume: bool) -> list[Job]:
    """Return the jobs of a list; report wrong lines, and end the program if there are any."""
    jobs = []
    wrong = []
    for number, text in lines_of(listing):
        try:
            jobs.append(_job(number, text, logs, resume=resume))
        except (UserError, click.ClickException) as error:
            message = error.format_message() if isinstance(error, click.ClickException) else error
            wrong.append((number, " ".join(str(message).split()).rstrip(".")))
    wrong += clashes(jobs)
    most = 20  # errors that are reported one by one
    for number, why in sorted(wrong)[:most]:
        click.echo(f"risorius: {in_one_line(f'{listing}:{number}: {why}')}", err=True)
    if len(wrong) > most:
        more = counted(len(wrong) - most, "more wrong line")
        click.echo(f"risorius: {in_one_line(listing)}: {more}", err=True)
    if wrong:
        sys.exit(2)
    if not jobs:
        raise UserError(f"{listing}: has no command")
    return jobs


def _job(number: int, text: str, logs: Path, *, resume: bool) -> Job:
    """Return the job of a line. Raises UserError, or click's errors, for an impossible line."""
    name, *arguments = words_of(text)
    command = _listed(name)
    given = _parsed(command, arguments)
    outputs = [given[key] for key in OUTPUT_PARAMETERS if given.get(key) is not None]
    inputs = [
        value
        for key, value in given.items()
        if isinstance(value, Path) and key not in OUTPUT_PARAMETERS
    ]
    _check_files(name, given, inputs, outputs)
    if given.get("overwrite") is False and (resume or not outputs[0].suffix):
        if not resume:
            check_folder(outputs[0], overwrite=False)
        arguments.insert(0, "--overwrite")  # existing files are from an earlier attempt
    assert command.callback is not None
    return Job(
        number=number,
        text=text,
        command=f"{command.callback.__module__}:{command.callback.__name__}",
        arguments=tuple(arguments),
        folder=Path.cwd(),
        inputs=tuple(path.absolute() for path in inputs),
        outputs=tuple(path.absolute() for path in outputs),
        log=logs / f"line_{number:04d}.log",
    )


def _listed(name: str) -> click.Command:
    """Return the command of this name; raise UserError if a list may not hold it."""
    if name not in LISTED_COMMANDS:
        raise UserError(
            f"'{name}' is not a command of a list; allowed are {', '.join(LISTED_COMMANDS)}"
        )
    parent = click.get_current_context().parent
    assert parent is not None and isinstance(parent.command, click.Group)
    return parent.command.commands[name]


def _parsed(command: click.Command, arguments: Sequence[str]) -> dict[str, Any]:
    """Parse arguments with click; return the values by the names of parameters."""
    with contextlib.redirect_stdout(io.StringIO()):  # output of --help
        try:
            return command.make_context(f"risorius {command.name}", list(arguments)).params
        except click.exceptions.Exit:
            raise UserError("the command prints and writes no file; remove the line") from None


def _check_files(
    name: str, given: dict[str, Any], inputs: Sequence[Path], outputs: Sequence[Path]
) -> None:
    """Raise UserError for inputs that do not exist, and for outputs that cannot be written."""
    if not outputs:
        raise UserError("the command writes no file; add -o OUTPUT")
    for path in inputs:
        if not path.exists():
            raise UserError(f"{path}: there is no such file")
    check_apart(outputs, inputs)
    if name == "capture" and given["output"] is not None:
        from ..capture.outputs import check_name

        check_name(given["output"])
