"""Pack samples into shards; a shard is written when all its samples exist."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

from ..files import cannot_be_written
from .folder import SetFolder
from .shards import SHARD_PATTERN, Shard, files_in, read_shard, remove_shard, write_shard


class Packing:
    """The shards of a data set."""

    def __init__(self, folder: SetFolder, size: int, numbers: range) -> None:
        """size: number of samples in a shard; shard k begins with sample k * size.

        numbers: numbers of all samples in the set.
        """
        self._folder = folder
        self._size = size
        self._numbers = numbers
        self._packed: dict[int, Shard] = {}
        self._waiting: dict[int, set[int]] = {}

    def begin(self) -> None:
        """Keep complete shards; unpack the readable samples of all others.

        If a set is to become longer, its last shard is also unpacked.
        """
        with cannot_be_written(self._folder.path):
            for path in sorted(self._folder.path.glob(SHARD_PATTERN)):
                place = int(path.stem.removeprefix("shard-"))
                shard = read_shard(path)
                if shard is not None and sorted(shard.places) == self._wanted(place):
                    self._packed[place] = shard
                    continue
                for name, content in files_in(path):
                    (self._folder.path / name).write_bytes(content)
                remove_shard(path)
            self._remove_leftovers()

    def has(self, number: int) -> bool:
        """Whether a sample is in a shard."""
        return number // self._size in self._packed

    def expect(self, missing: Iterable[int]) -> None:
        """Note the samples that will be made, and pack all shards that need none of them."""
        shard_indices = {number // self._size for number in self._numbers}
        self._waiting = {place: set() for place in shard_indices - self._packed.keys()}
        for number in missing:
            self._waiting[number // self._size].add(number)
        for place in sorted(self._waiting):
            self._pack_if_complete(place)

    def add(self, number: int) -> None:
        """Note a finished sample; if it was the last of its shard, pack the shard."""
        place = number // self._size
        self._waiting[place].discard(number)
        self._pack_if_complete(place)

    def labels_and_place(self, number: int) -> tuple[dict[str, Any], dict[str, str | int]]:
        """Return the labels of a sample, and its position in its shard."""
        shard = self._packed[number // self._size]
        return shard.labels_of(number), shard.place_of(number)

    def _wanted(self, place: int) -> Sequence[int]:
        first = place * self._size
        last = min(first + self._size, self._numbers.stop)
        return list(range(max(first, self._numbers.start), last))

    def _pack_if_complete(self, place: int) -> None:
        if place in self._packed or self._waiting[place]:
            return
        wanted = self._wanted(place)
        files = {number: self._folder.files_of(number) for number in wanted}
        path = self._folder.path / f"shard-{place:06d}.tar"
        self._packed[place] = write_shard(path, files.items())
        with cannot_be_written(path):
            for each in files.values():
                _remove(each)

    def _remove_leftovers(self) -> None:
        """Remove files of packed samples that an interrupted process has left."""
        with os.scandir(self._folder.path) as items:
            found = [re.fullmatch(r"(\d{6})[._].+", item.name) for item in items]
        packed = [each[0] for each in found if each and self.has(int(each[1]))]
        _remove(self._folder.path / name for name in packed)


def _remove(files: Iterable[Path]) -> None:
    for file in files:
        file.unlink(missing_ok=True)
