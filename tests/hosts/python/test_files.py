# SPDX-License-Identifier: MIT
"""Does hemibake.bake give the command's bytes, and tell what goes wrong?"""

import os
import signal
import subprocess
import sys

import pytest

import hemibake
from hemibake import places

QUICK = {"quality": "draft"}
# Fine enough that no machine finishes before it is stopped.
ENDLESS = {"element_size": 0.02, "patch_size": 0.05, "unshot": 1e-8}


def command(*arguments):
    subprocess.run([places.program(), "bake", "--quiet", *map(str, arguments)], check=True)


def test_the_program_is_the_one_of_the_wheel():
    assert str(places.HERE) in places.program()


@pytest.mark.parametrize("command", [[sys.executable, "-m", "hemibake"], [os.path.join(os.path.dirname(sys.executable), "hemibake")]])
def test_the_command_comes_along(command, room, tmp_path):
    said = subprocess.run([*command, "--version"], check=True, capture_output=True, text=True).stdout
    assert said == f"hemibake {hemibake.version()}\n"
    assert subprocess.run([*command, "bake", tmp_path / "none.glb", "-o", tmp_path / "out.glb"]).returncode == 1


def test_the_bytes_are_those_of_the_command(room, tmp_path):
    command(room, "-o", tmp_path / "a.glb", "--quality", "draft", "--exposure", "-0.5", "--no-draco")
    done = hemibake.bake(room, tmp_path / "b.glb", exposure=-0.5, no_draco=True, look=None, flat=False, **QUICK)
    assert (tmp_path / "a.glb").read_bytes() == (tmp_path / "b.glb").read_bytes()
    assert done.converged and done.path == str(tmp_path / "b.glb")
    assert done.report["color"]["exposure_ev"] == -0.5


def test_paths_and_the_report_are_kept(room, tmp_path):
    report = tmp_path / "report with space.json"
    hemibake.bake(room, tmp_path / "out.gltf", report=report, **QUICK)
    assert sorted(os.listdir(tmp_path)) == ["out.bin", "out.gltf", "report with space.json"]


def test_a_time_limit_is_no_error(room, tmp_path):
    # No machine has shot all in a millisecond.
    done = hemibake.bake(room, tmp_path / "out.glb", time=0.001, **QUICK)
    assert not done.converged and (tmp_path / "out.glb").stat().st_size > 0


def test_progress_is_reported(room, tmp_path):
    seen = []
    hemibake.bake(room, tmp_path / "out.glb", progress=lambda fraction, stage: seen.append((fraction, stage)), **QUICK)
    assert seen[-1] == (1.0, "reconstruct") and len(seen) > 2


def test_false_cancels_and_leaves_nothing(room, tmp_path):
    with pytest.raises(hemibake.Cancelled):
        hemibake.bake(room, tmp_path / "out.glb", progress=lambda *_: False, **ENDLESS)
    assert os.listdir(tmp_path) == []


def test_what_a_callback_raises_comes_out_and_nothing_is_left(room, tmp_path):
    def broken(fraction, stage):
        raise ZeroDivisionError("mine")

    with pytest.raises(ZeroDivisionError, match="mine"):
        hemibake.bake(room, tmp_path / "out.glb", progress=broken, **ENDLESS)
    assert os.listdir(tmp_path) == []


def test_a_killed_program_is_told(room, tmp_path):
    def kill(fraction, stage):
        (child,) = subprocess.run(["pgrep", "-P", str(os.getpid())], capture_output=True, text=True).stdout.split()[:1]
        os.kill(int(child), signal.SIGKILL)

    with pytest.raises(hemibake.WorkerDied, match="was ended by signal 9"):
        hemibake.bake(room, tmp_path / "out.glb", progress=kill, **ENDLESS)


@pytest.mark.parametrize(
    ("options", "error", "text"),
    [
        ({"qualty": "draft"}, hemibake.UsageError, "'--qualty=draft' is not an option of 'bake'"),
        ({"quality": "best"}, hemibake.UsageError, "--quality: 'best' is not what it takes"),
        ({"element_size": -1}, hemibake.UsageError, "--element-size: '-1' is not what it takes"),
        ({"view": "None such"}, hemibake.DataError, "None such"),
        ({"report": "/nowhere/r.json"}, hemibake.OutputError, "cannot be written"),
    ],
)
def test_a_bad_option_is_told(room, tmp_path, options, error, text):
    with pytest.raises(error, match=text):
        hemibake.bake(room, tmp_path / "out.glb", **options)
    assert os.listdir(tmp_path) == []


def test_a_bad_file_is_told(tmp_path):
    (tmp_path / "x.glb").write_bytes(b"glTF nonsense")
    with pytest.raises(hemibake.DataError, match="x.glb: "):
        hemibake.bake(tmp_path / "x.glb", tmp_path / "out.glb")
    with pytest.raises(hemibake.DataError, match="missing.glb: "):
        hemibake.bake(tmp_path / "missing.glb", tmp_path / "out.glb")
    assert os.listdir(tmp_path) == ["x.glb"]


def test_a_name_that_looks_like_an_option_is_a_name(room, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(hemibake.HemibakeError):
        hemibake.bake("--help", "out.glb")


def test_a_missing_program_is_told(room, tmp_path, monkeypatch):
    monkeypatch.setenv("HEMIBAKE", "/nowhere/hemibake")
    with pytest.raises(hemibake.LibraryMissing, match="/nowhere/hemibake"):
        hemibake.bake(room, tmp_path / "out.glb")
