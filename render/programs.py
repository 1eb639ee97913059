"""Compile GLSL files to programs: each program has one file, in which a define chooses the stage.

`#include "name.glsl"` is replaced by the text of that file. A compile error raises GLError with
file, stage and defines. All files are GLSL 330, so OpenGL 3.3 core (and 4.1 of macOS) can run them.
"""

import re
from functools import cache
from pathlib import Path
from typing import Any

import moderngl
import numpy as np
import numpy.typing as npt

from .errors import GLError

SHADER_FOLDER = Path(__file__).parent / "shaders"
_INCLUDE_LINE = re.compile(r'^#include "([\w.]+)"$', re.MULTILINE)


@cache
def shader_text(name: str) -> str:
    """Return the text of a GLSL file of this package with its includes."""
    text = (SHADER_FOLDER / name).read_text(encoding="utf-8")

    # Line numbers in the driver's messages refer to the file itself: included lines do not count.
    def fill(match: re.Match[str]) -> str:
        """Return the text of an included file."""
        line = text.count("\n", 0, match.start()) + 2
        return f"{shader_text(match.group(1))}\n#line {line}"

    return _INCLUDE_LINE.sub(fill, text)


def compile_program(
    gl: moderngl.Context, name: str, *defines: str, has_geometry_stage: bool = False
) -> moderngl.Program:
    """Compile the GLSL file `name` with some defines; an error raises GLError."""
    body = shader_text(name)
    switches = "".join(f"#define {define}\n" for define in defines)

    def stage(stage_name: str) -> str:
        """Return the text of one stage."""
        return f"#version 330 core\n#define {stage_name}_STAGE\n{switches}#line 1\n{body}"

    try:
        return gl.program(
            vertex_shader=stage("VERTEX"),
            geometry_shader=stage("GEOMETRY") if has_geometry_stage else None,
            fragment_shader=stage("FRAGMENT"),
        )
    except Exception as error:
        # The stage and the driver's first error, extracted from moderngl's long text.
        at = re.search(r"\w+(?=_shader)", str(error))
        complaint = re.search(r"(?i).*error[:( ].*", str(error))
        raise GLError(
            f"shader {' '.join([name, *defines])}, {at[0] if at else '?'} stage: "
            f"{complaint[0].strip() if complaint else '?'}. "
            "Cure: update the OpenGL driver, or set LIBGL_ALWAYS_SOFTWARE=1"
        ) from None


def write_uniform(program: moderngl.Program, name: str, values: npt.NDArray[Any]) -> None:
    """Set a uniform to a matrix for row vectors, as in pyrr, or to an array of floats."""
    uniform = program[name]
    assert isinstance(uniform, moderngl.Uniform)
    uniform.write(np.ascontiguousarray(values, np.float32).tobytes())
