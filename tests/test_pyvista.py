"""`mesh.risorius` in PyVista: data are kept, and errors are those of PyVista."""

import doctest
import subprocess
import sys
import warnings
from collections.abc import Iterator

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from pytest import approx

pyvista = pytest.importorskip("pyvista", reason="needs the extra 'pyvista'")


@pytest.fixture(autouse=True)
def warnings_are_errors() -> Iterator[None]:
    """Turn PyVista's deprecation warnings into errors."""
    with warnings.catch_warnings():
        warnings.simplefilter("error", pyvista.PyVistaDeprecationWarning)
        yield


def wavy(mesh, height=0.3):
    """The points of a plane, deformed to a sine wave."""
    points = mesh.points.copy()
    points[:, 2] += height * np.sin(9.0 * points[:, 0] + 4.0 * points[:, 1])
    return points


def plane():
    """A plane of quads with data of every kind."""
    mesh = pyvista.Plane(i_resolution=12, j_resolution=12)
    x = mesh.points[:, 0]
    mesh.point_data["colours"] = (255 * (mesh.points + 0.5)).astype(np.uint8)
    mesh.point_data["right"] = x > 0.0
    mesh.point_data["name"] = np.array([f"p{k}" for k in range(mesh.n_points)])
    mesh.point_data["hole"] = np.where(x > 0.4, np.nan, x)
    mesh.point_data["speed"] = mesh.points * 2.0
    mesh.cell_data["number"] = np.arange(mesh.n_cells)
    mesh.field_data["time"] = [0.25]
    mesh.point_data["x"] = x.astype(np.float64)
    mesh.set_active_scalars("x")
    return mesh


@pytest.mark.slow
def test_it_is_found_by_itself():
    """`import pyvista` is enough for `mesh.risorius`.

    Importing the refiner does not load PyVista.
    """
    code = (
        "import sys, pyvista; assert 'risorius' not in sys.modules; mesh = pyvista.Sphere(); "
        "assert 'risorius' in dir(mesh); print(mesh.risorius.refine().n_cells > mesh.n_cells)"
    )
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert found.stdout.strip() == "True"
    code = "import sys, risorius.refine; assert 'pyvista' not in sys.modules"
    subprocess.run([sys.executable, "-c", code], check=True)


def test_data_go_along():
    """Refined meshes have point data by place, cell data by cell, fields, texture and normals.

    Types and active scalars are kept.
    """
    mesh = plane()
    refined = mesh.risorius.refiner(criterion="displacement", blend=False).refine(wavy(mesh))
    assert refined.n_cells > 2 * mesh.n_cells
    assert refined.is_all_triangles
    assert refined.active_scalars_name == "x"
    assert_allclose(refined["x"], refined.points[:, 0], atol=0.02)
    assert_allclose(refined["speed"][:, 1], 2.0 * refined.points[:, 1], atol=0.04)
    for name in ("colours", "right", "x", "speed"):
        assert refined[name].dtype == mesh[name].dtype, name
    assert set(refined["name"]) <= set(mesh["name"])
    assert np.isnan(refined["hole"]).any()
    assert np.isfinite(refined["hole"]).any()
    assert_allclose(refined.active_texture_coordinates[:, 0] - 0.5, refined["x"], atol=1e-6)
    cells = refined.cell_data["vtkOriginalCellIds"]
    assert_array_equal(refined.cell_data["number"], cells)
    bounds = mesh.extract_cells([int(cells[7])]).bounds
    assert refined.extract_cells([7]).bounds.x_min >= bounds.x_min - 0.03
    assert refined.field_data["time"][0] == 0.25
    assert refined.point_data.active_normals_name == "Normals"
    assert (refined.point_data.active_normals[:, 2] > 0.0).all()


def test_the_papers_rule_compares_with_a_form_at_rest():
    """The paper's rule refines a mesh where it differs from a given form at rest."""
    mesh = plane()
    frame = mesh.copy()
    frame.points = wavy(mesh)
    paper = {"scheme": "loop", "criterion": "normal"}
    assert frame.risorius.refine(**paper).n_cells == 2 * mesh.n_cells
    assert frame.risorius.refine(rest=mesh, **paper).n_cells > 2 * mesh.n_cells


def test_doubled_points_do_not_crack():
    """A cylinder's caps have separate points; its rim stays closed, and textures stay separate."""
    mesh = pyvista.Cylinder(resolution=16)
    assert mesh.n_open_edges > 0
    refined = mesh.risorius.refine()
    assert refined.n_cells > mesh.triangulate().n_cells
    assert refined.clean().n_open_edges == 0
    mesh.clear_data()
    assert mesh.risorius.refine().n_open_edges == 0


def test_polygons_strips_and_lines():
    """Polygons and strips become triangles of known cells; cells without a surface are left out."""
    mesh = pyvista.Disc(inner=0.0, c_res=5).merge(pyvista.Line())
    mesh.cell_data["number"] = np.arange(mesh.n_cells)
    refined = mesh.risorius.refine()
    assert refined.is_all_triangles
    assert refined.n_cells > 0
    assert_array_equal(refined["number"], refined["vtkOriginalCellIds"])
    strips = pyvista.Sphere(theta_resolution=10, phi_resolution=10).strip()
    assert strips.risorius.refine().is_manifold


@pytest.mark.parametrize(
    ("shape", "crease_angle", "growth", "count"),
    [
        ("Cylinder", None, 1.67, 572),
        ("Cylinder", 40.0, 1.026, 348),
        ("Cube", None, 1.84, 120),
        ("Cube", 40.0, 1.0, 12),
    ],
)
def test_creases_stay_sharp(shape, crease_angle, growth, count):
    """Edges sharper than `crease_angle` stay sharp, and other edges become round.

    The volumes are those in docs/refinement.md.
    """
    sizes = {"Cylinder": {"resolution": 16, "height": 2.0}, "Cube": {}}
    mesh = getattr(pyvista, shape)(**sizes[shape])
    refined = mesh.risorius.refine(crease_angle=crease_angle)
    assert refined.n_cells == approx(count, abs=20 if crease_angle is None else 4)
    closed = refined.clean()
    assert closed.n_open_edges == 0
    own = mesh.triangulate().clean().volume
    assert closed.volume == approx(growth * own, rel=0.005)


def padded(cells):
    """Cells in VTK's form: the number of points before each cell."""
    return [number for cell in cells for number in (len(cell), *cell)]


def test_cells_that_are_no_triangles():
    """Triangles keep the data of their cells if the mesh also has lines and single points."""
    points = np.array([[0, 0, 0], [0.5, 0.5, 0], [1, 0, 0], [1.01, 0, 0], [0.5, 1, 0.3]], float)
    mesh = pyvista.PolyData(points, padded([[0, 1, 2], [1, 3, 2], [0, 4, 1]]))
    mesh.cell_data["region"] = [1, 2, 3]
    mesh = mesh.clean(tolerance=0.05)
    assert mesh.n_lines == 1
    assert set(mesh.risorius.refine()["region"].tolist()) == {1, 3}


@pytest.mark.parametrize("seed", range(6))
def test_cells_of_all_kinds(seed):
    """Each triangle belongs to the cell at its height."""
    generator = np.random.default_rng(seed)
    points = []
    kinds = [[], [], [], []]
    sizes = (1, 2), (2, 5), (3, 7), (3, 8)  # of lone points, lines, polygons and strips
    for kind, (least, most) in enumerate(sizes):
        for _ in range(generator.integers(0 if kind == 0 else 1, 5)):
            size = int(generator.integers(least, most))
            height = float(sum(map(len, kinds)))
            first = len(points)
            for k in range(size):
                turn = 2.0 * np.pi * k / size
                strip = [k, k % 2, height]
                points.append(strip if kind == 3 else [np.cos(turn), np.sin(turn), height])
            kinds[kind].append(list(range(first, first + size)))
    mesh = pyvista.PolyData()
    mesh.points = np.array(points)
    for name, cells in zip(("verts", "lines", "faces", "strips"), kinds, strict=True):
        if cells:
            setattr(mesh, name, padded(cells))
    heights = np.arange(mesh.n_cells, dtype=float)
    mesh.cell_data["height"] = heights
    refined = mesh.risorius.refine(criterion="normal")
    shown = refined.points[refined.regular_faces][..., 2]
    assert_array_equal(shown, np.repeat(refined["height"][:, None], 3, axis=1))
    surfaces = len(kinds[2]) + len(kinds[3])
    assert len(np.unique(refined["vtkOriginalCellIds"])) == surfaces


def test_polygons_that_vtk_leaves_holes_in():
    """A polygon with collinear or repeated points is covered.

    A polygon of two points is left out.
    """
    points = np.array([[0, 0, 0], [1, 0, 0], [2, 0, 0], [3, 0, 0], [0, 1, 0], [3, 1, 0]], float)
    polygons = [[0, 1, 2, 3], [0, 1], [0, 1, 2, 3, 5, 4], [4, 5, 5, 0]]
    mesh = pyvista.PolyData(points, padded(polygons))
    refined = mesh.risorius.refine(criterion="normal")
    assert np.bincount(refined["vtkOriginalCellIds"], minlength=4).tolist() == [2, 0, 4, 1]
    mesh.faces = padded([[0, 1, 2], [0, 1, 7, 8]])
    with pytest.raises(ValueError, match="points from 0 to 5, but they name 0 to 8"):
        mesh.risorius.refine()


def test_many_frames(capsys):
    """Frames are yielded one by one as separate meshes, with a progress bar on request."""
    mesh = plane()
    heights = (0.0, 0.1, 0.2)
    refiner = mesh.risorius.refiner()
    frames = list(refiner.refine_all([wavy(mesh, height) for height in heights], progress_bar=True))
    assert "Refining" in capsys.readouterr().err
    assert [round(float(np.ptp(frame.points[:, 2])), 1) for frame in frames] == [0.0, 0.2, 0.4]
    assert not capsys.readouterr().err
    assert len(list(refiner.refine_all(iter([mesh])))) == 1
    assert not capsys.readouterr().err


def test_one_topology_for_all_frames():
    """With `fixed=True` all frames have the same points and cells in the same order."""
    mesh = plane()
    frames = [wavy(mesh, height) for height in (0.0, 0.1, 0.3)]
    refiner = mesh.risorius.refiner(scheme="loop", criterion="normal")
    changing = list(refiner.refine_all(frames))
    fixed = list(refiner.refine_all(iter(frames), fixed=True))
    assert len({each.n_cells for each in changing}) == 3
    for each in fixed:
        np.testing.assert_array_equal(each.regular_faces, fixed[0].regular_faces)
        np.testing.assert_array_equal(each.cell_data["number"], fixed[0].cell_data["number"])
        np.testing.assert_array_equal(each.point_data["speed"], fixed[0].point_data["speed"])
    assert fixed[0].n_cells >= max(each.n_cells for each in changing)


def test_mistakes_are_reported():
    """Errors are as in PyVista: MissingDataError for a mesh without faces, else ValueError.

    A ValueError has both sizes.
    """
    mesh = plane()
    with pytest.raises(pyvista.MissingDataError, match="mesh has no faces"):
        pyvista.Line().risorius.refine()
    with pytest.raises(pyvista.MissingDataError, match="mesh has no faces"):
        pyvista.PolyData().risorius.refiner()
    refiner = mesh.risorius.refiner()
    with pytest.raises(ValueError, match="has 288 cells, but the mesh at rest 144"):
        refiner.refine(mesh.triangulate())
    with pytest.raises(ValueError, match=r"169 points .* got shape \(168, 3\)"):
        refiner.refine(mesh.points[1:])
    with pytest.raises(ValueError, match="unknown option 'tresholds'"):
        mesh.risorius.refine(tresholds=1)
    with pytest.raises(AttributeError):
        pyvista.ImageData(dimensions=(2, 2, 2)).risorius  # noqa: B018


def test_the_examples_of_the_docstrings():
    """The examples in docstrings run unchanged, without plots."""
    import risorius.pyvista

    finder = doctest.DocTestFinder(exclude_empty=True)
    runner = doctest.DocTestRunner()
    count = 0
    for found in finder.find(risorius.pyvista, "risorius.pyvista"):
        found.examples = [each for each in found.examples if ".plot(" not in each.source]
        count += len(found.examples)
        runner.run(found)
    assert count > 8
    assert runner.summarize().failed == 0


def test_point_data_of_every_frame():
    """Point data that change with frames have each frame's values and type, linear along edges."""
    plate = pyvista.Plane(i_resolution=6, j_resolution=6)
    refiner = plate.risorius.refiner(scheme="loop", criterion="normal")
    for time in (0.0, 0.7, 1.3):
        frame = plate.copy()
        frame.points[:, 2] = 0.1 * np.sin(9.0 * plate.points[:, 0] + time)
        frame["heat"] = plate.points[:, 0].astype(np.float64) + time
        frame["label"] = np.full(plate.n_points, 2**60 + int(10 * time))
        refined = refiner.refine(frame)
        assert refined.n_points > plate.n_points
        assert refined["heat"].dtype == np.float64
        np.testing.assert_array_equal(refined["label"], frame["label"][0])
        off = np.abs(
            refined["heat"] - time - refined.points[:, 0]
        )  # loop moves points little in the plane
        assert off.max() < 0.05
        np.testing.assert_array_equal(refined["heat"][: plate.n_points], frame["heat"])
