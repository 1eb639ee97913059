"""Tables and rules of the method, for authors who port it: to a graphics card, to another language,
or to a criterion that treats borders.

Kähler, Haber, Seidel 2003, sections 4.1 to 4.4. All of this is found once per mesh, and a user of a
refiner needs none of it. `refine_gl` uses only `risorius.refine` and this module.
"""

from .beyond.blending import FAN_TABLE, RAMP_WIDTH
from .beyond.cubic import STEEPENING_SHARE
from .beyond.displacement import GROWTH_SHARE
from .beyond.measuring import mean_length
from .beyond.options import criterion_of
from .border.rows import GEOMETRY_COLUMNS, wedge_values
from .kahler.coherence import sequence_tables
from .kahler.criterion import find_undefined_normals
from .kahler.refiner import points_on_edges
from .kahler.table import CENTRE_POINT, CONFIGURATION_TABLE
from .mesh.borders import border_neighbours, follow_borders
from .mesh.normals import weigh_corners
from .mesh.rings import vertex_rings

__all__ = [
    "CENTRE_POINT",
    "CONFIGURATION_TABLE",
    "FAN_TABLE",
    "GEOMETRY_COLUMNS",
    "GROWTH_SHARE",
    "RAMP_WIDTH",
    "STEEPENING_SHARE",
    "border_neighbours",
    "criterion_of",
    "find_undefined_normals",
    "follow_borders",
    "mean_length",
    "points_on_edges",
    "sequence_tables",
    "vertex_rings",
    "wedge_values",
    "weigh_corners",
]
