"""Sets in shards (tar files) and on a cluster: bytes equal those of one process."""

import csv
import io
import json
import os
import random
import re
import shutil
import subprocess
import sys
import tarfile
import textwrap
import threading
from dataclasses import replace
from pathlib import Path

import pytest

from risorius.app.dataset.folder import UNFINISHED_SUFFIX, SetFolder
from risorius.app.dataset.making import make_set
from risorius.app.dataset.packing import Packing
from risorius.app.dataset.request import SetRequest, request_of
from risorius.app.dataset.sampling import draw
from risorius.app.dataset.sharing import SampleBatch, make_on_cluster, make_samples
from risorius.app.dataset.table import load_table
from risorius.app.errors import UserError
from risorius.app.workers import run_all
from risorius.assets.identities import EVERYBODY, colours_of_number, person_called, sample_identity
from risorius.faces import UNITS, Faces

from .compiling_work import make_samples_and_name_kernels
from .test_dataset import content
from .without_workers import in_this_process

SAMPLE_COUNT = int(os.environ.get("SAMPLES", "5"))
SAMPLES_PER_SHARD = 2
KILL_COUNT = int(os.environ.get("KILLS", "3"))


def request_for(folder: Path, shards: int | None = None) -> SetRequest:
    """The request of a small set in a folder."""
    return request_of(folder, seed=4, size=(48, 40), passes=("segmentation",), shards=shards)


@pytest.fixture(scope="module")
def loose(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A set of single files."""
    folder = tmp_path_factory.mktemp("loose") / "set"
    with in_this_process():
        make_set(request_for(folder), SAMPLE_COUNT, progress=False)
    return folder


@pytest.fixture(scope="module")
def packed(loose: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The same samples in shards, with one sample in the last."""
    folder = tmp_path_factory.mktemp("packed") / "set"
    folder.mkdir()
    for file in loose.glob("0*"):
        shutil.copy(file, folder)
    request = request_for(folder, SAMPLES_PER_SHARD)
    (folder / "dataset.json").write_text(json.dumps(request.options(), indent=1) + "\n", "utf-8")
    made = make_set(request, SAMPLE_COUNT, resume=True, progress=False)
    assert made.new == 0
    return folder


def members(path):
    """The files in a tar file."""
    with tarfile.open(path) as tar:
        return {member.name: tar.extractfile(member).read() for member in tar}


def test_shards_hold_the_files_of_the_set(loose, packed):
    """WebDataset splits file names in shards at the first dot; no other files remain."""
    shards = [f"shard-{k:06d}{end}" for k in range(3) for end in (".tar", ".json")]
    assert {*content(packed)} == {"README.md", "dataset.json", "index.csv", *shards}
    found = {}
    for k in range(3):
        found |= members(packed / f"shard-{k:06d}.tar")
    wanted = {path.name.replace("_", "."): path.read_bytes() for path in loose.glob("0*")}
    assert found == wanted
    assert "000003.seg.png" in found


def test_the_index_has_the_place_of_each_sample(loose, packed):
    """In the index, offset and length cut out a tar file with only this sample."""
    with (packed / "index.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    for row in rows:
        whole = (packed / row["shard"]).read_bytes()
        part = whole[int(row["offset"]) :][: int(row["bytes"])]
        with tarfile.open(fileobj=io.BytesIO(part)) as tar:
            names = {member.name for member in tar}
        ends = ("json", "png", "ldmks.txt", "seg.png")
        assert names == {f"{row['id']}.{end}" for end in ends}


@pytest.mark.parametrize("kind", ["loose", "packed"])
def test_the_reader_reads_both(loose, packed, kind):
    """The reader returns pictures and labels from single files and from shards."""
    folder = {"loose": loose, "packed": packed}[kind]
    faces = Faces(folder)
    assert len(faces) == SAMPLE_COUNT
    sample = faces[2]
    assert sample["image"].shape == (3, 40, 48)
    assert 0.0 <= sample["image"].min() < sample["image"].max() <= 1.0
    assert sample["units"].shape == (len(UNITS),)
    assert sample["pixels"].shape == (70, 2)
    assert sample["visible"].shape == (70,)
    assert sample["classes"].shape == (40, 48)
    assert faces.files(3)["png"] == (loose / "000003.png").read_bytes()
    assert faces.files(3)["ldmks.txt"] == (loose / "000003_ldmks.txt").read_bytes()
    training, testing = faces.split(0.5)
    assert sorted(training + testing) == [*range(SAMPLE_COUNT)]
    person_of_sample = [row["person_number"] for row in faces.rows]
    trained = {person_of_sample[number] for number in training}
    tested = {person_of_sample[number] for number in testing}
    assert trained.isdisjoint(tested)


def test_the_example_of_the_page_reads_a_set(loose, tmp_path):
    """The page's example lines run in any folder, with numpy and Pillow alone."""
    page = (Path(__file__).parents[2] / "docs" / "dataset.md").read_text("utf-8")
    blocks = re.findall(r"(?:^    .*\n|^\n)+", page, re.MULTILINE)
    (block,) = [each for each in blocks if "risorius.faces" in each]
    shapes = "print({name: value.shape for name, value in sample.items()})"
    modules = "import sys; print(any(f'risorius.{n}' in sys.modules for n in ('app', 'jit')))"
    (tmp_path / "program.py").write_text(
        f"{textwrap.dedent(block)}\n{shapes}\n{modules}\n", "utf-8"
    )
    (tmp_path / "faces").symlink_to(loose)
    run = subprocess.run(
        [sys.executable, "program.py"], cwd=tmp_path, capture_output=True, text=True, check=True
    )
    assert "'image': (3, 40, 48), 'units': (12,), 'pixels': (70, 2)" in run.stdout
    assert run.stdout.endswith("False\n")


@pytest.mark.parametrize(
    "end",
    [
        "cut",
        "no listing",
        pytest.param("empty", marks=pytest.mark.slow),
        pytest.param("no tar", marks=pytest.mark.slow),
    ],
)
def test_a_damaged_shard_is_made_anew(packed, tmp_path, end):
    """Readable samples of a damaged shard are kept, and the completed set has the same bytes."""
    folder = tmp_path / "set"
    shutil.copytree(packed, folder)
    shard = folder / "shard-000000.tar"
    whole = shard.read_bytes()
    if end == "cut":
        shard.write_bytes(whole[: len(whole) * 3 // 4])
    if end == "empty":
        shard.write_bytes(b"")
    if end == "no listing":
        shard.with_suffix(".json").unlink()
    if end == "no tar":
        shard.unlink()
    (folder / "000002.png").write_bytes(b"left by a process that was killed")
    with in_this_process():
        made = make_set(
            request_for(folder, SAMPLES_PER_SHARD), SAMPLE_COUNT, resume=True, progress=False
        )
    assert made.new == {"cut": 1, "empty": 2, "no listing": 0, "no tar": 2}[end]
    assert content(folder) == content(packed)


def test_a_shard_grows_with_its_set(loose, packed, tmp_path):
    """When a set is made longer, the last shard is unpacked, and packed with the new samples."""
    folder = SetFolder(tmp_path)
    for file in loose.glob("0*"):
        shutil.copy(file, tmp_path)
    for count in (3, SAMPLE_COUNT):
        packing = Packing(folder, SAMPLES_PER_SHARD, range(count))
        packing.begin()
        packing.expect([])
        for number in range(count):
            labels, _ = packing.labels_and_place(number)
            assert labels["index"] == number
    for k in range(3):
        name = f"shard-{k:06d}.tar"
        assert (tmp_path / name).read_bytes() == (packed / name).read_bytes()


def test_a_process_elsewhere_hands_samples_back(loose, tmp_path):
    """A process that cannot see the set's folder returns the bytes of its files."""
    brought = []
    make_samples(SampleBatch(request_for(tmp_path / "nowhere"), (1,), "seen-0"), brought.append)
    (sample,) = brought
    assert sample.number == 1
    assert not (tmp_path / "nowhere").exists()
    assert sample.files == {path.name: path.read_bytes() for path in loose.glob("000001*")}
    folder = SetFolder(tmp_path / "set")
    (folder.path / UNFINISHED_SUFFIX).mkdir(parents=True)
    folder.take_sample(1, sample.files)
    assert folder.has(1)
    assert folder.files_of(1)[0].read_bytes() == (loose / "000001.json").read_bytes()


@pytest.mark.slow
def test_processes_compile_each_kernel_once(tmp_path, monkeypatch):
    """Two processes that find no compiled code need as much work as one: they share it."""
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    # Unrefined pictures need fewer kernels.
    request = replace(request_for(tmp_path / "nowhere"), refiner="none")
    batches = [SampleBatch(request, (number,), "seen-0") for number in range(2)]
    messages = [*run_all(make_samples_and_name_kernels, batches)]
    kernels = [message for message in messages if isinstance(message, str)]
    assert len(messages) == len(kernels) + len(batches)
    stored = [*tmp_path.rglob("*.nbc")]  # a file for each kernel and signature
    assert len(kernels) == len(stored) > 100


def test_another_release_is_refused(tmp_path):
    """A set of another release is refused, because its pictures would differ."""
    request = replace(request_for(tmp_path), version="0.0.1")
    with pytest.raises(UserError, match=r"the set needs 0\.0\.1; install the same"):
        make_samples(SampleBatch(request, (1,)), print)


def test_seeds_have_different_persons():
    """Seeds have different persons, and a number means the same person in all commands."""
    table = load_table(None)
    persons = [{draw(table, seed, k).person for k in range(300)} for seed in (0, 1, 7)]
    assert all(len(some) > 100 for some in persons)
    assert len(set.union(*persons)) == sum(map(len, persons))
    assert {number // 10**6 for number in persons[2]} == {7}
    assert table.population == EVERYBODY
    number = min(persons[1])
    identity = sample_identity(number, population=table.population)
    assert identity == sample_identity(number)
    colours = colours_of_number(identity, number, population=table.population)
    assert colours == colours_of_number(identity, number)
    assert person_called(number).identity == identity


@pytest.mark.parametrize(
    ("text", "is_so"),
    [
        ("[persons]\nwomen = 1.0", lambda who, _: who.sex.value == "woman"),
        ("[persons]\nage = [60, 61]", lambda who, _: 60 <= who.age <= 61),
        ("[persons]\ntone = [-40, -30]", lambda _, own: -40 <= own.angle <= -30),
        ("[cuts_of_women]\ntailed = 1\n[cuts_of_men]\ncropped = 1", lambda who, _: who.cut
         == ("tailed" if who.sex.value == "woman" else "cropped")),
        ("[persons]\nwomen = 0\n[beards]\nfull = 1", lambda _, own:
         6.0 <= own.features.beard_length <= 20.0),
    ],
)  # fmt: skip
def test_the_table_chooses_persons(tmp_path, text, is_so):
    """A table chooses persons by sex, age, tone, haircut and beard."""
    file = tmp_path / "my.toml"
    file.write_text(text, "utf-8")
    population = load_table(file).population
    for number in range(6):
        identity = sample_identity(number, population=population)
        assert is_so(identity, colours_of_number(identity, number, population=population))


@pytest.mark.slow
def test_a_cluster_hands_bytes_back(loose, cluster, tmp_path):
    """Workers that cannot see the folder return the bytes of their samples."""
    folder = SetFolder(tmp_path / "set")
    (folder.path / UNFINISHED_SUFFIX).mkdir(parents=True)
    share = SampleBatch(request_for(tmp_path / "nowhere"), (0, 1))
    for sample in make_on_cluster(folder, [share], cluster.scheduler_address):
        folder.take_sample(sample.number, sample.files)
    for number in (0, 1):
        for file in folder.files_of(number):
            assert file.read_bytes() == (loose / file.name).read_bytes()


@pytest.mark.slow
def test_a_cluster_loses_nothing_with_its_workers(packed, tmp_path):
    """When workers leave and join at random moments, the set has the same bytes."""
    distributed = pytest.importorskip("distributed")
    folder = tmp_path / "set"
    is_made = threading.Event()
    moments = random.Random(1)
    workers = []
    with distributed.LocalCluster(n_workers=0, dashboard_address=None) as cluster:
        address = cluster.scheduler_address

        def lose_computers() -> None:
            while not is_made.wait(0.05) and not any(folder.glob("[0-9]*.json")):
                pass  # a worker is lost during work, on any machine
            workers[0].kill()
            workers.append(joined(address))
            while len(workers) < 2 + KILL_COUNT and not is_made.wait(moments.uniform(8.0, 16.0)):
                running = [worker for worker in workers if worker.poll() is None]
                moments.choice(running).kill()
                workers.append(joined(address))

        workers += [joined(address), joined(address)]
        loser = threading.Thread(target=lose_computers)
        loser.start()
        try:
            request = request_for(folder, SAMPLES_PER_SHARD)
            make_set(request, SAMPLE_COUNT, scheduler=address, progress=False)
        finally:
            is_made.set()
            loser.join()
            for worker in workers:
                worker.kill()
                worker.wait()
    assert len(workers) > 2
    assert content(folder) == content(packed)


def joined(address):
    """A worker process of the scheduler at an address."""
    options = ("--nthreads", "1", "--no-nanny", "--no-dashboard")
    command = [sys.executable, "-m", "dask", "worker", address, *options]
    return subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
