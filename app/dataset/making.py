"""Making a set: samples in processes, one person after the other, then what is told of them all."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from tqdm import tqdm

from ..errors import UserError
from ..files import save_text, written_atomically
from ..process_cache import cached
from ..stopping import cleaned_up_if_stopped
from ..workers import run_all
from .folder import SetFolder
from .persons import check_head
from .request import Request
from .sampling import draw
from .studio import Studio
from .summary import card_of, write_index

BATCH = 8  # samples that a process is given at once, all of one person


@dataclass(frozen=True)
class Batch:
    """Samples that a process is to make."""

    request: Request
    person: int
    indices: tuple[int, ...]


@dataclass(frozen=True)
class Made:
    """What became of a set: how many samples it has, how many of them are new, and their bytes."""

    samples: int
    new: int
    size: int


def make_set(
    request: Request,
    count: int,
    *,
    jobs: int,
    resume: bool = False,
    progress: bool = True,
) -> Made:
    """Make the samples 0 to count - 1 of a set, as far as they are not there, and its card.

    Raises UserError where the set cannot be made, or was begun otherwise; samples that were made
    until then stay.
    """
    folder = SetFolder(request.output)
    with folder.held(request.options(), resume=resume):
        there = {index for index in folder.there() if index >= count or folder.has(index)}
        if there and max(there) >= count:
            raise UserError(
                f"{request.output}: has sample {max(there)} already; give --count {max(there) + 1} "
                "or more"
            )
        batches = _batches(request, [index for index in range(count) if index not in there])
        is_silent = not progress or None
        if request.heads:
            heads = dict.fromkeys(request.heads[batch.person] for batch in batches)
            _check_heads([*heads], folder, jobs, is_silent)
        size = 0
        bar = tqdm(total=count, initial=len(there), unit="sample", disable=is_silent, leave=False)
        logs = [folder.log] * len(batches)
        with cleaned_up_if_stopped(bar.close), bar:
            for outcome in run_all(make_samples, batches, jobs=jobs, logs=logs):
                if outcome.error is not None:
                    raise UserError(f"{outcome.error} (with --resume the set goes on)")
                size += outcome.result
                bar.update(len(outcome.item.indices))
        _finish(folder, request, count)
    return Made(count, count - len(there), size)


def _check_heads(
    heads: Sequence[Path], folder: SetFolder, jobs: int, is_silent: bool | None
) -> None:
    """UserError, before the first sample, that names all heads which cannot be fitted.

    Found later, one would spoil the set: it is resumed with the same heads alone.
    """
    broken = []
    logs = [folder.log] * len(heads)
    bar = tqdm(total=len(heads), unit="head", disable=is_silent, leave=False)
    with cleaned_up_if_stopped(bar.close), bar:
        for outcome in run_all(check_head, heads, jobs=jobs, logs=logs):
            if outcome.error is not None:
                broken.append(outcome.error)
            bar.update()
    if broken:
        raise UserError("; ".join(sorted(broken)))


def make_samples(batch: Batch) -> int:
    """Make the samples of a batch that are not there; how many bytes they have."""
    request = batch.request
    studio = cached("studio of a data set", request.output, lambda: Studio(request))
    folder = SetFolder(request.output)
    size = 0
    for index in batch.indices:
        if not folder.has(index):  # a process before may have died behind it
            size += folder.write_sample(index, studio.shoot(index).save)
    return size


def _batches(request: Request, missing: Sequence[int]) -> list[Batch]:
    """The samples of one person together, for a head takes seconds to build."""
    by_person: dict[int, list[int]] = {}
    for index in missing:
        by_person.setdefault(draw(request.table, request.seed, index).person, []).append(index)
    return [
        Batch(request, person, tuple(indices[first : first + BATCH]))
        for person, indices in sorted(by_person.items())
        for first in range(0, len(indices), BATCH)
    ]


def _finish(folder: SetFolder, request: Request, count: int) -> None:
    """Write index and card from the samples' files."""
    index = folder.path / "index.csv"
    with written_atomically(index) as part:
        counts = write_index(part, map(folder.sample, range(count)))
    save_text(folder.path / "README.md", card_of(request, counts))
