"""The style of a frame: shading, colours, wireframe, light and background.

Source: Kähler et al. 2003, section 5: pictures with flat and Gouraud shading, and triangles
coloured by their number of splits. Per-pixel lighting, skin and backgrounds are additions. All
colours are sRGB, 0 to 1; the shaders convert them to linear light.

The scene has a key light, which throws shadows, a fill light, a rim light, and the ambient light of
a hemisphere. All lights move with the camera, as in a studio where only the head turns.
"""

from dataclasses import dataclass
from enum import Enum
from typing import Self

from ..geometry.arrays import Floats64

Colour = tuple[float, float, float]


class Shading(Enum):
    """The elements for which light is computed: triangles, vertices or pixels."""

    FLAT = "flat"  # triangles, with geometric normals, so that every facet shows
    GOURAUD = "gouraud"  # vertices; colours are interpolated, as in the paper's pictures
    PIXEL = "pixel"  # pixels, with interpolated normals


class ColourBy(Enum):
    """The quantity that decides the colour of a triangle."""

    NONE = "none"  # the texture, or the albedo of the style
    SPLITS = "splits"  # the number of splits of the edges of the base triangle, 0 to 6
    SPLIT_WIRES = "split wires"  # the same number, shown by outlines of split triangles

    @classmethod
    def from_switches(cls, *, splits: bool, wires: bool) -> Self:
        """Return the member for two switches; if both are set, `splits` decides."""
        if splits:
            return cls.SPLITS
        return cls.SPLIT_WIRES if wires else cls.NONE


# Albedos, chosen by eye under this package's light.
SKIN: Colour = (0.79, 0.625, 0.545)
FLESH: Colour = (0.60, 0.27, 0.25)  # inside of lids and mouth
INNER_FACTOR = 0.75  # factor on the front's albedo for the back side, if it is not skin
WARM_RATIO = 0.8  # warmth from which an albedo counts as skin
CLAY: Colour = (0.74, 0.74, 0.73)  # like the plain grey of the paper's pictures

# Colours of triangles whose edges have 1 to 6 splits in total. They run from green to indigo, hues
# that skin does not have. They become darker, so their order also shows without hue.
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
    """A soft gradient behind the scene, from `centre` behind the head to `edge` in the corners."""

    centre: Colour
    edge: Colour


@dataclass(frozen=True, eq=False)
class MapBackground:
    """An environment map behind a scene, which moves with the camera.

    - radiance: as in `LightMap`, (H, W, 3).
    - turn: rotation to the viewer's right [deg].
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
    """The light of a scene; the default is a studio, for which all other values were chosen.

    - to_key, to_fill: unit vectors toward the lights in view space (x right, y up, z to the
      viewer).
    - key, fill, rim: colours of these lights, linear.
    - sky, ground: colours of the ambient light from above and from below, linear.
    - around: nine coefficients that replace sky and ground (see light_map.py); empty: none.
    """

    to_key: Vector = (-0.5300, 0.6300, 0.5677)  # from behind the viewer's left shoulder
    to_fill: Vector = (0.7770, 0.0600, 0.6266)
    key: Vector = (1.16, 1.11, 1.05)
    fill: Vector = (0.17, 0.158, 0.152)
    rim: Vector = (0.66, 0.645, 0.65)  # from behind the head, at the viewer's right
    sky: Vector = (0.215, 0.215, 0.225)
    ground: Vector = (0.125, 0.095, 0.083)
    around: tuple[Vector, ...] = ()


@dataclass(frozen=True, kw_only=True)
class Style:
    """How a mesh, its parts and the background behind them are drawn."""

    shading: Shading = Shading.PIXEL
    wireframe: bool = False
    colour_by: ColourBy = ColourBy.NONE
    albedo: Colour = SKIN  # albedo of the front side
    opacity: float = 1.0  # opacity of the skin, 0 to 1
    textured: bool = True  # whether a texture replaces the albedo
    gloss: float = 0.5  # strength of the skin's highlight, 0 to 1
    shadows: bool = True  # whether the key light throws shadows
    skin_maps: bool = True  # whether fine shape and ambient occlusion of a texture show
    bumps: float = 1.0  # strength of a bump map, 0 to 1
    light: Light = Light()
    background: Background | MapBackground | None = LIGHT  # None: transparent
    wire_colour: Colour = (0.07, 0.08, 0.12)
    wire_width: float = 1.0  # [pixels at scale 1]; more pixels on a dense screen
    wire_opacity: float = 0.5

    @property
    def scattering(self) -> float:
        """Strength of subsurface scattering, 0.25 to 1; it is 1 for an albedo as warm as skin."""
        return max(self._warmth, 0.25)

    @property
    def inside(self) -> Colour:
        """The albedo of the back side: red flesh for a skin, darker clay for clay."""
        warmth = min(self._warmth / WARM_RATIO, 1.0)
        red, green, blue = (
            warmth * flesh + (1.0 - warmth) * INNER_FACTOR * front
            for flesh, front in zip(FLESH, self.albedo, strict=True)
        )
        return red, green, blue

    @property
    def has_wires(self) -> bool:
        """Whether outlines of triangles are drawn."""
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
