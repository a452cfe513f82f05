# SPDX-License-Identifier: MIT
"""Are scenes of numpy arrays baked, and is what cannot be baked refused in Python's own way?"""

import gc
import json
import struct
import subprocess
import sys
import threading

import numpy as np
import pytest
from conftest import FLOOR, LAMP, SQUARE

import hemibake

# Of two facing squares, one apart: F of the centre and of a corner (differential area to a parallel square).
CENTRE, CORNER = 0.2395, 0.1385


def test_light_is_that_of_the_closed_form(squares):
    floor = squares.bake(quality="medium").mesh(0)
    centre = np.argmin(np.linalg.norm(floor.positions - [0.5, 0, 0.5], axis=1))
    corner = np.argmin(np.linalg.norm(floor.positions, axis=1))
    assert np.allclose(floor.positions[corner], 0)
    # 1 %: the mesh is medium; a corner is extrapolated, 5 %.
    assert floor.radiance[centre] == pytest.approx([0.5 * CENTRE] * 3, rel=0.01)
    assert floor.radiance[corner] == pytest.approx([0.5 * CORNER] * 3, rel=0.05)


def test_arrays_are_views_that_outlive_everything_else(squares):
    solution = squares.bake(quality="draft")
    mesh = solution.mesh(0)
    kept = mesh.radiance.copy()
    assert mesh.radiance.ctypes.data == solution.mesh(0).radiance.ctypes.data
    assert not mesh.radiance.flags.owndata and not mesh.radiance.flags.writeable
    radiance = mesh.radiance
    del solution, mesh, squares
    gc.collect()
    [np.ones(kept.shape, np.float32) for _ in range(100)]
    assert np.array_equal(radiance, kept)


def test_shapes_and_sources_agree(squares):
    mesh = squares.bake(quality="draft").mesh(0)
    n = len(mesh.positions)
    assert mesh.normals.shape == mesh.radiance.shape == mesh.source_weights.shape == (n, 3)
    assert mesh.indices.max() < n
    corners = FLOOR[SQUARE[mesh.source_triangles]]
    assert np.allclose(np.einsum("vk,vkc->vc", mesh.source_weights, corners), mesh.positions, atol=1e-6)


def test_a_transform_takes_columns_as_numpy_multiplies(squares):
    moved = hemibake.Scene(squares.context)
    grey = moved.add_material(reflectance=(0.5, 0.5, 0.5))
    light = moved.add_material(reflectance=(0, 0, 0), emission=(1, 1, 1))
    lift = np.eye(4)
    lift[1, 3] = -2
    moved.add_mesh(FLOOR + np.float32([0, 2, 0]), SQUARE, grey, transform=lift)
    moved.add_mesh(LAMP, SQUARE, light)
    a, b = moved.bake(quality="draft").mesh(0), squares.bake(quality="draft").mesh(0)
    # The same scene but for rounding of positions to float.
    assert a.radiance.max() == pytest.approx(b.radiance.max(), rel=1e-4)


@pytest.fixture
def dark_floor():
    """A floor of 2 m that faces up, grey, and nothing that emits."""
    scene = hemibake.Scene(hemibake.Context(threads=2))
    grey = scene.add_material("grey", reflectance=(0.5, 0.5, 0.5))
    scene.add_mesh(2 * FLOOR - np.float32([1, 0, 1]), SQUARE, grey, name="floor")
    return scene


def centre_of(solution):
    floor = solution.mesh(0)
    return floor.radiance[np.argmin(np.linalg.norm(floor.positions, axis=1))]


# What the middle of the floor reflects: rho E / pi. 2 %: a medium mesh of light that falls off with the distance.
@pytest.mark.parametrize(
    ("light", "irradiance"),
    [
        ({"kind": "point", "intensity": (18, 9, 0), "position": (0, 3, 0)}, (2, 1, 0)),
        ({"kind": "spot", "intensity": (18, 9, 0), "position": (0, 3, 0), "outer_cone": 0.3}, (2, 1, 0)),
        ({"kind": "spot", "intensity": (18, 9, 0), "position": (0.9, 3, 0), "outer_cone": 0.2}, (0, 0, 0)),
        ({"kind": "directional", "intensity": (4, 4, 4), "direction": (0, -1, np.sqrt(3))}, (2, 2, 2)),
        ({"kind": "directional", "intensity": (4, 4, 4), "direction": (0, -1, 0), "angular_diameter": 0.01}, (4, 4, 4)),
    ],
)
def test_lights_light_as_the_inverse_square_says(dark_floor, light, irradiance):
    assert dark_floor.add_light(**light) == 0
    solution = dark_floor.bake(quality="medium")
    assert centre_of(solution) == pytest.approx(np.array(irradiance) * 0.5 / np.pi, rel=0.02, abs=2e-3)
    assert solution.statistics["arrived"]["punctual_lights"] == 1


def test_a_sky_of_radiance_L_leaves_a_floor_as_rho_L(dark_floor):
    dark_floor.set_sky((1, 2, 3))
    # 1 %: the sky is divided into three hundred directions.
    assert centre_of(dark_floor.bake(quality="draft")) == pytest.approx([0.5, 1, 1.5], rel=0.01)


def test_a_panorama_lights_from_its_directions(dark_floor):
    # The half around +z, column 3/4: a quarter of all directions above, and half of the floor's irradiance.
    image = np.zeros((32, 64, 3), np.float64)
    image[:, 32:] = (1, 0, 2)
    dark_floor.set_sky((2, 2, 2), image)
    wall = dark_floor.add_material("wall", reflectance=(0.5, 0.5, 0.5))
    facing_z = np.float32([[0, 5, 0], [1, 5, 0], [1, 6, 0], [0, 6, 0]])
    dark_floor.add_mesh(facing_z, SQUARE, wall)
    solution = dark_floor.bake(quality="draft")
    assert centre_of(solution) == pytest.approx([0.5, 0, 1], rel=0.02, abs=1e-6)
    # All that the wall sees is bright, but for the floor below, which is small and far.
    assert solution.mesh(1).radiance.mean(axis=0) == pytest.approx([1, 0, 2], rel=0.03, abs=1e-6)


def test_attributes_reach_the_limit_surface(squares):
    grey = squares.add_material("cage")
    coordinates = FLOOR[:, [0, 2]].astype(float)
    index = squares.add_mesh(FLOOR + np.float32([3, 0, 0]), SQUARE, grey, attributes=coordinates,
                             subdivision="bilinear", subdivision_level=1, tessellation="adaptive")
    mesh = squares.bake(quality="draft").mesh(index)
    assert mesh.source_triangles is None
    assert np.allclose(mesh.attributes, mesh.positions[:, [0, 2]] - [3, 0], atol=1e-6)


def test_statistics_and_curve_have_the_names_of_the_header(squares):
    solution = squares.bake(quality="draft")
    statistics = solution.statistics
    assert statistics["scene"]["emitting_patches"] >= 1 and statistics["solver"]["converged"] is True
    assert "struct_size" not in statistics and "struct_size" not in solution.curve[0]
    assert solution.curve[-1]["shots"] == statistics["solver"]["shots"]


def test_a_negative_number_is_off(squares):
    scene = squares.bake(quality="draft", adapt_levels=-1, decimate_error=-1, memory_limit=-1).statistics["scene"]
    assert scene["coarse_elements"] == scene["elements"] and scene["triangles_decimated"] == 0


def test_progress_rises_to_one(squares):
    seen = []
    squares.bake(quality="draft", progress=lambda fraction, stage: seen.append((fraction, stage)))
    fractions = [fraction for fraction, _ in seen]
    assert fractions == sorted(fractions) and fractions[-1] == 1.0
    assert {stage for _, stage in seen} >= {"mesh", "factors", "reconstruct"}


def test_false_cancels(squares):
    with pytest.raises(hemibake.Cancelled, match="cancelled by the progress callback"):
        squares.bake(progress=lambda *_: False)


def test_what_a_callback_raises_comes_out(squares):
    def broken(fraction, stage):
        raise KeyError("my own mistake")

    with pytest.raises(KeyError, match="my own mistake"):
        squares.bake(progress=broken)
    assert squares.bake(quality="draft").statistics["solver"]["converged"], "the scene is as it was"


@pytest.mark.parametrize(
    ("positions", "indices", "material", "error", "text"),
    [
        (FLOOR * np.float32("nan"), SQUARE, 0, hemibake.DataError, "mesh 'x': a position is not a finite number"),
        (FLOOR, SQUARE + 2, 0, hemibake.DataError, "mesh 'x': an index is past its last vertex"),
        (FLOOR, SQUARE, 7, hemibake.DataError, "mesh 'x': its material is not one of the scene's"),
        (FLOOR, SQUARE.astype(float), 0, hemibake.UsageError, "indices are not numbers"),
        (FLOOR, -SQUARE.astype(int), 0, hemibake.UsageError, "indices are not numbers"),
        (FLOOR.ravel()[:-1], SQUARE, 0, hemibake.UsageError, "positions has the shape"),
        ([["a"]], SQUARE, 0, hemibake.UsageError, "positions: could not convert"),
        (FLOOR, SQUARE, -1, hemibake.UsageError, "material: "),
    ],
)
def test_a_bad_mesh_is_told(squares, positions, indices, material, error, text):
    with pytest.raises(error, match=text):
        squares.add_mesh(positions, indices, material, name="x")


@pytest.mark.parametrize(
    ("call", "error", "text"),
    [
        (lambda s: s.bake(qualty="draft"), hemibake.UsageError, "'qualty' is no field of hemi_bake_desc"),
        (lambda s: s.bake(quality="best"), hemibake.UsageError, "'best' is none of default, draft, medium"),
        (lambda s: s.bake(element_size=-1), hemibake.UsageError, "a size or target is negative"),
        (lambda s: s.bake(element_size=1e-4, max_elements=100), hemibake.DataError, "more than 100 of them"),
        (lambda s: s.add_material(reflectance=(1, 2)), hemibake.UsageError, "reflectance: 2 numbers where 3"),
        (lambda s: s.add_material(emission=(-1, 0, 0)), hemibake.DataError, "its emission is not a number"),
        (lambda s: s.add_mesh(FLOOR, SQUARE, 0, subdivision="x"), hemibake.UsageError, "'x' is none of none, catmull-clark"),
        (lambda s: s.add_mesh(FLOOR, SQUARE, 0, normals=FLOOR[:2]), hemibake.UsageError, "2 normals for 4 positions"),
        (lambda s: s.add_mesh(FLOOR, SQUARE, 0, transform=np.eye(3)), hemibake.UsageError, "transform has the shape"),
        (lambda s: s.add_light("lamp", (1, 1, 1)), hemibake.UsageError, "'lamp' is none of point, spot, directional"),
        (lambda s: s.add_light("point", (1, 1)), hemibake.UsageError, "intensity: 2 numbers where 3"),
        (lambda s: s.add_light("point", (1, 1, -1), name="x"), hemibake.DataError, "light 'x': its intensity is not"),
        (lambda s: s.add_light("spot", (1, 1, 1), direction=(0, 0, 0)), hemibake.DataError, "its direction has no length"),
        (lambda s: s.add_light("spot", (1, 1, 1), outer_cone=2), hemibake.DataError, "its cone is not"),
        (lambda s: s.set_sky((1, 1, np.nan)), hemibake.DataError, "sky: its radiance is not a number"),
        (lambda s: s.set_sky(image=np.ones((4, 3))), hemibake.UsageError, "image has the shape"),
        (lambda s: s.set_sky(image=-np.ones((2, 4, 3))), hemibake.DataError, "sky: a texel is negative"),
        (lambda s: s.set_sky(image=np.ones((0, 4, 3))), hemibake.DataError, "sky: its image is not 1 to 65536"),
        (lambda s: s.add_mesh(FLOOR, SQUARE, 0, attributes=[[1]]), hemibake.UsageError, "attributes has the shape"),
        (lambda s: hemibake.Scene(s.context).bake(), hemibake.DataError, "there is no triangle with an area"),
        (lambda s: s.bake(quality="draft").mesh(2), hemibake.UsageError, "mesh 2 is none"),
        (lambda s: s.bake(quality="draft").mesh(-1), hemibake.UsageError, "mesh -1 is none"),
    ],
)
def test_a_bad_call_is_told(squares, call, error, text):
    with pytest.raises(error, match=text):
        call(squares)


def test_calls_on_one_context_do_not_overlap(squares):
    def again(fraction, stage):
        squares.add_material()

    with pytest.raises(hemibake.HemibakeError, match="must not overlap"):
        squares.bake(progress=again)


def test_contexts_bake_at_once_and_python_goes_on():
    results, ticks = [], []

    def one():
        scene = hemibake.Scene(hemibake.Context(threads=1))
        light = scene.add_material(emission=(1, 1, 1))
        scene.add_mesh(FLOOR, SQUARE, light)
        results.append(scene.bake(quality="medium").mesh(0).radiance.tobytes())

    threads = [threading.Thread(target=one) for _ in range(4)]
    for thread in threads:
        thread.start()
    while any(thread.is_alive() for thread in threads):
        ticks.append(1)
        threading.Event().wait(0.005)
    assert len(results) == 4 and len(set(results)) == 1
    assert ticks


@pytest.mark.parametrize(
    ("library", "text"), [("/nowhere/libhemibake.so", "cannot be opened"), ("libm.so.6", "is no libhemibake of this version")]
)
def test_a_missing_or_wrong_library_is_told(library, text):
    code = "import hemibake\ntry: hemibake.Scene()\nexcept ImportError as e: print(e)"
    ran = subprocess.run([sys.executable, "-c", code], env={"HEMIBAKE_LIBRARY": library}, capture_output=True, text=True)
    assert text in ran.stdout, ran.stderr


def test_a_saved_scene_is_baked_as_the_scene_is(tmp_path, caplog):
    scene = hemibake.Scene(hemibake.Context(threads=2))
    grey = scene.add_material("grey", reflectance=(0.5, 0.4, 0.3))
    lamp = scene.add_material("lamp", reflectance=(0, 0, 0), emission=(3, 2, 1))
    floor = scene.add_mesh(FLOOR, SQUARE, grey, name="floor", transform=np.diag([2.0, 1.0, 2.0, 1.0]))
    scene.add_mesh(LAMP, SQUARE, lamp, name="lamp")
    scene.add_light("point", (5, 5, 5), position=(0.5, 0.5, 0.5))
    scene.add_light("spot", (2, 2, 2), position=(1, 0.5, 1), direction=(0.3, -1, 0.2), outer_cone=0.6)
    scene.set_sky((0.1, 0.2, 0.3))
    # By the same method, with elements of one size: what the two give is the same light.
    same = {"quality": "draft", "method": "rows", "element_size": 0.25}
    here = scene.bake(**same, decimate_error=-1.0).mesh(floor)
    options = scene.save(tmp_path / "scene.glb")
    assert options == {"environment": "0.1,0.2,0.3"} and not caplog.records
    hemibake.bake(tmp_path / "scene.glb", tmp_path / "out.glb", scene_linear=True, no_draco=True, merge_error=0, **options, **same)
    data = (tmp_path / "out.glb").read_bytes()
    size = struct.unpack("<I", data[12:16])[0]
    tree, binary = json.loads(data[20 : 20 + size]), data[28 + size :]
    attributes = tree["meshes"][0]["primitives"][0]["attributes"]

    def values(name):
        accessor = tree["accessors"][attributes[name]]
        view = tree["bufferViews"][accessor["bufferView"]]
        at = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        return np.frombuffer(binary, np.float32, 3 * accessor["count"], at).reshape(-1, 3)

    order, known = np.lexsort(values("POSITION").T), np.lexsort(here.positions.T)
    np.testing.assert_allclose(values("POSITION")[order], here.positions[known], atol=1e-6)
    np.testing.assert_allclose(values("_RADIOSITY")[order], here.radiance[known], rtol=2e-4)


def test_what_gltf_has_no_words_for_is_said(tmp_path, caplog):
    scene = hemibake.Scene()
    glass = scene.add_material("glass", reflectance=(0.1, 0.1, 0.1), transmission=(0.5, 0.5, 0.5))
    scene.add_mesh(FLOOR, SQUARE, glass)
    scene.save(tmp_path / "scene.glb")
    assert "transmission" in caplog.text


def lit_by(squares, emission, group=0, width=1.0):
    scene = hemibake.Scene(squares.context)
    grey = scene.add_material("grey", reflectance=(0.5, 0.5, 0.5))
    light = scene.add_material("light", reflectance=(0, 0, 0), emission=(emission,) * 3)
    scene.add_mesh(FLOOR * np.float32([width, 1, 1]), SQUARE, grey)
    scene.add_mesh(LAMP, SQUARE, light, light_group=group)
    return scene


def by_rays(bake):
    """What a bake by rows gives, if the library has rays."""
    try:
        return bake()
    except hemibake.DataError as error:
        if "Embree" in str(error):
            pytest.skip("a build without Embree")
        raise


def test_other_lights_are_solved_on_rows_that_were_kept(squares):
    first = by_rays(lambda: squares.bake(quality="draft", keep_rows=True))
    twice = first.relight(lit_by(squares, 2.0))
    # Twice the emission is twice the light: powers of two change no digit.
    np.testing.assert_allclose(twice.mesh(0).radiance, 2 * first.mesh(0).radiance, rtol=1e-6)
    np.testing.assert_array_equal(first.relight(squares).mesh(0).radiance, first.mesh(0).radiance)
    with pytest.raises(hemibake.DataError, match="geometry"):
        first.relight(lit_by(squares, 2.0, width=2.0))
    with pytest.raises(hemibake.DataError, match="quality"):
        first.relight(squares, quality="high")
    with pytest.raises(hemibake.UsageError, match="no rows were kept"):
        twice.relight(squares)
    with pytest.raises(hemibake.Cancelled):
        first.relight(squares, progress=lambda fraction, stage: False)


def test_groups_of_lights_add_up(squares):
    scene = lit_by(squares, 1.0, group=1)
    scene.set_sky((0.1, 0.2, 0.3), light_group=2)
    scene.add_light("point", (1, 1, 1), position=(0.5, 0.5, 0.5))
    floor = by_rays(lambda: scene.bake(quality="draft", light_groups=3)).mesh(0)
    assert floor.light_groups.shape == (3, *floor.radiance.shape)
    np.testing.assert_allclose(floor.light_groups.sum(axis=0), floor.radiance, rtol=1e-4)
    assert all(group.max() > 0 for group in floor.light_groups)
    assert squares.bake(quality="draft").mesh(0).light_groups is None
