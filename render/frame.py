"""All inputs of a picture as a value: view, style, mesh, parts and overlays.

`Renderer.draw` draws frames; the same frame always gives the same picture. Parts keep the shape
that they had when the frame was made. The mesh lies in the buffers of a stream, so a frame can be
drawn until the stream is filled again.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Protocol, Self

from ..geometry.arrays import Floats32, Floats64, Integers32, Unsigned8
from .camera import CameraView
from .lines import Lines
from .opening import Opening
from .shade import Shade
from .stream import MeshBuffers, UploadedMesh
from .style import Style
from .texture import BumpMap, SkinTexture

CutPlane = tuple[float, float, float, float]  # (a, b, c, d); a x + b y + c z + d > 0 is in front


class DrawnPart(Protocol):
    """The attributes of a part that the renderer reads.

    - name: name in messages.
    - vertices, normals: (n, 3), float32. A deformable part returns new arrays of the same shape
      after each change.
    - faces: vertex indices, counter-clockwise from outside, (m, 3), int32. Back faces do not show.
    - colours: sRGB, 0 to 1, (n, 3), float32.
    - bone: name of the bone whose transform moves the part.
    - shine: specular strength, 0 (dull) to 1 (wet).
    - is_enclosed: whether another surface encloses the part, so that no light arrives from behind.
    - strand_radius: radius of the strands [unit of the scene]; 0 for a solid part.
    - striation: coordinates of the vertices across and along fibres [mm], (n, 2), or None. Shells
      have shape (n, 7), with further columns: the vector from root to tip [mm], the density, and
      the fray, from 0 for smooth outlines to 1, or to -1 for ragged hems. The vertices of shells
      lie at 0.6 of this vector. Locks have shape (n, 5): the unit vector along the lock, half its
      width [mm] with the side of the vertex as its sign, and the opacity.
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
    """A part at a position, with the shape that it has when this object is made.

    - transform: matrix from the part to the world, for column vectors, (4, 4).
    - lies_beneath: whether the part lies under the skin. Closed skin then hides the part, even
      where the part comes out of the skin.
    - throws_shadow: whether the part throws a shadow on other parts and on the skin.
    - opening: opening through which light reaches the part; None: light comes from all around.
    - vertices, normals, colours: arrays of the part.
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
    def on_bone(
        cls,
        part: DrawnPart,
        transforms: Mapping[str, Floats64],
        *,
        lies_beneath: bool = False,
        throws_shadow: bool = False,
        opening: Opening | None = None,
    ) -> Self:
        """Place a part by the matrix of its bone; if the bone has no matrix, raises ValueError."""
        if part.bone not in transforms:
            raise ValueError(
                f"part '{part.name}' moves with bone '{part.bone}'; transforms has only "
                f"{', '.join(sorted(transforms)) or 'none'}"
            )
        return cls(part, transforms[part.bone], lies_beneath, throws_shadow, opening)


@dataclass(frozen=True, eq=False)
class SkinMaps:
    """The textures of a skin.

    - texture: albedo of the front side, and fine shape, which needs the columns of gradients. An
      untextured style hides the albedo.
    - bumps: furrows, which only per-pixel shading shows. Their strength is a product of the style's
      `bumps` and of amounts per vertex.
    """

    texture: SkinTexture | None = None
    bumps: BumpMap | None = None


NO_MAPS = SkinMaps()
"""The maps of a skin in one colour, without a texture."""


@dataclass(frozen=True, eq=False)
class Skin:
    """The mesh of a frame: the last upload of a stream, with maps and colours.

    - maps: textures; they need a stream of at least 8 columns, else ValueError is raised.
    - values: a number for each triangle, which decides its colour (see `ColourBy`), (M,), uint8;
      needed unless the style has `ColourBy.NONE`.
    - fading: points around the part of the mesh that fades, (n, 3); None: nothing fades. The stream
      must have columns 17 and 18, which give the fading, else ValueError is raised.
    - mouth: the rim of the lips, as `Opening.rim`; None: there are no lips. Behind it the inner
      side of the mesh is dark. Elsewhere the inner side of a mesh with a fading neck is hidden.
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
                "the stream of this frame was filled again since the frame was made; make the "
                "frame after an upload, and draw it before the next upload"
            )

    def shown_maps(self, style: Style) -> dict[BumpMap, float]:
        """Return the maps that tilt normals in a style, each with its strength, 0 to 1."""
        shown = {}
        if self.maps.bumps is not None and style.shows_bumps and self.stream.has_bumps:
            shown[self.maps.bumps] = style.bumps
        fine = None if self.maps.texture is None else self.maps.texture.fine_shape
        if fine is not None and style.shows_fine_shape and self.stream.has_gradients:
            shown[fine] = 1.0
        return shown


@dataclass(frozen=True, eq=False)
class Frame:
    """The content of one viewport.

    - style: shading, colours, background, and opacity of the skin.
    - cut: plane; in front of it a translucent skin is opaque.
    - overlays: lines and shades that are drawn over everything.
    """

    view: CameraView
    style: Style
    skin: Skin | None = None
    parts: Sequence[PlacedPart] = ()
    cut: CutPlane | None = None
    overlays: Sequence[Lines | Shade] = ()

    @property
    def is_opened(self) -> bool:
        """Whether the skin is translucent and shows parts behind it."""
        return self.skin is not None and self.style.opacity < 1.0
