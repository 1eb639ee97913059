"""Making a set: samples in processes, person by person, then the index and the card of all."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from tqdm import tqdm

from ..errors import UserError
from ..files import save_text, written_atomically
from ..stopping import cleaned_up_if_stopped
from ..workers import Send, run_all
from .folder import SetFolder
from .request import SetRequest
from .sampling import draw
from .studio import Studio
from .summary import card_of, write_index


@dataclass(frozen=True)
class Share:
    """The samples that one process makes, by their numbers, person after person."""

    request: SetRequest
    indices: tuple[int, ...]


@dataclass(frozen=True)
class Made:
    """A made set: how many samples it has, how many of them are new, and their bytes."""

    samples: int
    new: int
    size: int


def make_set(
    request: SetRequest,
    count: int,
    *,
    jobs: int,
    resume: bool = False,
    progress: bool = True,
) -> Made:
    """Make the samples 0 to count - 1 of a set, as far as they are not whole, and its card.

    Raises UserError where the set cannot be made, or was begun otherwise; samples that were made
    until then stay.
    """
    folder = SetFolder(request.output)
    with folder.held(request.options(), resume=resume):
        last = max(folder.there(), default=-1)
        if last >= count:
            raise UserError(
                f"{request.output}: has sample {last} already; give --count {last + 1} or more"
            )
        missing = [index for index in range(count) if not folder.has(index)]
        made = count - len(missing)
        shares = _shares(request, missing, jobs)
        is_silent = not progress or None
        size = 0
        bar = tqdm(total=count, initial=made, unit="sample", disable=is_silent, leave=False)
        with cleaned_up_if_stopped(bar.close), bar:
            try:
                for bytes_of_sample in run_all(make_samples, shares, log=folder.log):
                    size += bytes_of_sample
                    bar.update()
            except UserError as error:
                text = f"{error} (with --resume the set goes on)"
                raise UserError(text, error.trace) from None
        _finish(folder, request, count)
    return Made(count, len(missing), size)


def make_samples(share: Share, send: Send) -> None:
    """Make the samples of a share that do not exist yet, and send the size of each [bytes]."""
    studio = Studio(share.request)
    folder = SetFolder(share.request.output)
    for index in share.indices:
        if not folder.has(index):  # a process before may have died behind it
            send(folder.write_sample(index, studio.shoot(index).save))


def _shares(request: SetRequest, missing: Sequence[int], jobs: int) -> list[Share]:
    """As many shares as processes, about equally large.

    The samples of one person are together, for a head takes seconds to build.
    """
    ordered = sorted(missing, key=lambda index: draw(request.table, request.seed, index).person)
    each = max(-(-len(ordered) // jobs), 1)
    return [
        Share(request, tuple(ordered[first : first + each]))
        for first in range(0, len(ordered), each)
    ]


def _finish(folder: SetFolder, request: SetRequest, count: int) -> None:
    """Write index and card from the samples' files."""
    index = folder.path / "index.csv"
    with written_atomically(index) as part:
        counts = write_index(part, map(folder.sample, range(count)))
    save_text(folder.path / "README.md", card_of(request, counts))
