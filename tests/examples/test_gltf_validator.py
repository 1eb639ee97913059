"""Khronos' validator of glTF finds no error in avatars and clips."""

import json
import os
import shutil
import subprocess
from pathlib import Path

import pytest

from tests.app.command_line import succeeded

RECORDING = Path(__file__).parents[1] / "cases" / "a_openface_units_0_to_1.csv"
# The skin has no TANGENT: where readers derive the tangents themselves, they follow its motion.
EXPECTED_WARNINGS = {"MESH_PRIMITIVE_GENERATED_TANGENT_SPACE"}


@pytest.mark.slow
@pytest.mark.parametrize(
    "command",
    [
        ("rig",),
        ("rig", "7", "--correctives", "2"),
        ("rig", "--eyes", "targets"),
        ("export", str(RECORDING)),
    ],
    ids=["built-in", "person", "eyes as targets", "clip"],
)
def test_the_validator_finds_no_error(tmp_path, command):
    """No error, and no warning except the expected one.

    RISORIUS_NODE_MODULES names the node_modules with gltf-validator.
    """
    modules = Path(os.environ.get("RISORIUS_NODE_MODULES", "none")).resolve()
    if not (modules / "gltf-validator").is_dir() or shutil.which("node") is None:
        pytest.skip("no RISORIUS_NODE_MODULES with gltf-validator, or no node")
    file = tmp_path / "made.glb"
    succeeded(*command, "-o", file, "--quiet")
    program = Path(__file__).with_name("in_gltf_validator.mjs")
    words = ["node", str(program), str(modules), str(file)]
    issues = json.loads(subprocess.run(words, check=True, capture_output=True, text=True).stdout)
    assert issues["numErrors"] == 0, issues["messages"]
    warnings = {each["code"] for each in issues["messages"] if each["severity"] == 1}
    assert warnings <= EXPECTED_WARNINGS
