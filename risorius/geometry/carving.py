"""Carves lines into a height map, texel by texel."""

from ..jit import njit
from .arrays import Floats32


@njit
def carve(
    texels: Floats32,
    courses: Floats32,
    depths: Floats32,
    forms: Floats32,
    heights: Floats32,
    furrows: Floats32,
) -> None:
    """Lower a height map along furrows, and write the depths of the furrows.

    texels: for each texel its coordinate across the lines, its coordinate along them [samples], the
    length of one unit across [mm], and the visibility of lines, 0 to 1; shape (h, w, 4). courses,
    depths: coordinate across and depth [mm] of each line at its samples, shape (n, s). forms: for
    each line the half width of its furrow [mm], the half width of the broad trough around it [mm],
    and the trough's depth as a fraction of the furrow's, shape (n, 3). heights, furrows: [mm],
    shape (h, w); written.
    """
    for row in range(texels.shape[0]):
        for column in range(texels.shape[1]):
            across, along, scale, cover = texels[row, column]
            if cover <= 0.0:
                continue
            sample = int(along)
            part = along - sample
            for n in range(courses.shape[0]):
                depth = depths[n, sample] + part * (depths[n, sample + 1] - depths[n, sample])
                if depth <= 0.0:
                    continue
                course = courses[n, sample] + part * (courses[n, sample + 1] - courses[n, sample])
                width, roll, swelling = forms[n]
                off = ((across - course) * scale) ** 2
                trough = 1.0 - off / (roll * roll)
                if trough <= 0.0:
                    continue
                crease = max(1.0 - off / (width * width), 0.0)
                carved = cover * depth * crease * crease * crease
                furrows[row, column] += carved
                heights[row, column] -= carved + swelling * cover * depth * trough * trough
