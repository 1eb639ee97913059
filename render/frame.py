"""A picture as a value: view, style, mesh, parts and lines; `Renderer.draw` draws it.

A frame contains all inputs of its picture, so the same frame always gives the same picture. Its
parts keep the shape that they had when the frame was made. Its mesh lies in the buffers of a
stream, so a frame can be drawn until the stream is filled again.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Protocol, Self

from ..geometry.arrays import Floats32, Floats64, Integers32, Unsigned8
from .camera import CameraView
from .lines import Lines
from .opening import Opening
from .stream import MeshBuffers, UploadedMesh
from .style import Style
from .texture import BumpMap, Texture

Plane = tuple[float, float, float, float]  # (a, b, c, d): a x + b y + c z + d > 0 lies in front


class DrawnPart(Protocol):
    """The attributes of a part that the renderer reads.

    name: for messages. vertices, normals: shape (n, 3), float32. A part that is not rigid returns
    new arrays of the same shape whenever its form has changed. faces: counter-clockwise seen from
    outside, shape (m, 3), int32; back faces are not drawn. colours: sRGB 0..1, shape (n, 3),
    float32. bone: the bone whose transform moves the part. shine: 0 dull, 1 wet. is_enclosed:
    whether it lies within another surface, where no light from behind arrives. strand_radius: half
    the thickness of its strands; 0 for a solid part. striation: place of each vertex across and
    along fibres [mm], (n, 2), or None. Shells have further columns, (n, 6): the vector from root to
    tip [mm], at 0.6 of which the vertices lie, and the density.
    """

    @property
    def name(self) -> str: ...
    @property
    def vertices(self) -> Floats32: ...
    @property
    def normals(self) -> Floats32: ...
    @property
    def faces(self) -> Integers32: ...
    @property
    def colours(self) -> Floats32: ...
    @property
    def bone(self) -> str: ...
    @property
    def shine(self) -> float: ...
    @property
    def is_enclosed(self) -> bool: ...
    @property
    def strand_radius(self) -> float: ...
    @property
    def striation(self) -> Floats32 | None: ...


@dataclass(frozen=True, eq=False)
class PlacedPart:
    """A part with the place and shape that it has when this object is created.

    transform: from the part to the world, for column vectors, shape (4, 4).
    lies_beneath: whether the part belongs under the skin: closed skin hides it, even where the part
    comes out. throws_shadow: whether it throws a shadow on other parts and on the skin. opening:
    the opening through which light reaches it; None: light comes from all around. vertices,
    normals, colours: those of the part.
    """

    part: DrawnPart
    transform: Floats64
    lies_beneath: bool = False
    throws_shadow: bool = False
    opening: Opening | None = None
    vertices: Floats32 = field(init=False)
    normals: Floats32 = field(init=False)
    colours: Floats32 = field(init=False)

    def __post_init__(self) -> None:
        for name in ("vertices", "normals", "colours"):
            object.__setattr__(self, name, getattr(self.part, name))

    @classmethod
    def of(
        cls,
        part: DrawnPart,
        transforms: Mapping[str, Floats64],
        *,
        lies_beneath: bool = False,
        throws_shadow: bool = False,
        opening: Opening | None = None,
    ) -> Self:
        """A part in the place given by the matrix of its bone; ValueError without a matrix."""
        if part.bone not in transforms:
            raise ValueError(
                f"part '{part.name}' moves with bone '{part.bone}'; transforms has only "
                f"{', '.join(sorted(transforms)) or 'none'}"
            )
        return cls(part, transforms[part.bone], lies_beneath, throws_shadow, opening)


@dataclass(frozen=True, eq=False)
class SkinMaps:
    """The images on a skin.

    texture: the albedo of its front side, unless the style is not textured, and its fine shape.
    bumps: furrows, as far as style and uploaded amounts show them; per-pixel shading alone has
        them.
    """

    texture: Texture | None = None
    bumps: BumpMap | None = None


NO_MAPS = SkinMaps()
"""The maps of a skin in one colour, without a texture."""


@dataclass(frozen=True, eq=False)
class Skin:
    """The mesh of a frame: the last upload of a stream, with its maps and colours.

    maps: they need a stream of 8 columns or more, ValueError else.
    fading: points around the part of the mesh that fades by columns 17 and 18, (n, 3); None:
    nothing fades. They need a stream of 18 columns, ValueError else. mouth: the rim of its lips,
    see `Opening.rim`: through the lips the inner side of a neck shows that is hidden where it
    fades; None: there are no lips. values: the number that colours each triangle, see `ColourBy`,
    shape (M,), uint8; needed unless the style has `ColourBy.NONE`.
    """

    stream: MeshBuffers
    maps: SkinMaps = NO_MAPS
    fading: Floats64 | None = None
    values: Unsigned8 | None = None
    mouth: Floats64 | None = None
    mesh: UploadedMesh = field(init=False)
    """The upload that this skin shows."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "mesh", self.stream.mesh)
        if self.maps.texture is not None or self.maps.bumps is not None:
            self.stream.check_uv()
        if self.fading is not None:
            self.stream.check_fade()

    def check(self) -> None:
        """Raise ValueError if the stream now holds another mesh."""
        if self.stream.mesh is not self.mesh:
            raise ValueError(
                "the stream of this frame was filled anew since the frame was made; make the frame "
                "after the upload, and draw it before the next one"
            )

    def shown_maps(self, style: Style) -> dict[BumpMap, float]:
        """Map of fine shape that tilts normals in a style, and the strength of each map, 0 to 1."""
        shown = {}
        if self.maps.bumps is not None and style.shows_bumps and self.stream.has_bumps:
            shown[self.maps.bumps] = style.bumps
        fine = None if self.maps.texture is None else self.maps.texture.fine_shape
        if fine is not None and style.shows_fine_shape:
            shown[fine] = 1.0
        return shown


@dataclass(frozen=True, eq=False)
class Frame:
    """The content of one viewport.

    style: shading and colours, with the background and the opacity of the skin.
    cut: in front of it a translucent skin is opaque.
    overlays: lines that are drawn over everything.
    """

    view: CameraView
    style: Style
    skin: Skin | None = None
    parts: Sequence[PlacedPart] = ()
    cut: Plane | None = None
    overlays: Sequence[Lines] = ()

    @property
    def is_opened(self) -> bool:
        """Whether parts are seen through the skin."""
        return self.skin is not None and self.style.opacity < 1.0
