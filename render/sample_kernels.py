"""Kernels of `software_mixer.py`: find edge pixels, rasterise their samples, and mix colours.

An edge pixel lies beside a pixel that shows another surface. The kernels compute the same as
coverage.glsl and mixing.glsl, but visit only edge pixels. Triangles that reach behind the camera
need no clipping. Source: Olano, Greer 1997, "Triangle scan conversion using 2D homogeneous
coordinates".
"""

from typing import NamedTuple

import numpy as np

from ..geometry.arrays import Floats64, Integers32, Unsigned8
from ..jit import njit

SAMPLE_POSITIONS = np.array([(0.375, 0.125), (0.875, 0.375), (0.125, 0.625), (0.625, 0.875)])
"""Positions x and y of samples in a pixel; as in drivers, no two share a row or a column."""

SURFACE_KIND = 0
HAIR_KIND = 1
TRIANGLE_KIND = 2  # each triangle counts as a separate surface
_LEAST_FACING = 0.05  # as in shell_layers.glsl
_FRAYED_EDGE = 0.2  # as in shell_layers.glsl
_NEIGHBOUR_OFFSETS = np.array(
    [(0, 0), (-1, 0), (1, 0), (0, -1), (0, 1)]
)  # offsets to a pixel and neighbours
_SKIN_NUMBER = 190  # smallest surface number of skin, see surface_number.glsl
_DEPTH_STEPS = 255.0 * 255.0  # number of steps of a pixel's stored depth


_Linear = tuple[float, float, float]  # a, b and c of the linear function a x + b y + c
_Edges = tuple[_Linear, _Linear, _Linear]  # edge functions; number k belongs to the edge opposite k
_Corner = tuple[float, float, float, float]  # a row of the argument `corners` of `rasterise`


class SampledPixels(NamedTuple):
    """The edge pixels of an area, row by row.

    before: number of edge pixels before each pixel of the area, (height, width + 1).
    columns, rows: positions of the edge pixels in the area, (n,).
    """

    before: Integers32
    columns: Integers32
    rows: Integers32


@njit
def _differ(first: float, second: float) -> bool:
    """Whether two surface numbers belong to different surfaces; numbers of skin vary slowly."""
    return abs(first - second) >= (12.5 if min(first, second) >= _SKIN_NUMBER else 0.5)


@njit
def find_edges(surfaces: Unsigned8, least: float, slope: float) -> SampledPixels:
    """Find the edge pixels of an area.

    surfaces: surface numbers and depths, see surface_number.glsl, (height, width, 4).
    least, slope: tolerance of depths on one surface, least + slope * depth; depths are 0 to 1.
    """
    height, width, _ = surfaces.shape
    numbers = np.empty((height + 2, width + 2), np.int32)  # padded by repeated border pixels
    depths = np.empty((height + 2, width + 2), np.int32)
    for y in range(height + 2):
        stored = surfaces[min(max(y - 1, 0), height - 1)]
        for x in range(width):
            numbers[y, x + 1] = stored[x, 0]
            depths[y, x + 1] = 255 * np.int32(stored[x, 1]) + np.int32(stored[x, 2])
        for each in (numbers[y], depths[y]):
            each[0] = each[1]
            each[width + 1] = each[width]
    before = np.empty((height, width + 1), np.int32)
    columns = np.empty(height * width, np.int32)
    rows = np.empty(height * width, np.int32)
    is_edge = np.empty(width, np.uint8)
    count = 0
    for y in range(height):
        _mark_row(numbers[y : y + 3], depths[y : y + 3], _DEPTH_STEPS * least, slope, is_edge)
        for x in range(width):
            before[y, x] = count
            if is_edge[x]:
                columns[count] = x
                rows[count] = y
                count += 1
        before[y, width] = count
    return SampledPixels(before, columns[:count].copy(), rows[:count].copy())


@njit
def _mark_row(
    numbers: Integers32, depths: Integers32, least: float, slope: float, is_edge: Unsigned8
) -> None:
    """Mark the edge pixels in the middle one of three rows, without branches.

    numbers, depths: padded rows, (3, width + 2). least: [steps of depth]. is_edge: 0 or 1,
    (width,); written.
    """
    number_below = numbers[0]
    number_here = numbers[1]
    number_above = numbers[2]
    below = depths[0]
    here = depths[1]
    above = depths[2]
    most = np.int32(0.5 * _DEPTH_STEPS)
    for x in range(len(is_edge)):
        number = number_here[x + 1]
        differs = _differ(number_here[x], number) | _differ(number_here[x + 2], number)
        differs |= _differ(number_below[x + 1], number) | _differ(number_above[x + 1], number)
        depth = here[x + 1]
        across = abs(here[x] + here[x + 2] - 2 * depth)
        along = abs(below[x + 1] + above[x + 1] - 2 * depth)
        bend = np.float32(max(across, along))
        allowed = np.float32(least) + np.float32(slope) * np.float32(depth)
        differs |= bool((bend > allowed) | (bend > most))
        is_edge[x] = differs


@njit
def rasterise(
    corners: Floats64,
    values: Floats64,
    triangles: Integers32,
    kind: int,
    numbers: tuple[float, float, float],
    has_back: bool,
    pixels: SampledPixels,
    depths: Floats64,
    seen: Floats64,
) -> None:
    """Rasterise triangles (M, 3) at the samples of edge pixels, with a depth test.

    corners: homogeneous coordinates (V, 4). Divided by the last column, the others are x and y
        [pixels of the area], and depth, 0 to 1.
    values: three numbers per vertex, (V, 3). For HAIR_KIND: density, cosine between normal and
        line of sight, and how far hair frays. For other kinds: y of the normal, distance from a
        cut, positive in front, and 0.
    kind: SURFACE_KIND, HAIR_KIND or TRIANGLE_KIND.
    numbers: the uniform `numbers` of surface_number.glsl.
    has_back: whether back faces are visible, too.
    depths: depth of each sample, (n, number of samples); written.
    seen: surface number of each sample, of the same shape; written.
    """
    for sign in (1.0, -1.0):  # fronts first, because backs behind them take little time
        if sign > 0.0 or has_back:
            _rasterise_side(sign, corners, values, triangles, kind, numbers, pixels, depths, seen)


@njit
def _rasterise_side(
    sign: float,
    corners: Floats64,
    values: Floats64,
    triangles: Integers32,
    kind: int,
    numbers: tuple[float, float, float],
    pixels: SampledPixels,
    depths: Floats64,
    seen: Floats64,
) -> None:
    """Rasterise the fronts of triangles (sign 1) or the backs (sign -1); see `rasterise`."""
    before, columns, _ = pixels
    height = before.shape[0]
    width = before.shape[1] - 1
    is_front = sign > 0.0
    for t in range(len(triangles)):
        a = _corner(corners, triangles[t, 0])
        b = _corner(corners, triangles[t, 1])
        c = _corner(corners, triangles[t, 2])
        if min(a[3], b[3], c[3]) > 0.0 and sign * _doubled_area(a, b, c) <= 0.0:
            continue
        left, right = _touched_pixels(a[0], b[0], c[0], a[3], b[3], c[3], width)
        bottom, top = _touched_pixels(a[1], b[1], c[1], a[3], b[3], c[3], height)
        if not _has_any(before, left, right, bottom, top):
            continue
        edges = _edge_function(b, c), _edge_function(c, a), _edge_function(a, b)
        volume = edges[0][0] * a[0] + edges[0][1] * a[1] + edges[0][2] * a[3]
        if not sign * volume > 0.0:
            continue
        plane = _depth_plane((a, b, c), edges, 1.0 / volume)
        slack = 0.5 * (abs(plane[0]) + abs(plane[1]))
        for y in range(bottom, top):
            for n in range(before[y, left], before[y, right]):
                x = columns[n]
                far = max(max(depths[n, 0], depths[n, 1]), max(depths[n, 2], depths[n, 3]))
                if _at(plane, x + 0.5, y + 0.5) - slack > far or not _may_touch(edges, sign, x, y):
                    continue
                number = -1.0
                for s in range(len(SAMPLE_POSITIONS)):
                    px = x + SAMPLE_POSITIONS[s, 0]
                    py = y + SAMPLE_POSITIONS[s, 1]
                    depth = _at(plane, px, py)
                    if not 0.0 <= depth <= depths[n, s] or not _is_inside(edges, sign, px, py):
                        continue
                    if number < 0.0:
                        # Drivers evaluate the number at the pixel's centre, for all its samples.
                        found = _interpolated(values, triangles, t, edges, x + 0.5, y + 0.5)
                        number = _surface_number(kind, numbers, is_front, t, found)
                        if number < 0.0:
                            break
                    depths[n, s] = depth
                    seen[n, s] = number


@njit
def _corner(corners: Floats64, vertex: int) -> _Corner:
    """Return a row of `corners` as a tuple; an array would take longer than all that follows."""
    return corners[vertex, 0], corners[vertex, 1], corners[vertex, 2], corners[vertex, 3]


@njit
def _doubled_area(a: _Corner, b: _Corner, c: _Corner) -> float:
    """Return twice the area of a triangle before the camera; negative if its back shows."""
    ax = a[0] / a[3]
    ay = a[1] / a[3]
    abx = b[0] / b[3] - ax
    aby = b[1] / b[3] - ay
    acx = c[0] / c[3] - ax
    acy = c[1] / c[3] - ay
    return abx * acy - acx * aby


@njit
def _touched_pixels(
    a: float, b: float, c: float, a_depth: float, b_depth: float, c_depth: float, count: int
) -> tuple[int, int]:
    """Return the pixels along an axis that a triangle may touch: first, and one past the last.

    a, b, c: coordinates of the corners on this axis, times their last columns. count: number of
    pixels.
    """
    if min(a_depth, b_depth, c_depth) <= 0.0:
        return 0, count
    a = a / a_depth
    b = b / b_depth
    c = c / c_depth
    low = min(a, b, c)
    high = max(a, b, c)
    if not (high >= 0.0 and low < count):  # also true for NaN
        return 0, 0
    return int(max(low, 0.0)), int(min(high + 1.0, count))


@njit
def _has_any(before: Integers32, left: int, right: int, bottom: int, top: int) -> bool:
    """Whether a rectangle has edge pixels."""
    for y in range(bottom, top):
        if before[y, left] != before[y, right]:
            return True
    return False


@njit
def _edge_function(a: _Corner, b: _Corner) -> _Linear:
    """Return the edge function from a to b, 0 on the edge; from b to a it is exactly negated."""
    x = a[1] * b[3] - b[1] * a[3]
    y = a[3] * b[0] - b[3] * a[0]
    return x, y, a[0] * b[1] - b[0] * a[1]


@njit
def _at(edge: _Linear, x: float, y: float) -> float:
    """Evaluate a linear function a x + b y + c."""
    return edge[0] * x + edge[1] * y + edge[2]


@njit
def _depth_plane(corners: tuple[_Corner, _Corner, _Corner], edges: _Edges, scale: float) -> _Linear:
    """Return the depth on a triangle as a linear function of x and y; scale: 1 / its volume."""
    x = y = rest = 0.0
    for k in range(3):
        depth = scale * corners[k][2]
        x += edges[k][0] * depth
        y += edges[k][1] * depth
        rest += edges[k][2] * depth
    return x, y, rest


@njit
def _may_touch(edges: _Edges, sign: float, x: int, y: int) -> bool:
    """Whether each edge of a triangle has a part of a pixel on its inner side."""
    for k in range(3):
        slack = 0.5 * (abs(edges[k][0]) + abs(edges[k][1]))
        if sign * _at(edges[k], x + 0.5, y + 0.5) < -slack:
            return False
    return True


@njit
def _is_inside(edges: _Edges, sign: float, x: float, y: float) -> bool:
    """Whether a point is inside a triangle; a point on an edge is in one of its two triangles."""
    for k in range(3):
        across, along, _ = edges[k]
        far = sign * _at(edges[k], x, y)
        if far < 0.0:
            return False
        if far == 0.0 and (sign * across < 0.0 or (across == 0.0 and sign * along <= 0.0)):
            return False
    return True


@njit
def _interpolated(
    values: Floats64, triangles: Integers32, triangle: int, edges: _Edges, x: float, y: float
) -> tuple[float, float, float]:
    """Interpolate the three values of a triangle's corners at a point."""
    whole = one = two = three = 0.0
    for k in range(3):
        weight = _at(edges[k], x, y)
        whole += weight
        one += weight * values[triangles[triangle, k], 0]
        two += weight * values[triangles[triangle, k], 1]
        three += weight * values[triangles[triangle, k], 2]
    return one / whole, two / whole, three / whole


@njit
def _surface_number(
    kind: int,
    numbers: tuple[float, float, float],
    is_front: bool,
    triangle: int,
    found: tuple[float, float, float],
) -> float:
    """Return the surface number (surface_number.glsl); negative where there is no surface.

    found: interpolated `values` of `rasterise`.
    """
    one, two, three = found
    if kind == HAIR_KIND:
        # As in shell_layers.glsl.
        has_edge = one >= max(0.9 * min(max(2.5 * abs(two), _LEAST_FACING), 1.0), -0.5 * three)
        frays = max(two, 0.0) < _FRAYED_EDGE * three
        return numbers[0] if has_edge and not frays else -1.0
    if not is_front:
        return numbers[2] if two >= 0.0 else -1.0
    if kind == TRIANGLE_KIND:
        return 1.0 + (numbers[0] + 37.0 * (triangle % 188)) % 188.0
    return numbers[0] + numbers[1] * min(max(0.5 + 0.5 * one, 0.0), 1.0)


@njit
def mix(
    colours: Unsigned8,
    surfaces: Unsigned8,
    pixels: SampledPixels,
    depths: Floats64,
    seen: Floats64,
    least: float,
    slope: float,
) -> Unsigned8:
    """Mix the colours (height, width, 4) of edge pixels by their samples; see mixing.glsl.

    depths: 0 to 1 over the depth range of the view, (n, number of samples). Other arguments: as in
    `find_edges` and `rasterise`.
    """
    height, width, _ = colours.shape
    mixed = colours.copy()
    for n in range(len(pixels.columns)):
        x = pixels.columns[n]
        y = pixels.rows[n]
        own = (255.0 * surfaces[y, x, 1] + surfaces[y, x, 2]) / _DEPTH_STEPS
        allowed = min(least + slope * own, 0.5)
        red = green = blue = opaque = 0
        for s in range(len(SAMPLE_POSITIONS)):
            best = 2.0
            shown_x = x
            shown_y = y
            for k in range(len(_NEIGHBOUR_OFFSETS)):
                at_x = min(max(x + _NEIGHBOUR_OFFSETS[k, 0], 0), width - 1)
                at_y = min(max(y + _NEIGHBOUR_OFFSETS[k, 1], 0), height - 1)
                known = surfaces[at_y, at_x]
                off = abs((255.0 * known[1] + known[2]) / _DEPTH_STEPS - depths[n, s])
                if _differ(known[0], seen[n, s]):
                    off += 1.0
                if k == 0 and off <= allowed:
                    break
                if off < best:
                    best = off
                    shown_x = at_x
                    shown_y = at_y
            red += colours[shown_y, shown_x, 0]
            green += colours[shown_y, shown_x, 1]
            blue += colours[shown_y, shown_x, 2]
            opaque += colours[shown_y, shown_x, 3]
        half = len(SAMPLE_POSITIONS) // 2
        mixed[y, x, 0] = (red + half) // len(SAMPLE_POSITIONS)
        mixed[y, x, 1] = (green + half) // len(SAMPLE_POSITIONS)
        mixed[y, x, 2] = (blue + half) // len(SAMPLE_POSITIONS)
        mixed[y, x, 3] = (opaque + half) // len(SAMPLE_POSITIONS)
    return mixed
