"""OpenGL that fails to start: one line with the remedy, and findings instead of crashes."""

import os
import subprocess
import sys
from pathlib import Path

import moderngl
import pytest

from risorius import render
from risorius.render import programs
from risorius.render.errors import diagnose

ROOT = Path(__file__).parents[2]
on_linux = pytest.mark.skipif(
    not sys.platform.startswith("linux"), reason="EGL and its variables exist on Linux only"
)


def run_python(code, **environment):
    """Run code in a separate Python without a screen; return its output."""
    clean = {name: value for name, value in os.environ.items() if name != "DISPLAY"}
    clean.pop("WAYLAND_DISPLAY", None)
    result = subprocess.run(
        [sys.executable, "-W", "error", "-c", code],
        capture_output=True,
        text=True,
        cwd=ROOT,
        env={**clean, **environment},
        check=False,
    )
    assert result.returncode == 0, result.stderr
    return result.stdout


@on_linux
@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("GLCONTEXT_LINUX_LIBEGL", "nonexistent", r'no OpenGL driver \("nonexistent not loaded"\)'),
        ("GLCONTEXT_DEVICE_INDEX", "first", "is not a whole number.*'first'"),
        ("GLCONTEXT_GLVERSION", "990", "the driver is older.*0x3009"),
    ],
)
def test_broken_egl_is_one_line(monkeypatch, name, value, message):
    """For each environment variable that breaks EGL, one line names it with its remedy."""
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.setenv(name, value)
    with pytest.raises(render.GLError, match=f"{message}.*Cure: unset {name}") as caught:
        render.open_offscreen((8, 8))
    assert "\n" not in str(caught.value)


@on_linux
def test_a_frame_that_does_not_fit_is_one_line(monkeypatch):
    """If memory for a frame is refused, one line suggests a possible size."""

    def refused(*_):
        raise moderngl.Error("the framebuffer is not complete (INCOMPLETE_ATTACHMENT)")

    monkeypatch.setattr("risorius.render.surface.RenderTarget", refused)
    with pytest.raises(render.GLError, match=r"64 x 48 pixels .* Cure: ask for a smaller frame"):
        render.open_offscreen((64, 48))


def test_no_screen_is_one_line_without_warnings():
    """Without a screen, a window raises a GLError, and GLFW's Python warnings are suppressed."""
    output = run_python(
        "from risorius import render\n"
        "try: render.open_window((8, 8), 'test')\n"
        "except render.GLError as error: print(error)"
    )
    assert "no screen to open a window on" in output
    assert "DISPLAY" in output
    assert "Cure: run it under `xvfb-run -a`, or render offscreen" in output
    assert output.count("\n") == 1


@pytest.mark.parametrize(
    ("raw", "cure"),
    [
        ("libEGL.so not loaded", "Cure: apt install libegl1 libgl1 libgl1-mesa-dri"),
        ("requested device index 0, but found 0 devices", "Cure: apt install libegl1"),
        ("Requested OpenGL version 330, got version 210", "Cure: set LIBGL_ALWAYS_SOFTWARE=1"),
        ("X11: Failed to open display :99", "Cure: run it under `xvfb-run -a`"),
        ("GLX: Failed to create context: GLXBadFBConfig", "Cure: set LIBGL_ALWAYS_SOFTWARE=1"),
        ("Failed to load GLFW3 shared library.", "Cure: pip install '.[window]' in the checkout"),
        ("No module named 'glfw'", "Cure: pip install '.[window]' in the checkout"),
        ("", 'failed ("no reason given"). Cure: `risorius doctor`'),
        ("something\nnew", 'failed ("something new"). Cure: `risorius doctor`'),
    ],
)
def test_known_texts_have_a_cure(monkeypatch, raw, cure):
    """The library's message is kept, and one remedy follows."""
    for name in [name for name in os.environ if name.startswith("GLCONTEXT_")]:
        monkeypatch.delenv(name)
    text = str(diagnose("opening", raw))
    assert text.startswith("opening failed")
    assert cure in text


def test_shader_error_names_file_and_stage(surface, monkeypatch, tmp_path):
    """The error of a shader that does not compile names its file and stage."""
    (tmp_path / "broken.glsl").write_text(
        "#if defined(VERTEX_STAGE)\n"
        "void main() { gl_Position = vec4(0.0); }\n"
        "#elif defined(FRAGMENT_STAGE)\n"
        "out vec4 colour;\n"
        "void main() { colour = missing; }\n"
        "#endif\n"
    )
    monkeypatch.setattr(programs, "SHADER_FOLDER", tmp_path)
    with pytest.raises(render.GLError, match=r"broken\.glsl WIDE 3, fragment stage: .*missing"):
        programs.compile_program(surface.gl, "broken.glsl", "WIDE 3")


def test_probe_finds_the_driver():
    """On the test machine the probe can draw offscreen, and reports the driver's name."""
    (finding,) = render.probe(offscreen_only=True)
    assert finding.is_ok
    assert finding.message == ""
    assert finding.renderer in str(finding)
    assert finding.version[0].isdigit()
    assert finding.samples >= 1


@on_linux
def test_probe_reports_failures(monkeypatch):
    """Broken EGL and a missing screen are reported, and raise nothing."""
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    monkeypatch.setenv("GLCONTEXT_LINUX_LIBEGL", "nonexistent")
    offscreen, window = render.probe()
    assert not offscreen.is_ok
    assert "nonexistent not loaded" in str(offscreen)
    assert not window.is_ok
    assert "xvfb-run" in window.message


@on_linux
def test_probe_survives_a_crash(monkeypatch, tmp_path):
    """A driver that ends its process is reported with the exit code."""
    killer = tmp_path / "python"
    killer.write_text("#!/bin/sh\nkill -SEGV $$\n")
    killer.chmod(0o755)
    monkeypatch.setattr(sys, "executable", str(killer))
    (finding,) = render.probe(offscreen_only=True)
    assert not finding.is_ok
    assert "crashed the process that tried it" in finding.message
