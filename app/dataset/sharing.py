"""Make batches of samples: one process makes each batch, on this computer or a Dask worker.

A worker that can reach the folder of the set writes into it. Other workers make samples in a
temporary folder, and send the bytes back.
"""

from __future__ import annotations

import contextlib
import secrets
import socket
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from importlib.metadata import version
from pathlib import Path

from ..cluster import run_on_cluster
from ..errors import UserError
from ..files import cannot_be_written
from ..workers import Send, WorkerPool
from .folder import TOKEN_PREFIX, UNFINISHED_SUFFIX, SetFolder
from .request import SetRequest
from .studio import Studio


@dataclass(frozen=True)
class SampleBatch:
    """The samples that one process makes.

    numbers: numbers of the samples, sorted by person.
    token: name of a file in the folder of unfinished samples; "" on the same computer. A process on
        another computer that finds this file can reach the folder of the set.
    """

    request: SetRequest
    numbers: tuple[int, ...]
    token: str = ""


@dataclass(frozen=True)
class MadeSample:
    """A finished sample.

    size: size of its files [bytes]. files: name -> content, if files are sent back; else empty.
    """

    number: int
    size: int = 0
    files: Mapping[str, bytes] = field(default_factory=dict)


def make_samples(batch: SampleBatch, send: Send) -> None:
    """Make the missing samples of a batch, and pass a `MadeSample` to `send` after each sample."""
    request = batch.request
    here = version("risorius")
    if request.version != here:
        raise UserError(
            f"{socket.gethostname()} has Risorius {here}, the set needs {request.version}; install "
            "the same on all computers"
        )
    with contextlib.ExitStack() as stack:
        folder = SetFolder(request.output)
        is_seen = not batch.token or (folder.path / UNFINISHED_SUFFIX / batch.token).exists()
        if not is_seen:
            own = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="risorius-")))
            (own / UNFINISHED_SUFFIX).mkdir()
            folder = SetFolder(own)
        studio = Studio(request)
        for number in batch.numbers:
            size = 0
            if not folder.has(number):  # an earlier process may have made it and died
                size = folder.write_sample(number, studio.shoot(number).save)
            send(MadeSample(number, size, {} if is_seen else _read_and_remove(folder, number)))


def _read_and_remove(folder: SetFolder, number: int) -> dict[str, bytes]:
    """Read and remove a sample's files; return name -> content."""
    files = {path: path.read_bytes() for path in folder.files_of(number)}
    for path in files:
        path.unlink()
    return {path.name: content for path, content in files.items()}


def make_on_cluster(
    folder: SetFolder, batches: Sequence[SampleBatch], scheduler: str
) -> Iterator[MadeSample]:
    """Let a Dask cluster make samples, and yield them; the first failure raises UserError."""
    if not batches:
        return
    token = f"{TOKEN_PREFIX}{secrets.token_hex(8)}"
    with cannot_be_written(folder.path):
        (folder.path / UNFINISHED_SUFFIX / token).touch()
    sent = [replace(batch, token=token) for batch in batches]
    results = run_on_cluster(_make_on_worker, sent, scheduler)
    with contextlib.closing(results):
        for _, result, why in results:
            if result is None or isinstance(result, str):
                raise UserError(result or f"the cluster gave up: {why}")
            yield from result


def _make_on_worker(pool: WorkerPool, batch: SampleBatch) -> list[MadeSample] | str:
    """Make a batch in a process of a Dask worker; return the samples, or the text of an error."""
    made: dict[int, MadeSample] = {}  # a process that died may have sent some of them already

    def collect(sample: MadeSample) -> None:
        made[sample.number] = sample

    try:
        pool.run(make_samples, batch, on_message=collect)
    except UserError as error:
        return f"{socket.gethostname()}: {error}"
    return [*made.values()]
