"""The accessor `risorius` of PyVista's meshes: `mesh.risorius.refine()`.

PyVista (0.48 or newer) finds it by the entry point `pyvista.accessors`, and imports it at the first
use of `mesh.risorius`; a program only imports pyvista.
"""

from collections.abc import Iterable, Iterator
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
import pyvista
from tqdm import tqdm

from .geometry.arrays import Integers64
from .refine import View, WeldedRefiner, splits_of_clip

# The name in PyVista's filters for the cell from which a cell was made.
SOURCE_ARRAY = "vtkOriginalCellIds"


class PolyDataRefiner:
    """Refines one `pyvista.PolyData` in motion; `mesh.risorius.refiner()` makes it."""

    NORMALS = "Normals"  # their names in PyVista's filters

    def __init__(self, mesh: pyvista.PolyData, **options: Any) -> None:
        """Bind to a mesh at rest; see `RisoriusAccessor.refiner`."""
        self._rest = mesh.copy()
        self._options = options
        triangles, self._cells = triangles_of(mesh)
        if len(triangles) == 0:
            raise pyvista.MissingDataError("mesh has no faces, so there is nothing to refine")
        seams = any(name != self.NORMALS for name in mesh.point_data)
        self._refiner = WeldedRefiner(mesh.points, triangles, seams=seams, **options)

    def refine(
        self, frame: pyvista.PolyData | npt.ArrayLike, *, view: View | None = None
    ) -> pyvista.PolyData:
        """Refine one frame into a new mesh.

        Parameters
        ----------
        frame : pyvista.PolyData | array_like
            The mesh of the frame, with the same cells as at rest; its data go into the result. Or
            only its points, shape `(n_points, 3)`; then the data of the mesh at rest are used.
        view : risorius.refine.View, optional
            The viewpoint, for the criterion `silhouette`.

        Returns
        -------
        pyvista.PolyData
            Triangles with point normals and all data. Point data are interpolated linearly along
            edges and keep their types; integers are rounded. `vtkOriginalCellIds` has the cell of
            each triangle. Raises ValueError for another number of points or cells.
        """
        given = frame if isinstance(frame, pyvista.PolyData) else self._rest
        points = frame.points if isinstance(frame, pyvista.PolyData) else frame
        if given.n_cells != self._rest.n_cells:
            raise ValueError(
                f"the frame has {given.n_cells} cells, but the mesh at rest {self._rest.n_cells}; "
                "its topology must stay as it was bound"
            )
        values = {name: each for name, each in given.point_data.items() if name != self.NORMALS}
        mesh = self._refiner.refine(points, view, values)
        shown: Any = mesh.positions.copy(), mesh.triangles.astype(np.int64)  # buffers are reused
        refined: pyvista.PolyData = pyvista.PolyData.from_regular_faces(*shown)
        for name, carried in mesh.attributes.items():
            refined.point_data[name] = carried
        cells = self._cells[mesh.source]
        for name, array in given.cell_data.items():
            refined.cell_data[name] = np.asarray(array)[cells]
        for name, array in given.field_data.items():
            refined.field_data[name] = array
        refined.cell_data[SOURCE_ARRAY] = cells
        refined.point_data[self.NORMALS] = mesh.normals.copy()
        refined.point_data.active_normals_name = self.NORMALS
        texture = given.point_data.active_texture_coordinates_name
        if texture is not None:
            refined.point_data.active_texture_coordinates_name = texture
        field, active = given.active_scalars_info
        if active in refined.array_names:
            refined.set_active_scalars(active, preference=field)
        return refined

    def with_one_topology(
        self,
        frames: Iterable[pyvista.PolyData | npt.ArrayLike],
        *,
        view: View | None = None,
    ) -> "PolyDataRefiner":
        """Make a refiner whose frames all have the same points and cells, in the same order.

        Parameters
        ----------
        frames : iterable of pyvista.PolyData or array_like
            The frames of a clip. Each edge is split as often as the frame that needs it most.
        view : risorius.refine.View, optional
            As for `refine`.

        Returns
        -------
        PolyDataRefiner
            A refiner that also refines further frames of the same points and cells.
        """
        points = (each.points if isinstance(each, pyvista.PolyData) else each for each in frames)
        splits = splits_of_clip(self._refiner, map(np.asarray, points), view)
        options = {name: value for name, value in self._options.items() if name != "criterion"}
        return PolyDataRefiner(self._rest, **{**options, "splits": splits})

    def refine_all(
        self,
        frames: Iterable[pyvista.PolyData | npt.ArrayLike],
        *,
        fixed: bool = False,
        progress_bar: bool = False,
    ) -> Iterator[pyvista.PolyData]:
        """Refine many frames one by one, as they are requested, each as `refine` does.

        Parameters
        ----------
        frames : iterable of pyvista.PolyData or array_like
            Meshes or points.
        fixed : bool, default: False
            Whether all frames get the same points and cells in the same order. All of `frames` are
            read before the first result then; see `with_one_topology`.
        progress_bar : bool, default: False
            Display a progress bar to indicate progress.
        """
        refiner = self
        if fixed:
            frames = list(frames)
            refiner = self.with_one_topology(frames)
        for frame in tqdm(frames, desc="Refining", disable=not progress_bar):
            yield refiner.refine(frame)


class Cells(NamedTuple):
    """Cells of one kind in VTK's form."""

    starts: Integers64
    """Place in `points` where each cell begins, and where the last one ends, shape (C + 1,)."""
    points: Integers64
    """Points of all cells, one cell after another."""

    @property
    def sizes(self) -> Integers64:
        """Number of points of each cell, shape (C,)."""
        return np.diff(self.starts)

    def points_of(self, cell: int) -> Integers64:
        """The points of one cell."""
        return self.points[self.starts[cell] : self.starts[cell + 1]]


def triangles_of(mesh: pyvista.PolyData) -> tuple[Integers64, Integers64]:
    """Cut a mesh's surface into triangles, shape (F, 3); also return the cell of each, (F,).

    Lines, lone points and polygons of fewer than three points have no surface and are left out.
    Only polygons of more than three points go through VTK's filter, because it returns
    uninitialised memory for lines and lone points. Raises ValueError for cells with missing points.
    """
    polygons = _cells_of(mesh.GetPolys(), mesh.n_points)
    strips = _cells_of(mesh.GetStrips(), mesh.n_points)
    first_polygon = mesh.GetNumberOfVerts() + mesh.GetNumberOfLines()
    first_strip = first_polygon + len(polygons.sizes)

    of_three = np.flatnonzero(polygons.sizes == 3)
    triangles = [polygons.points[polygons.starts[of_three, None] + np.arange(3)]]
    cells = [first_polygon + of_three]
    cut, polygon_of = _cut_polygons(mesh.points, polygons)
    triangles.append(cut)
    cells.append(first_polygon + polygon_of)
    for k in np.flatnonzero(strips.sizes >= 3).tolist():
        strip = strips.points_of(k)
        along = np.stack([strip[:-2], strip[1:-1], strip[2:]], axis=1)
        along[1::2] = along[1::2, [1, 0, 2]]  # every second triangle of a strip runs backwards
        triangles.append(along)
        cells.append(np.full(len(along), first_strip + k))
    numbers = np.concatenate(cells)
    order = np.argsort(numbers, kind="stable")
    return np.concatenate(triangles)[order], numbers[order]


def _cells_of(array: Any, point_count: int) -> Cells:
    """The cells of a vtkCellArray; raises ValueError for points from `point_count` on."""
    starts = np.asarray(pyvista.convert_array(array.GetOffsetsArray()), dtype=np.int64)
    points = np.asarray(pyvista.convert_array(array.GetConnectivityArray()), dtype=np.int64)
    if len(points) > 0 and not 0 <= points.min() <= points.max() < point_count:
        raise ValueError(
            f"cells must name points from 0 to {point_count - 1}, but they name "
            f"{points.min()} to {points.max()}"
        )
    return Cells(starts, points)


def _cut_polygons(points: npt.ArrayLike, polygons: Cells) -> tuple[Integers64, Integers64]:
    """Triangles of the polygons with more than three points, (T, 3), and the polygon of each."""
    is_large = polygons.sizes > 3
    large = np.flatnonzero(is_large)
    if len(large) == 0:
        return np.zeros((0, 3), dtype=np.int64), large
    is_of_large = np.repeat(is_large, polygons.sizes)
    starts = np.concatenate([[0], np.cumsum(polygons.sizes[large])])
    uncut = pyvista.PolyData()
    uncut.points = points
    arrays: Any = starts, polygons.points[is_of_large]  # PyVista's types ask for arrays of `int`
    uncut.SetPolys(pyvista.CellArray.from_arrays(*arrays))
    uncut.cell_data[SOURCE_ARRAY] = large
    cut = uncut.triangulate()
    triangles = _cells_of(cut.GetPolys(), cut.n_points).points.reshape(-1, 3)
    polygon_of = np.asarray(cut.cell_data[SOURCE_ARRAY])
    # If points lie on one line, VTK leaves triangles out, and their neighbours would have a hole.
    counts = np.bincount(polygon_of, minlength=len(polygons.sizes))
    is_short = np.zeros(len(polygons.sizes), dtype=np.bool_)
    fans: list[tuple[int, int, int]] = []
    fan_of: list[int] = []
    for k in large[counts[large] < polygons.sizes[large] - 2].tolist():
        polygon = polygons.points_of(k)
        corners = polygon[polygon != np.roll(polygon, 1)].tolist()
        if counts[k] < len(set(corners)) - 2:
            fan = [(corners[0], b, c) for b, c in pairwise(corners[1:])]
            is_short[k] = True
            fans += fan
            fan_of += [k] * len(fan)
    is_whole = ~is_short[polygon_of]
    fan_triangles = np.array(fans, dtype=np.int64).reshape(-1, 3)
    fan_polygons = np.array(fan_of, dtype=np.int64)
    return (
        np.concatenate([triangles[is_whole], fan_triangles]),
        np.concatenate([polygon_of[is_whole], fan_polygons]),
    )


@pyvista.register_dataset_accessor("risorius", pyvista.PolyData)
class RisoriusAccessor:
    """Crack-free refinement of surfaces where they bend; `mesh.risorius` of any `PolyData`."""

    def __init__(self, mesh: pyvista.PolyData) -> None:
        """PyVista makes this object at the first use."""
        self._mesh = mesh

    def refine(
        self,
        *,
        rest: pyvista.PolyData | None = None,
        weld: bool = True,
        weld_tolerance: float | None = None,
        **options: Any,
    ) -> pyvista.PolyData:
        """Refine this mesh once.

        Parameters
        ----------
        rest : pyvista.PolyData, optional
            The same mesh before it was deformed. By default, this mesh counts as undeformed, and is
            refined where it is coarse.
        weld : bool, default: True
            As for `refiner`.
        weld_tolerance : float, optional
            As for `refiner`.
        **options
            As for `refiner`, except that `blend` is False by default.

        Examples
        --------
        Round a coarse sphere, and look at it.

        >>> import pyvista as pv
        >>> sphere = pv.Sphere(theta_resolution=12, phi_resolution=12)
        >>> refined = sphere.risorius.refine()
        >>> refined.is_manifold
        True
        >>> refined.plot(show_edges=True)
        """
        source = self._mesh if rest is None else rest
        chosen = {"weld": weld, "weld_tolerance": weld_tolerance, "blend": False, **options}
        return PolyDataRefiner(source, **chosen).refine(self._mesh)

    def refiner(
        self, *, weld: bool = True, weld_tolerance: float | None = None, **options: Any
    ) -> PolyDataRefiner:
        """Bind a refiner to this mesh, which is at rest, for all frames of an animation.

        Parameters
        ----------
        weld : bool, default: True
            Whether points at one place are merged, so that no crack opens between them. Use False
            for surfaces that touch at rest and separate later. Points with different data are
            separate again in the output.
        weld_tolerance : float, optional
            Largest distance of merged points, relative to the longest side of the mesh's bounds: by
            default 1e-9, or the rounding error of the points' type if that is larger. 0 welds
            points that are equal to the last bit.
        **options
            The options of `risorius.refine.create_kahler`, except texture coordinates and
            attributes: all data of the mesh are refined automatically. The defaults are
            `scheme="cubic"` and `criterion="displacement+rest"`, which round coarse places at rest
            and bent ones; `scheme="loop", criterion="normal"` is the paper's rule. All edges are
            rounded, including sharp edges, unless `crease_angle` [degrees] is given. It is VTK's
            feature angle: edges between cells that differ by a larger angle at rest stay in place,
            as borders do.

        Examples
        --------
        Keep the rims of a cylinder sharp, and round the sides between them.

        >>> import pyvista as pv
        >>> cylinder = pv.Cylinder(resolution=12)
        >>> rounded = cylinder.risorius.refine(crease_angle=40.0)
        >>> rounded.clean().volume < 1.06 * cylinder.clean().volume
        True

        Bend a plate, and refine each frame of it.

        >>> import numpy as np
        >>> import pyvista as pv
        >>> plate = pv.Plane(i_resolution=8, j_resolution=8)
        >>> refiner = plate.risorius.refiner()
        >>> points = plate.points.copy()
        >>> points[:, 2] = 0.1 * np.sin(9.0 * points[:, 0])
        >>> bent = refiner.refine(points)
        >>> bent.n_cells > 2 * plate.n_cells
        True
        """
        return PolyDataRefiner(self._mesh, weld=weld, weld_tolerance=weld_tolerance, **options)
