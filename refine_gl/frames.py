"""One mesh in one OpenGL context: its buffers, its programs, and the passes of a frame.

The paper's rule takes six:

    normals     a vertex           sum of the cross products around it, of length one
    mark        an attribute edge  how often it is split; scan of its points        (4.1)
    configure   a triangle         row of the table; scan of its subtriangles       (4.3, 4.4)
    offsets     one group          scan over blocks; the command that draws it all
    place       a wedge, an attribute edge, a triangle: rows and subtriangles       (4.2, 4.3)
    quarters    an attribute edge that is split twice: its second level             (4.2)

Cubic edges and the normals of their surface have further passes before and after `mark` (rules.py).
Prefix sums number points and subtriangles in the order of `refine.Kahler`. A barrier follows each
pass. The numbers of results are not read back: they are in the draw command.
"""

from importlib.resources import files

import moderngl
import numpy as np

from risorius.geometry.arrays import Floats32, Floats64, Unsigned32
from risorius.refine import GpuStream

from .context import LEAST_VERSION, GpuError
from .rules import PASS_ELEMENTS, Rules
from .tables import Tables, groups_of

MOST_GROUPS = 65535
"""Most groups of a dispatch that OpenGL promises."""
VECTOR_BYTES = 16  # bytes
NUMBER_BYTES = 4  # bytes


class Frames:
    """Buffers and programs of one mesh in one context, which must be current in all calls."""

    def __init__(
        self, gl: moderngl.Context, tables: Tables, rules: Rules, rest_positions: Floats64
    ) -> None:
        """Upload the mesh, and measure it at rest: positions of shape (V, 3).

        Raises GpuError as `programs_of` does.
        """
        self._programs = programs_of(gl, tables, rules)
        self.gl = gl
        self._tables = tables
        sizes = tables.sizes
        self._sizes = gl.buffer(_block(tables))
        self._mesh = _buffer(gl, NUMBER_BYTES * len(tables.words))
        self._mesh.write(tables.words)
        double_bytes = 8  # bytes
        self._positions = _buffer(gl, 3 * double_bytes * sizes["vertex_count"])
        self._fields = _buffer(gl, VECTOR_BYTES * tables.field_count)
        self._work = _buffer(gl, NUMBER_BYTES * tables.work_count)
        rest_cosines = np.where(rules.undefined_edges(), -np.inf, 0.0).astype(np.float32)
        self._work.write(rest_cosines, offset=NUMBER_BYTES * sizes["rest_cosines_at"])
        self._frame = 0
        self._bind()
        self._upload_positions(rest_positions, rules.still)
        for name in rules.passes[: rules.passes.index("mark") + 1]:
            self._dispatch(name, is_rest=True)

    def run(self, positions: Floats64, metric: Floats32 | None, stream: GpuStream) -> None:
        """Refine a frame into the buffers of a stream.

        `positions`: shape (V, 3); `metric`: measured by the processor, shape (E,).
        """
        self._frame += 1
        self._bind()
        stream_buffers = {
            4: "vertex_buffer",
            5: "index_buffer",
            6: "source_buffer",
            7: "command_buffer",
        }
        for binding, name in stream_buffers.items():
            getattr(stream, name).bind_to_storage_buffer(binding)
        self._upload_positions(positions, metric)
        for name in self._programs:
            self._dispatch(name)

    def write_values(self, of_wedges: Floats32, of_edge_ends: Floats32) -> None:
        """Upload texture coordinates and attributes in place of the bound ones.

        `of_wedges`: shape (W, k); `of_edge_ends`: at both ends of attribute edges, shape (R, 2, k).
        """
        for name, values in (("wedge_values", of_wedges), ("edge_values", of_edge_ends)):
            if values.size:
                offset = NUMBER_BYTES * self._tables.sizes[f"{name}_at"]
                self._mesh.write(np.ascontiguousarray(values, np.float32), offset=offset)

    def fetch(self, name: str, count: int, size: int = NUMBER_BYTES) -> Unsigned32:
        """Return the first `count` numbers or vectors of a named result of the passes.

        This waits for the frame.
        """
        buffer = self._work if size == NUMBER_BYTES else self._fields
        start = size * self._tables.sizes[f"{name}_at"]
        return np.frombuffer(buffer.read(size * count, offset=start) if count else b"", np.uint32)

    def _bind(self) -> None:
        """Bind our buffers to the places that shaders read; other programs may use them, too."""
        self._sizes.bind_to_uniform_block(0)
        for binding, buffer in enumerate((self._mesh, self._positions, self._fields, self._work)):
            buffer.bind_to_storage_buffer(binding)

    def _upload_positions(self, positions: Floats64, metric: Floats32 | None) -> None:
        """Upload positions in double precision; the driver may still read the former ones."""
        if len(positions):
            self._positions.orphan()
            self._positions.write(positions)
        if metric is not None and len(metric):
            self._work.write(metric, offset=NUMBER_BYTES * self._tables.sizes["measured_at"])

    def _dispatch(self, name: str, *, is_rest: bool = False) -> None:
        program = self._programs[name]
        for uniform, value in (("frame", self._frame), ("is_rest", is_rest)):
            if uniform in program:
                program[uniform] = value
        program.run(groups_of_pass(name, self._tables.sizes))
        self.gl.memory_barrier()


def groups_of_pass(name: str, sizes: dict[str, int]) -> int:
    """Number of groups of threads of a pass, at least one."""
    return max([1, *(groups_of(sizes[count]) for count in PASS_ELEMENTS[name])])


def programs_of(
    gl: moderngl.Context, tables: Tables, rules: Rules
) -> dict[str, moderngl.ComputeShader]:
    """The programs of all passes.

    Raises GpuError if OpenGL is too old, the driver refuses a shader, or buffers are too small.
    """
    if gl.version_code < LEAST_VERSION:
        raise GpuError(f"OpenGL 4.3 is needed, and this context has {gl.version_code / 100:.1f}")
    sizes = tables.sizes
    largest = max(
        NUMBER_BYTES * sizes["columns"] * sizes["most_rows"],
        3 * NUMBER_BYTES * sizes["most_subtriangles"] * sizes["face_count"],
        NUMBER_BYTES * len(tables.words),
        VECTOR_BYTES * tables.field_count,
    )
    room = int(gl.info["GL_MAX_SHADER_STORAGE_BLOCK_SIZE"])
    groups = max(groups_of_pass(name, sizes) for name in rules.passes)
    if largest > room or groups > MOST_GROUPS:
        raise GpuError(
            f"a mesh of {sizes['face_count']} triangles needs buffers of {largest / 2**20:.0f} MB, "
            f"and this driver has up to {room / 2**20:.0f} MB"
        )
    return {name: _compile(gl, tables, name) for name in rules.passes}


def _buffer(gl: moderngl.Context, size: int) -> moderngl.Buffer:
    """A buffer of zeros, of one vector at least: OpenGL has no empty buffers."""
    return gl.buffer(bytes(max(size, VECTOR_BYTES)), dynamic=True)


def _block(tables: Tables) -> bytes:
    """Return the uniform block in std140: numbers of four bytes, in whole vectors of four."""
    limits = np.array(list(tables.limits.values()), np.float32).view(np.uint32)
    words = np.concatenate([limits, np.array(list(tables.sizes.values()), np.uint32)])
    return np.pad(words, (0, -len(words) % 4)).tobytes()


def shader_text(name: str) -> str:
    """The source of a shader of this package."""
    return (files(__package__) / "shaders" / f"{name}.glsl").read_text(encoding="utf-8")


def _compile(gl: moderngl.Context, tables: Tables, name: str) -> moderngl.ComputeShader:
    """The program of a pass; all meshes of a context share it."""
    if gl.extra is None:
        gl.extra = {}  # all users of a context share it
    known: dict[str, moderngl.ComputeShader] = gl.extra.setdefault(__name__, {})
    texts = [f"#line 1\n{shader_text(each)}" for each in ("common", name)]
    source = "\n".join(["#version 430 core", tables.head, *texts])
    if source not in known:
        try:
            known[source] = gl.compute_shader(source)
        except Exception as error:  # moderngl raises no class of its own
            lines = [line for line in str(error).splitlines() if "error" in line.lower()]
            complaint = " ".join((lines or [str(error)])[-1].split())
            raise GpuError(f"the driver refuses {name}.glsl: {complaint}") from None
    return known[source]
