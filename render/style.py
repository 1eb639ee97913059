"""The style of a frame: shading, colours, wireframe, background.

Source: Kähler et al. 2003, section 5: flat and Gouraud shaded pictures, and triangles coloured by
how far they were split. Per-pixel lighting, skin and backgrounds are additions.
All colours are sRGB, 0..1; the shaders turn them into linear light.

Light comes from a key, which throws shadows, a fill, a rim and a hemisphere of ambient. All lights
move with the camera, as in a studio where the camera stands still and the head turns.
"""

from dataclasses import dataclass
from enum import Enum
from typing import Self

from ..geometry.arrays import Floats64

Colour = tuple[float, float, float]


class Shading(Enum):
    """Where the lighting is computed."""

    FLAT = "flat"  # once per triangle: the geometric normal, every facet shows
    GOURAUD = "gouraud"  # once per vertex, interpolated: the paper's pictures
    PIXEL = "pixel"  # once per pixel, with interpolated normals


class ColourBy(Enum):
    """The quantity that decides the colour of a triangle."""

    NONE = "none"  # the texture, or the albedo of the style
    SPLITS = "splits"  # how many splits the edges of its source triangle have: 0..6
    SPLIT_WIRES = "split wires"  # the same, but on outlines; unsplit triangles have none

    @classmethod
    def of(cls, *, splits: bool, wires: bool) -> Self:
        """The colours for two switches; colours by splits hide wires."""
        if splits:
            return cls.SPLITS
        return cls.SPLIT_WIRES if wires else cls.NONE


# Albedos, chosen by eye under this package's light.
SKIN: Colour = (0.79, 0.625, 0.545)
FLESH: Colour = (0.60, 0.27, 0.25)  # inside of lids and mouth
INNER_SHARE = 0.75  # of a cold albedo, on the back side
WARM_RATIO = 0.8  # from which an albedo counts as that of skin
CLAY: Colour = (0.74, 0.74, 0.73)  # like the plain grey of the paper's pictures

# Colour of a triangle whose edges have 1..6 splits in all; 0 keeps the albedo. Green to indigo,
# increasingly dark: hues that skin does not have, in an order that greyscale and colour blindness
# preserve.
SPLIT_PALETTE: tuple[Colour, ...] = (
    (0.76, 0.89, 0.62),
    (0.46, 0.79, 0.66),
    (0.21, 0.65, 0.71),
    (0.14, 0.48, 0.70),
    (0.19, 0.31, 0.62),
    (0.25, 0.14, 0.46),
)


@dataclass(frozen=True)
class Background:
    """A soft gradient behind the scene: `centre` behind the head, `edge` in the corners, sRGB."""

    centre: Colour
    edge: Colour


@dataclass(frozen=True, eq=False)
class MapBackground:
    """A map of light behind a scene, in the form of `LightMap`.

    It moves with the camera, as its light does. turn: angle to the viewer's right [deg].
    """

    radiance: Floats64
    turn: float = 0.0


LIGHT = Background(centre=(0.885, 0.89, 0.90), edge=(0.665, 0.68, 0.705))
DARK = Background(centre=(0.27, 0.285, 0.305), edge=(0.085, 0.09, 0.10))
BLACK = Background(centre=(0.0, 0.0, 0.0), edge=(0.0, 0.0, 0.0))
WHITE = Background(centre=(1.0, 1.0, 1.0), edge=(1.0, 1.0, 1.0))


Vector = tuple[float, float, float]


@dataclass(frozen=True, kw_only=True)
class Light:
    """The light of a scene; the default is the studio's, for which all other values were chosen.

    to_key, to_fill: unit vectors toward the lights, in view space (x right, y up, z to the viewer).
    key, fill, rim: linear light of each; sky, ground: of the ambient light from above and below.
    around: nine coefficients instead of sky and ground, see light_map.py; or none.
    """

    to_key: Vector = (-0.5300, 0.6300, 0.5677)  # over the viewer's left shoulder
    to_fill: Vector = (0.7770, 0.0600, 0.6266)
    key: Vector = (1.16, 1.11, 1.05)
    fill: Vector = (0.17, 0.158, 0.152)
    rim: Vector = (0.66, 0.645, 0.65)  # from behind the viewer's right
    sky: Vector = (0.215, 0.215, 0.225)
    ground: Vector = (0.125, 0.095, 0.083)
    around: tuple[Vector, ...] = ()


@dataclass(frozen=True, kw_only=True)
class Style:
    """How a mesh, its parts and the background behind them are drawn."""

    shading: Shading = Shading.PIXEL
    wireframe: bool = False
    colour_by: ColourBy = ColourBy.NONE
    albedo: Colour = SKIN  # of the front side
    opacity: float = 1.0  # of the skin, over earlier drawings
    textured: bool = True  # a texture, if there is one, replaces the albedo
    gloss: float = 0.5  # strength of the skin's highlight, 0..1
    shadows: bool = True  # of the key light
    skin_maps: bool = True  # fine shape, and less light in folds, by the texture
    bumps: float = 1.0  # strength of a bump map, if there is one; 0 = none
    light: Light = Light()
    background: Background | MapBackground | None = LIGHT  # None: transparent
    wire_colour: Colour = (0.07, 0.08, 0.12)
    wire_width: float = 1.0  # [pixels at scale 1]; a window on a dense screen draws it wider
    wire_opacity: float = 0.5

    @property
    def scattering(self) -> float:
        """Spread of light past the border of shade, up to 1 for an albedo as warm as skin."""
        return max(self._warmth, 0.25)

    @property
    def inside(self) -> Colour:
        """The albedo of the back side: red inside of lids and mouth, darker clay behind clay."""
        warmth = min(self._warmth / WARM_RATIO, 1.0)
        red, green, blue = (
            warmth * flesh + (1.0 - warmth) * INNER_SHARE * front
            for flesh, front in zip(FLESH, self.albedo, strict=True)
        )
        return red, green, blue

    @property
    def has_wires(self) -> bool:
        """Whether outlines of triangles are drawn: of all, or of split ones."""
        return self.wireframe or self.colour_by is ColourBy.SPLIT_WIRES

    @property
    def has_numbered_triangles(self) -> bool:
        """Whether each triangle has its own colour, so that edges between triangles show."""
        return self.shading is Shading.FLAT or self.colour_by is ColourBy.SPLITS

    @property
    def shows_bumps(self) -> bool:
        """Whether a bump map is visible: only pixel shading shows it."""
        return self.bumps > 0.0 and self.shading is Shading.PIXEL

    @property
    def shows_fine_shape(self) -> bool:
        """Whether a texture's fine shape is visible: only pixel shading shows it."""
        return self.skin_maps and self.shading is Shading.PIXEL

    @property
    def _warmth(self) -> float:
        red, _, blue = self.albedo
        return min(max((red - blue) / 0.25, 0.0), 1.0)
