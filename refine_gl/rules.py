"""The settings of `kahler-gl`, and the passes, switches and numbers of its shaders.

Two schemes: `loop`, the paper's, and `cubic` with the normals of its own surface, which films and
the window show. The card evaluates the criteria `normal`, `rest` and `displacement`. The processor
measures all other criteria, and uploads four bytes per edge in every frame.
"""

from collections.abc import Mapping
from typing import Literal, NamedTuple

import numpy as np
import numpy.typing as npt

from risorius.geometry.arrays import Floats32, Floats64
from risorius.refine import (
    Connectivity,
    Criterion,
    Displacement,
    Maximum,
    NormalDrop,
    Thresholds,
    View,
    port,
)

ONE = np.float32(1.0)
Arrays = Mapping[str, npt.NDArray[np.generic]]

PASS_ELEMENTS: Mapping[str, tuple[str, ...]] = {
    "normals": ("vertex_count",),
    "steepen": ("vertex_count",),
    "displace": ("edge_count",),
    "centres": ("face_count",),
    "surface_vertices": ("vertex_count",),
    "surface_edges": ("edge_count",),
    "mark": ("attribute_edge_count",),
    "configure": ("face_count",),
    "offsets": (),  # one group
    "place": ("wedge_count", "attribute_edge_count", "face_count"),
    "quarters": ("attribute_edge_count",),
    "place_centres": ("face_count",),
}
"""The elements that each pass has threads for. Passes are dispatches, named as their shaders."""


class RefinerSettings(NamedTuple):
    """The settings of a refiner, named as in `refine.create_kahler`."""

    scheme: Literal["loop", "cubic"]
    criterion: Criterion
    blend: bool
    coherent: bool


class Rules:
    """Settings bound to a mesh."""

    def __init__(
        self,
        mesh: Connectivity,
        rest_positions: Floats64,
        rest_normals: Floats32,
        settings: RefinerSettings,
    ) -> None:
        """Bind the settings; raises ValueError for options that the card does not have."""
        self._mesh = mesh
        self._rest = rest_positions
        self.scheme, self.criterion, self.blends, self.coherent = settings
        parts = _parts(self.criterion)
        if settings.scheme == "loop" and any(isinstance(each, Displacement) for each in parts):
            raise ValueError('criterion "displacement" needs scheme="cubic" in kahler-gl')
        self._drop = next((each for each in parts if type(each) is NormalDrop), None)
        self._displacement = next((each for each in parts if type(each) is Displacement), None)
        still = [each for each in parts if each.is_constant]
        taken = {id(each) for each in (self._drop, self._displacement, *still)}
        others = [each for each in parts if id(each) not in taken]
        self.others = Maximum(others) if others else None
        """Criteria that the processor measures; None if there are none."""
        for bound in (*still, self.others):
            if bound is not None:
                bound.bind(mesh, rest_positions, rest_normals)
        self.still = np.full(len(mesh.edges), -np.inf, np.float32)
        """The metric of the constant criteria, shape (E,)."""
        metric = np.zeros_like(self.still)
        for each in still:
            each.measure(rest_positions, rest_normals, metric)
            np.maximum(self.still, metric, out=self.still)
        self._patterns = port.FAN_TABLE if settings.blend else port.CONFIGURATION_TABLE
        if settings.coherent:
            self._patterns = port.sequence_tables().patterns

    @property
    def passes(self) -> list[str]:
        """The dispatches of a frame, in their order."""
        curves = (
            "steepen",
            "displace",
            "centres",
            "surface_vertices",
            "surface_edges",
            "place_centres",
        )
        left_out = {"quarters"} if self.scheme == "cubic" else set(curves)
        left_out |= set() if self.blends else {"place_centres"}
        return [name for name in PASS_ELEMENTS if name not in left_out]

    @property
    def switches(self) -> list[str]:
        """The defines for compiled shaders."""
        chosen = {
            "CURVED": self.scheme == "cubic",
            "BLENDED": self.blends,
            "COHERENT": self.coherent,
            "BY_NORMAL": self._drop is not None,
            "BY_DISPLACEMENT": self._displacement is not None,
            "BY_MEASURED": self.others is not None or bool((self.still > -np.inf).any()),
        }
        return [name for name, is_on in chosen.items() if is_on]

    @property
    def limits(self) -> dict[str, float]:
        """Numbers that are not whole, by their names in shaders."""
        by = self._displacement
        unit = port.mean_length(self._mesh, self._rest)
        limits = _limits("drop", None if self._drop is None else self._drop.thresholds)
        limits |= _limits("size", None if by is None else by.thresholds, unit)
        soon = np.float32(0.0)
        if by is not None:
            soon = np.float32(port.GROWTH_SHARE) * by.thresholds.once / by.thresholds.width
        slope = port.RAMP_WIDTH / soon if soon > 0.0 else np.float32(0.0)
        limits |= {
            "size_soon": float(soon),
            "size_ramp": float(port.RAMP_WIDTH),
            "size_slope": float(slope),
        }
        return limits | {"turning": 0.0 if by is None else float(np.float32(by.turning))}

    def arrays(self) -> Arrays:
        """The arrays of scheme, criteria and table, uploaded once per mesh."""
        patterns = self._patterns
        corners = self._patterns.subtriangles.astype(np.uint32)
        found: dict[str, npt.NDArray[np.generic]] = {
            "counts": patterns.counts,
            "patterns": corners[..., 0] | corners[..., 1] << 8 | corners[..., 2] << 16,
        }
        if self.coherent:
            tables = port.sequence_tables()
            found["transitions"] = tables.transitions | tables.removals.astype(np.uint32) << 16
        return {**found, **(self._ring() if self.scheme == "loop" else self._curves())}

    def fields(self) -> dict[str, int]:
        """Vectors that passes share: name -> count."""
        mesh = self._mesh
        vertices = mesh.vertex_count
        edges = len(mesh.edges)
        faces = len(mesh.faces)
        fields = {"points": vertices, "normals": vertices, "midpoints": edges}
        if self.scheme == "cubic":
            fields |= dict.fromkeys(
                ("tangent_normals", "steepened_normals", "relative_positions", "surface_normals"),
                vertices,
            )
            fields |= {"displacements": 3 * edges, "edge_normals": edges, "centres": faces}
        return fields

    def undefined_edges(self) -> npt.NDArray[np.bool_]:
        """Edges whose normals are undefined at rest; the paper's criterion never splits them.

        Shape (E,).
        """
        undefined = np.empty(self._mesh.vertex_count, np.bool_)
        port.find_undefined_normals(self._mesh.faces, self._rest, undefined)
        return np.asarray(undefined[self._mesh.edges].any(axis=1))

    def measure_others(self, positions: Floats64, normals: Floats32, view: View | None) -> Floats32:
        """Measure a frame on the processor: the metric of every edge, shape (E,)."""
        assert self.others is not None
        metric = np.empty(len(self._mesh.edges), np.float32)
        self.others.set_view(view)
        self.others.measure(positions, normals, metric)
        if np.isnan(metric).any():
            raise ValueError(
                self.others.find_complaint(positions, normals, len(metric))
                or self.others.complaint(metric)
            )
        return np.maximum(metric, self.still)

    def _ring(self) -> Arrays:
        """The arrays of the paper's rule for vertices."""
        rings = port.vertex_rings(self._mesh)
        return {
            "wings": self._mesh.around.wings,
            "ring_neighbours": rings.near,
            "ring_starts": rings.starts,
            "further_neighbours": rings.others,
            "ring_own": rings.own,
            "ring_weight": rings.ring,
        }

    def _curves(self) -> Arrays:
        """The arrays of cubic edges and of the normals of their surface."""
        mesh = self._mesh
        ends = mesh.edges.ravel()
        valences = np.bincount(ends, minlength=mesh.vertex_count)
        order = np.argsort(ends, kind="stable")
        weights = np.zeros(mesh.faces.shape, np.float32)
        port.weigh_corners(self._rest, mesh.faces, weights)
        return {
            "corner_weights": weights,
            "triangle_edges": mesh.triangle_edges.view(np.uint32),
            "edge_sides": mesh.edge_sides,
            "border_neighbours": port.follow_borders(mesh, self._rest),
            "neighbour_starts": np.concatenate([[0], np.cumsum(valences)]),
            "neighbours": mesh.edges[:, ::-1].ravel()[order],
            "neighbour_weights": (port.STEEPENING_SHARE / np.maximum(valences, 1)).astype(
                np.float32
            ),
        }


def _parts(decides: Criterion) -> list[Criterion]:
    """A criterion, or the criteria of a maximum."""
    if type(decides) is not Maximum:
        return [decides]
    return [part for each in decides.parts for part in _parts(each)]


def _limits(name: str, thresholds: Thresholds | None, unit: np.float32 = ONE) -> dict[str, float]:
    """Limits of a criterion that the card measures, in the unit of its measure; zeros for none."""
    limits = dict.fromkeys(("once", "twice", "width", "most"), 0.0)
    if thresholds is not None:
        numbers = *thresholds.limits, thresholds.width
        limits = dict(zip(limits, [float(unit * number) for number in numbers], strict=False))
        limits["most"] = float(thresholds.most)
    return {f"{name}_{end}": limit for end, limit in limits.items()}
