"""Make a data set: first its samples, in parallel processes, then the index and the card."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from tqdm import tqdm

from ..errors import UserError
from ..files import save_text, written_atomically
from ..stopping import cleaned_up_if_stopped
from ..workers import run_all
from .folder import SetFolder
from .packing import Packing
from .request import SetRequest
from .sampling import draw
from .sharing import MadeSample, SampleBatch, make_on_cluster, make_samples
from .summary import card_of, write_index


@dataclass(frozen=True)
class Made:
    """A finished set.

    samples: number of samples. new: number of new samples. size: size of new samples [bytes].
    """

    samples: int
    new: int
    size: int


def make_set(
    request: SetRequest,
    count: int,
    *,
    first: int = 0,
    jobs: int = 1,
    scheduler: str | None = None,
    resume: bool = False,
    progress: bool = True,
) -> Made:
    """Make the missing or incomplete samples among `count` samples from number `first` on.

    jobs: number of local processes. scheduler: address of a Dask cluster that makes the samples
    instead. resume: whether the folder may already hold samples of this set. Raises UserError if
    the set cannot be made, or was begun with other options; finished samples stay.
    """
    folder = SetFolder(request.output)
    numbers = range(first, first + count)
    with folder.opened(request.options(), resume=resume):
        _check(folder, numbers)
        packing = Packing(folder, request.shards, numbers) if request.shards else None
        unpacked = list(numbers)
        if packing:
            packing.begin()
            unpacked = [number for number in numbers if not packing.has(number)]
        missing = [number for number in unpacked if not folder.has(number)]
        if packing:
            packing.expect(missing)
        if scheduler is None:
            batches = _batches(request, missing, -(-len(missing) // jobs))
            arriving = run_all(make_samples, batches, log=folder.log)
        else:
            # A lost batch loses all its samples, but each batch takes two seconds to start.
            each = min(max(len(missing) // 64, 8), 64)
            arriving = make_on_cluster(folder, _batches(request, missing, each), scheduler)
        size = 0
        is_silent = not progress or None
        made = count - len(missing)
        bar = tqdm(total=count, initial=made, unit="sample", disable=is_silent, leave=False)
        with cleaned_up_if_stopped(bar.close), bar:
            for number, bytes_of_sample in _with_advice(_store_samples(folder, missing, arriving)):
                size += bytes_of_sample
                if packing:
                    packing.add(number)
                bar.update()
        _finish(folder, request, numbers, packing)
    return Made(count, len(missing), size)


def _check(folder: SetFolder, numbers: range) -> None:
    """Raise UserError if a folder already has samples with other numbers."""
    there = folder.numbers()
    if there <= set(numbers):
        return
    first = min(*there, numbers.start)
    last = max(*there, numbers.stop - 1)
    with_first = f"--first {first} and " if first or numbers.start else ""
    raise UserError(
        f"{folder.path}: has sample {max(there - set(numbers))} already; give {with_first}"
        f"--count {last + 1 - first} or more"
    )


def _batches(request: SetRequest, missing: Sequence[int], each: int) -> list[SampleBatch]:
    """Divide missing samples into batches of `each` samples.

    Samples of one person stay together, because a head takes long to build. Samples of one shard
    also stay together.
    """

    def place(number: int) -> tuple[int, int]:
        shard = number // request.shards if request.shards else 0
        return shard, draw(request.table, request.seed, number).person

    ordered = sorted(missing, key=place)
    return [
        SampleBatch(request, tuple(ordered[first : first + each]))
        for first in range(0, len(ordered), max(each, 1))
    ]


def _store_samples(
    folder: SetFolder, missing: Iterable[int], arriving: Iterator[MadeSample]
) -> Iterator[tuple[int, int]]:
    """Yield number and size [bytes] of each missing sample, after its files are in place."""
    left = set(missing)
    for sample in arriving:
        if sample.number in left:  # a process that died may have sent it before
            left.remove(sample.number)
            has_files = bool(sample.files)
            size = folder.take_sample(sample.number, sample.files) if has_files else sample.size
            yield sample.number, size


def _with_advice(made: Iterator[tuple[int, int]]) -> Iterator[tuple[int, int]]:
    """Yield the samples of `made`; add a hint on --resume to errors."""
    try:
        yield from made
    except UserError as error:
        text = f"{error} (with --resume the set goes on)"
        raise UserError(text, error.trace) from None


def _finish(
    folder: SetFolder, request: SetRequest, numbers: range, packing: Packing | None
) -> None:
    """Write index and card from the samples' files."""

    def labels_and_place(number: int) -> tuple[dict[str, Any], Mapping[str, str | int]]:
        return packing.labels_and_place(number) if packing else (folder.sample(number), {})

    index = folder.path / "index.csv"
    with written_atomically(index) as part:
        counts = write_index(part, map(labels_and_place, numbers))
    save_text(folder.path / "README.md", card_of(request, numbers, counts))
