"""Construction of refiners for scenes, and parsing of their command-line options."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType
from typing import Any

import numpy as np
import numpy.typing as npt

from risorius import assets, refine
from risorius.assets.coarse import CoarseHead
from risorius.assets.identities import Person
from risorius.geometry.arrays import Floats32, Floats64, Integers32
from risorius.geometry.normals import cross_products
from risorius.geometry.sides import edges_of, side_lengths

from ..errors import UserError
from ..scenes import Drawable
from .plug_ins import culprit_of, error_in, plug_ins_of
from .presets import PAPERS_CRITERION, PRESETS, STATIC_REFINER, THRESHOLD_OPTIONS, Refinement, named

Splits = npt.NDArray[np.uint8]

CUBIC_SCHEME = "cubic"
SIDES = "left", "right"  # of the built-in head's rings
EAR_VERTEX_COUNT = 14  # number of vertices along the free edge of an ear
DETAIL_SCHEME = "detail"  # the only scheme that needs a finer mesh, see `finer_mesh`
NO_ATTRIBUTES: Mapping[str, Floats32] = MappingProxyType({})
OPTION_MARK = "."  # mark between a criterion and its option
SWITCH_WORDS = {"on": True, "true": True, "off": False, "false": False}


def refiner_for(
    scene: Drawable,
    refinement: Refinement,
    splits: Splits | None = None,
    attributes: Mapping[str, Floats32] = NO_ATTRIBUTES,
) -> refine.Refiner:
    """Bind the refiner of a refinement to the scene's mesh.

    `splits`: fixed number of splits of each edge, shape (E,), in place of a criterion.
    `attributes`: name -> values of vertices at rest; ignored by a refiner without attributes.
    Raises UserError if the refiner refuses an option, and PlugInError if code of another package
    fails.
    """
    name, options = refinement.for_scene(scene.name)
    plug_ins = plug_ins_of(name, options)
    try:
        if refinement.options:
            _check(name, refinement.options, refinement.criterion_on(scene.name))
            options = with_criteria(options)
        if options.get("scheme") == DETAIL_SCHEME and _takes_own_schemes(name):
            finer = finer_mesh(scene)
            if finer is None:
                raise UserError(f"refiner {name}: scheme=detail needs a head that has a finer mesh")
            options["scheme"] = refine.DetailScheme(finer)
        # A refiner by name has none of these, because the graphics card cannot draw them.
        if refinement.refiner is None and options.get("scheme") == CUBIC_SCHEME:
            outlines, curves = rims_of(scene)
            backs, covers = _sides_of_coarse_lids(scene)
            options["scheme"] = refine.CubicScheme(outlines, backs, curves, covers)
        if splits is not None:
            options.pop("criterion", None)
            options["splits"] = splits
        mesh = scene.faces, scene.rest_positions, scene.skin.uv, scene.skin.face_uv
        if attributes and refine.takes_attributes(name):
            return refine.create(name, *mesh, **options, attributes=attributes)
        return refine.create(name, *mesh, **options)
    except UserError:
        raise
    except (Exception, SystemExit) as error:
        plug_in = culprit_of(error, plug_ins)
        is_refusal = isinstance(error, ValueError | TypeError)
        if plug_in is not None and not (is_refusal and plug_in.kind == "refiner"):
            raise error_in(plug_in, error) from error
        if not is_refusal:
            raise
        hint = _presets_share(refinement, options)
        raise UserError(f"refiner {name}: {error}{hint}") from error


def _presets_share(refinement: Refinement, options: Mapping[str, Any]) -> str:
    """Return a hint on options that the preset sets, because a user may not know them."""
    settings = [
        f"{name}={('off', 'on')[value] if isinstance(value, bool) else value}"
        for name, value in options.items()
        if name not in refinement.options and isinstance(value, bool | int | float | str)
    ]
    is_mixed = settings and refinement.options
    return f"; the look {refinement.preset} has {', '.join(settings)}" if is_mixed else ""


def options_of(refiner: str, criterion: str) -> dict[str, refine.Option]:
    """Return the options of a refiner and of its criterion, except options that are objects.

    An option of a criterion has the criterion's name, as in `rest.levels`. If the refiner has the
    same option, only the refiner's is returned. Raises ValueError for a refiner that cannot be
    loaded.
    """
    found = {option.name: option for option in refine.parameters(refiner)}
    known = refine.criteria.available()
    parts = criterion.split("+") if "criterion" in found else []
    for part in parts:
        own = refine.criteria.options(part) if part in known else ()
        for option in own:
            if option.name not in found:
                found[f"{part}{OPTION_MARK}{option.name}"] = option
    return {name: option for name, option in found.items() if option.kind != "object"}


def _check(refiner: str, options: Mapping[str, Any], criterion: str) -> None:
    """Raise UserError for an option that neither the refiner nor its criterion has."""
    there_are = options_of(refiner, criterion)
    for option in options:
        if option not in there_are:
            takes = f"it takes {', '.join(there_are)}" if there_are else "it has no options"
            raise UserError(f"refiner {refiner}: unknown option {option}; {takes}")


def with_criteria(options: Mapping[str, Any]) -> dict[str, Any]:
    """Return the options for `refine.create`, in which criteria with options become objects.

    Raises ValueError for a value that a criterion refuses.
    """
    plain = {name: value for name, value in options.items() if OPTION_MARK not in name}
    if len(plain) == len(options):
        return plain
    made: list[str | refine.Criterion] = []
    for part in str(plain.get("criterion", PAPERS_CRITERION)).split("+"):
        start = f"{part}{OPTION_MARK}"
        own = {name.removeprefix(start): options[name] for name in options if start in name}
        for option in refine.criteria.options(part) if own else ():
            if option.name in own:
                replace(option, name=f"{start}{option.name}").check(own[option.name])
        if own and part == PAPERS_CRITERION:  # its thresholds are options of the refiner
            own |= {name: plain[name] for name in THRESHOLD_OPTIONS if name in plain}
        made.append(refine.criteria.make(part, **own) if own else part)
    return {**plain, "criterion": made}


def help_of_options(refiner: str) -> str:
    """List the options of a refiner and of all its possible criteria, one on each line."""
    every = "+".join(refine.criteria.available())
    lines = [
        f"  {name:<24}{option.wanted:<34}{_in_words(option):<14}{option.help}".rstrip()
        for name, option in options_of(refiner, every).items()
    ]
    return "\n".join([f"Options of the refiner {refiner}: name, values, default", *lines])


def _in_words(option: refine.Option) -> str:
    """Return the default of an option as a user writes it."""
    if option.kind == "choice":
        same = (word for word, value in option.choices.items() if value == option.default)
        return next(same, "")
    if option.kind == "switch":
        return "on" if option.default else "off"
    return str(option.default)


def _takes_own_schemes(refiner: str) -> bool:
    """Whether the option `scheme` of a refiner takes any name or object."""
    return any(each.name == "scheme" and each.kind == "word" for each in refine.parameters(refiner))


def rims_of(scene: Drawable) -> tuple[list[list[int]], list[list[int]]]:
    """Return sharp and rounded rims of the built-in head, of persons, and of the coarse head.

    The sharp ones are rims of nostrils, outlines from below. The first vertex of such a rim is the
    outermost; it lies in a fold, so its edges are not an outline. The rounded ones are the lines at
    which the lips part, the upper lip first, and two rows of vertices along the free edge of each
    ear, outlines from the side and from the front. The coarse head has only the lips.
    """
    if scene.face is None or not isinstance(scene.face.head, assets.Head | Person | CoarseHead):
        return [], []
    rings = assets.load("head").rings
    lips = _lip_lines(rings)
    if isinstance(scene.face.head, CoarseHead):
        numbers = {vertex: own for own, vertex in enumerate(scene.face.head.file_vertices.tolist())}
        return [], [[numbers[vertex] for vertex in line if vertex in numbers] for line in lips]
    nostrils = [rings[f"nostril_{side}"].tolist() for side in SIDES]
    ears = [rings[f"ear_{row}_{side}"].tolist() for row in (1, 2) for side in SIDES]
    # The last vertices are those of the concha, which both rows share.
    rounded = [*lips, *(row[:EAR_VERTEX_COUNT] for row in ears)]
    return [[*rim, rim[0]] for rim in nostrils], rounded


def _lip_lines(rings: Mapping[str, Integers32]) -> list[list[int]]:
    """Return the vertices at which the upper and the lower lip part, from corner to corner."""
    left, right = (rings[f"mouth_2_{side}"].tolist() for side in SIDES)
    corner = len(left) // 2
    upper = [*right[corner:0:-1], *left[: corner + 1]]
    lower = [*left[corner:], *right[-2 : corner - 1 : -1]]
    return [upper, lower]


def _sides_of_coarse_lids(scene: Drawable) -> tuple[list[int], list[int]]:
    """Return the triangles on the inner and the outer sides of coarse eyelids.

    Inner sides face the eyeball. A margin of few large triangles would be shaded as a mean of both
    sides: it would have dark spots. Small triangles are the dark line between shut lids. Outer
    sides cover the eyeball of a shut eye; large ones that bent inward would be pierced by it.
    """
    if scene.face is None:
        return [], []
    x = scene.rest_positions
    faces = scene.faces
    crosses = cross_products(x, faces)
    links = edges_of(faces)
    backs: list[int] = []
    covers: list[int] = []
    for eye in scene.face.head.eyes:
        reach = eye.radius + 8.0  # [mm] from the eyeball's centre, with the thickness of a lid
        is_near = (np.linalg.norm(x - eye.centre, axis=1) < reach)[faces].all(axis=1)
        turned = (crosses * (x[faces].mean(axis=1) - eye.centre)).sum(axis=1) < 0.0
        inner = np.flatnonzero(is_near & turned)
        outer = np.flatnonzero(is_near & ~turned)
        margin = np.intersect1d(faces[inner], faces[outer])
        at_margin = links[np.isin(links, margin).any(axis=1)]
        lengths = side_lengths(x, at_margin)
        coarse_edge = 4.2  # [mm], mean of the edges at a margin; that of the built-in head is 3.8
        if len(lengths) and lengths.mean() > coarse_edge:
            backs += inner.tolist()
            covers += outer.tolist()
    return backs, covers


def can_detail(scene: Drawable) -> bool:
    """Whether the scene's head has a finer mesh."""
    return scene.face is not None and isinstance(scene.face.head, assets.Head)


def finer_mesh(scene: Drawable) -> tuple[Floats64, Integers32] | None:
    """Return vertices and triangles of a finer mesh of the scene's head, if there is one.

    The mesh has four times the triangles of the head.
    """
    face = scene.face
    if face is None or not isinstance(face.head, assets.Head):
        return None
    finer = face.head.finer(1)
    return finer.vertices, finer.faces


def parse_options(refiner: str | None, settings: Sequence[str]) -> dict[str, Any]:
    """Parse `--option NAME=VALUE ...`; refiner: None for the refiner of the preset.

    Values are numbers, on and off, or words. Raises UserError for an unknown refiner, and for
    options of the refiner `none`.
    """
    if refiner is not None and refiner not in refine.refiners.available():
        there_are = ", ".join(refine.refiners.available())
        raise UserError(f"refiner '{refiner}' is unknown; there are {there_are}")
    if refiner == STATIC_REFINER and settings:
        raise UserError(
            f"--option {settings[0]}: --refiner none draws the mesh as it is and has no options"
        )
    options: dict[str, Any] = {}
    largest_number = 1e30  # largest value of an option, which fits into single precision
    for setting in settings:
        name, equals, text = setting.partition("=")
        if not (name and equals and text):
            raise UserError(f"--option {setting}: write NAME=VALUE, such as scheme=cubic")
        options[name] = _value(text)
        value = options[name]
        if isinstance(value, int | float) and not -largest_number <= value <= largest_number:
            raise UserError(
                f"--option {setting}: {text} is not a finite number up to {largest_number:g}"
            )
    return options


def parse_comparison(names: str | None, refinement: Refinement) -> tuple[Refinement, ...]:
    """Parse `--compare NAME,...`, the looks and refiners to show beside a refinement.

    names: None for no comparison. Raises UserError for unknown names, and for equal refinements.
    """
    beside: list[Refinement] = []
    for name in [] if names is None else names.split(","):
        if name not in PRESETS and name not in refine.refiners.available():
            raise UserError(
                f"--compare: '{name}' is neither a look ({', '.join(PRESETS)}) nor a refiner "
                f"({', '.join(refine.refiners.available())}); a SCRIPT goes before --compare"
            )
        other = named(name, refinement.preset)
        if other in (refinement, *beside):
            raise UserError(
                f"--compare: '{name}' would be compared with itself; choose a --look or a "
                f"--refiner other than {name}, or compare with another"
            )
        beside.append(other)
    return tuple(beside)


def _value(text: str) -> bool | int | float | str:
    if text.lower() in SWITCH_WORDS:
        return SWITCH_WORDS[text.lower()]
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            pass
    return text
