"""Detection: every component of every ideal vault, whatever the seed; limits kept; nothing found where nothing is."""

from functools import cache

import numpy as np
import pytest

from families import Barrel, Dome, Groin, Lunette, Mirror, Sail, Trough
from families.void.sampling import sample
from segmentation import PRESETS, Settings, compare, detect
from segmentation.primitives.shapes import Cylinder, Plane, Sphere, Torus
from segmentation.ransac.detect import ROUNDS

# the sizes of the paper's ideal models
SAIL, BARREL, LUNETTE = Sail(6.0, 6.0, 1.0), Barrel(6.0, 9.0), Lunette(6.0, 9.0, width_ratio=0.93, springing_ratio=0.0)
TROUGH, MIRROR, GROIN, DOME = Trough(6.0, 10.0), Mirror(), Groin(6.0, 6.0), Dome(5.0)
IDEALS = (SAIL, BARREL, LUNETTE, TROUGH, MIRROR, GROIN, DOME)
ALL_KINDS = ("plane", "sphere", "cylinder", "cone", "torus")


@cache
def ideal(vault, n):
    return sample(vault, n, np.random.default_rng(0))


def cloud(vault, n=150_000, noise=0.0, seed=1):
    """Points turned about the vertical and moved, with noise [m]; normals of random sign; labels."""
    rng, made = np.random.default_rng(seed), ideal(vault, n)
    turn = np.array([[np.cos(0.3), -np.sin(0.3), 0.0], [np.sin(0.3), np.cos(0.3), 0.0], [0.0, 0.0, 1.0]])
    points = made.xyz @ turn.T + [1.3, -2.2, 0.7] + noise * rng.normal(size=made.xyz.shape)
    return points, made.normals @ turn.T * rng.choice([-1.0, 1.0], (n, 1)), made.component.astype(np.int64)


@pytest.mark.parametrize("seed", [0, 1, 2])
@pytest.mark.parametrize("vault", IDEALS, ids=lambda v: type(v).id)
def test_every_component_of_an_ideal_vault_is_found(vault, seed):
    xyz, normals, truth = cloud(vault)
    found = detect(xyz, normals, rng=np.random.default_rng(seed))
    assert len(found) == truth.max()
    assert compare(found.labels, truth).least_iou > 0.98


@pytest.mark.parametrize("vault", IDEALS, ids=lambda v: type(v).id)
def test_normals_may_be_estimated_and_points_noisy(vault):
    xyz, _, truth = cloud(vault, noise=0.003)
    assert compare(detect(xyz).labels, truth).mean_iou > 0.93


@pytest.mark.parametrize("vault", [MIRROR, DOME], ids=lambda v: type(v).id)
def test_noise_does_not_blur_the_line_where_primitives_touch(vault):
    xyz, _, truth = cloud(vault, noise=0.003)
    assert compare(detect(xyz).labels, truth).mean_iou > 0.97


def test_the_same_seed_gives_the_same_bytes_and_another_the_same_vault():
    xyz, normals, _ = cloud(GROIN)
    first, again, other = (detect(xyz, normals, rng=np.random.default_rng(seed)) for seed in (1, 1, 2))
    assert first.labels.tobytes() == again.labels.tobytes()
    assert first.shapes == again.shapes
    assert compare(other.labels, first.labels).least_iou > 0.999


def test_the_sign_of_normals_does_not_matter():
    xyz, normals, _ = cloud(DOME)
    assert detect(xyz, normals).labels.tobytes() == detect(xyz, -normals).labels.tobytes()


def test_opposite_webs_share_a_cylinder_and_are_two_components():
    xyz, normals, _ = cloud(GROIN)
    shapes = detect(xyz, normals).shapes
    assert [s.id for s in shapes] == [1, 2, 3, 4]
    assert len({s.primitive for s in shapes}) == 2
    assert [s.primitive.radius for s in shapes] == pytest.approx([3.0] * 4, abs=1e-4)


@pytest.mark.parametrize("given", [True, False], ids=["normals", "no normals"])
@pytest.mark.parametrize(("vault", "points"), [(GROIN, 20_000), (GROIN, 150_000), (DOME, 150_000)])
def test_settled_masonry_keeps_its_components_whatever_the_seed(vault, points, given):
    xyz, normals, truth = cloud(vault, points, noise=0.003)
    plan = (xyz[:, :2] - xyz[:, :2].mean(axis=0)) / np.ptp(xyz[:, :2], axis=0)
    xyz[:, 2] -= 0.025 * np.cos(3.0 * plan[:, 0] + 0.3) * np.cos(3.0 * plan[:, 1] - 0.2)
    for seed in range(6 if points < 100_000 else 3):
        found = detect(xyz, normals if given else None, rng=np.random.default_rng(seed))
        assert compare(found.labels, truth).mean_iou > 0.93


@pytest.mark.parametrize("vault", [LUNETTE, GROIN, DOME], ids=lambda v: type(v).id)
def test_more_kinds_make_no_difference(vault):
    xyz, normals, truth = cloud(vault)
    found = detect(xyz, normals, Settings(primitives=ALL_KINDS))
    assert {s.primitive.name for s in found.shapes} <= {"sphere", "cylinder"}
    assert compare(found.labels, truth).least_iou > 0.98


def test_a_torus_is_found_where_tori_are_on():
    rng = np.random.default_rng(13)
    u, v = np.pi * rng.random((2, 30_000))
    ring = 3.0 + np.cos(v)
    xyz = np.column_stack((ring * np.cos(u), ring * np.sin(u), np.sin(v))) + 0.002 * rng.normal(size=(30_000, 3))
    shapes = detect(xyz, settings=Settings(primitives=ALL_KINDS)).shapes
    assert [type(s.primitive) for s in shapes] == [Torus]
    assert (shapes[0].primitive.major, shapes[0].primitive.minor) == pytest.approx((3.0, 1.0), abs=0.001)


@pytest.mark.parametrize("vault", [SAIL, TROUGH, GROIN], ids=lambda v: type(v).id)
def test_presets_segment_their_ideal_vault(vault):
    xyz, normals, truth = cloud(vault)
    settings = PRESETS[f"{type(vault).id}-ideal"]
    found = detect(xyz, normals, settings)
    assert found.epsilon == settings.epsilon
    assert compare(found.labels, truth).least_iou > 0.98


def test_radius_limits_hold_after_the_fit_and_their_ends_belong():
    xyz, normals, _ = cloud(BARREL)
    tight = detect(
        xyz, normals, Settings(cylinder_r_min=3.0, cylinder_r_max=3.0, r_tolerance=0.0, primitives=("cylinder",))
    )
    assert [s.primitive.radius for s in tight.shapes] == [3.0]
    small = detect(xyz, normals, Settings(cylinder_r_max=2.9, r_tolerance=0.0, primitives=("cylinder",)))
    assert all(s.primitive.radius <= 2.9 for s in small.shapes)


@pytest.mark.parametrize("given", [0.002, 0.05, 30_000])
def test_a_component_has_the_minimum_support(given):
    xyz, normals, _ = cloud(LUNETTE, noise=0.003)
    found = detect(xyz, normals, Settings(min_support=given))
    assert found.shapes
    assert all(s.count >= (given if given > 1 else given * len(xyz)) for s in found.shapes)
    assert [s.count for s in found.shapes] == np.bincount(found.labels)[1:].tolist()


def test_stray_points_stay_out_and_take_nothing_away():
    rng = np.random.default_rng(6)
    xyz, normals, truth = cloud(GROIN)
    stray = rng.uniform(-4.0, 6.0, (30_000, 3))
    normal = rng.normal(size=(30_000, 3))
    found = detect(np.concatenate((xyz, stray)), np.concatenate((normals, normal)))
    assert compare(found.labels, np.concatenate((truth, np.zeros(30_000, dtype=int)))).least_iou > 0.97


def barrel_in_a_room():
    """A barrel vault with floor and two walls, noisy, and its labels: 1 for the vault, 2, 3 and 4."""
    rng = np.random.default_rng(11)
    xyz, _, truth = cloud(BARREL)
    turn = np.array([[np.cos(0.3), -np.sin(0.3), 0.0], [np.sin(0.3), np.cos(0.3), 0.0], [0.0, 0.0, 1.0]])
    floor = rng.uniform(-1.0, 1.0, (60_000, 3)) * [3.0, 4.5, 0.0] - [0.0, 0.0, 3.0]
    walls = rng.uniform(-1.0, 1.0, (60_000, 3)) * [0.0, 4.5, 1.5] - [0.0, 0.0, 1.5]
    side = np.where(rng.random(60_000) < 0.5, -1.0, 1.0)
    walls[:, 0] += 3.0 * side
    added = np.concatenate((floor, walls)) @ turn.T + [1.3, -2.2, 0.7]
    labels = np.concatenate((truth, np.full(60_000, 2), np.where(side < 0.0, 3, 4)))
    return np.concatenate((xyz, added)) + 0.003 * rng.normal(size=(len(labels), 3)), labels


def test_walls_and_floor_are_components_of_their_own():
    xyz, labels = barrel_in_a_room()
    found = detect(xyz)
    assert sorted(s.primitive.name for s in found.shapes) == ["cylinder", "plane", "plane", "plane"]
    assert compare(found.labels, labels).least_iou > 0.95


def test_where_planes_are_off_walls_are_nothing_and_no_strips_of_a_vault():
    xyz, labels = barrel_in_a_room()
    found = detect(xyz, settings=Settings(primitives=("cylinder",)))
    assert [(s.id, s.primitive.name) for s in found.shapes] == [(1, "cylinder")]
    assert found.shapes[0].count == (found.labels == 1).sum()
    assert compare(found.labels, np.where(labels == 1, 1, 0)).least_iou > 0.97


@pytest.mark.parametrize("points", [5_000, 10_000])
@pytest.mark.parametrize("vault", [LUNETTE, TROUGH, GROIN, DOME], ids=lambda v: type(v).id)
def test_a_small_cloud_falls_into_no_more_components_than_a_large_one(vault, points):
    xyz, normals, truth = cloud(vault, points)
    found = detect(xyz, normals)
    assert len(found) == truth.max()
    assert compare(found.labels, truth).mean_iou > 0.85


def test_the_search_ends_on_a_surface_that_no_primitive_is():
    rng = np.random.default_rng(12)
    x, y = rng.uniform(-5.0, 5.0, (2, 40_000))
    z = 0.1 * sum(np.sin(1.7 * k * x + k) * np.cos(1.3 * k * y + 2 * k) for k in range(1, 6))
    rounds = []
    detect(np.column_stack((x, y, z)), progress=lambda stage, _: rounds.append(stage))
    assert rounds.count("search") <= ROUNDS


def test_points_that_are_not_finite_get_no_label():
    xyz, normals, truth = cloud(GROIN)
    xyz[::5] = np.nan
    xyz[1::50, 2] = np.inf
    found = detect(xyz, normals)
    lost = ~np.isfinite(xyz).all(axis=1)
    assert (found.labels[lost] == 0).all()
    assert compare(found.labels[~lost], truth[~lost]).least_iou > 0.98


def test_duplicates_change_nothing():
    xyz, normals, truth = cloud(GROIN, 60_000)
    found = detect(np.repeat(xyz, 3, axis=0), np.repeat(normals, 3, axis=0))
    assert compare(found.labels, np.repeat(truth, 3)).least_iou > 0.98


def test_single_precision_does():
    xyz, normals, truth = cloud(DOME)
    assert compare(detect(xyz.astype(np.float32), normals.astype(np.float32)).labels, truth).least_iou > 0.98


def nothing(rng):
    t = rng.random(20_000)
    yield "no point", np.zeros((0, 3))
    yield "not finite", np.full((1000, 3), np.nan)
    yield "three points", rng.random((3, 3))
    yield "one place", np.ones((1000, 3))
    yield "a line", np.column_stack((3.0 * t, t, -t))
    yield "a volume", rng.random((20_000, 3)) * 5.0
    yield "a cluster", rng.normal(size=(20_000, 3))


@pytest.mark.parametrize(
    ("name", "xyz"), list(nothing(np.random.default_rng(7))), ids=lambda v: v if isinstance(v, str) else ""
)
def test_where_there_is_no_shape_none_is_found(name, xyz):
    found = detect(xyz)
    assert found.shapes == ()
    assert found.labels.dtype == np.uint16
    assert found.labels.shape == (len(xyz),)
    assert not found.labels.any()


def test_one_plane_is_one_plane():
    rng = np.random.default_rng(8)
    xyz = np.column_stack((rng.random((30_000, 2)) * 5.0, 0.004 * rng.normal(size=30_000)))
    shapes = detect(xyz, settings=Settings(primitives=ALL_KINDS)).shapes
    assert [type(s.primitive) for s in shapes] == [Plane]
    assert shapes[0].count == 30_000
    assert shapes[0].rms == pytest.approx(0.004, rel=0.05)


@pytest.mark.parametrize("noise", [0.0, 0.004])
def test_a_plane_is_no_giant_sphere_or_cylinder(noise):
    rng = np.random.default_rng(9)
    xyz = np.column_stack((rng.random((30_000, 2)) * 5.0, noise * rng.normal(size=30_000)))
    assert detect(xyz, settings=Settings(primitives=("sphere", "cylinder"))).shapes == ()


def test_a_hole_does_not_split_but_a_wide_gap_does():
    xyz, normal, _ = cloud(BARREL)
    middle = xyz[:, :2] - [1.3, -2.2]
    along = middle @ [-np.sin(0.3), np.cos(0.3)]
    hole = np.hypot(*middle.T) < 1.0
    gap = np.abs(along) < 1.0
    assert len(detect(xyz[~hole], normal[~hole])) == 1
    assert len(detect(xyz[~gap], normal[~gap])) == 2


def test_the_progress_is_told_stage_by_stage():
    xyz, normals, _ = cloud(GROIN, 40_000)
    told = []
    detect(xyz, normals, progress=lambda stage, shapes: told.append((stage, shapes)))
    assert [stage for stage, _ in told] == sorted(
        (s for s, _ in told), key=["thinning", "search", "refinement", "labelling"].index
    )
    assert told[0] == ("thinning", 0)
    assert told[-1] == ("labelling", 2)


@pytest.mark.parametrize(
    ("settings", "complaint"),
    [
        ({"alpha": 3.0}, r"alpha = 3 lies outside \[0.01, 1.5708\] rad"),
        ({"epsilon": 0.0}, "epsilon = 0 lies outside"),
        ({"sphere_r_min": 2.0, "sphere_r_max": 1.0}, "sphere_r_min = 2 m exceeds sphere_r_max = 1 m"),
        ({"primitives": ("ellipsoid",)}, "name at least one of plane, sphere"),
    ],
)
def test_settings_out_of_range_are_refused(settings, complaint):
    with pytest.raises(ValueError, match=complaint):
        Settings(**settings)


@pytest.mark.parametrize(
    ("xyz", "normals"), [(np.zeros((5, 2)), None), (np.zeros((5, 3)), np.zeros((4, 3)))], ids=["points", "normals"]
)
def test_arrays_of_another_shape_are_refused(xyz, normals):
    with pytest.raises(ValueError, match="shape"):
        detect(xyz, normals)


def test_every_vault_of_the_paper_has_two_presets():
    assert sorted(PRESETS) == sorted(f"{type(v).id}-{k}" for v in IDEALS for k in ("ideal", "real"))
    assert PRESETS["dome-ideal"].size_limits(Sphere.kind) == pytest.approx((4.995, 7.085))
    assert PRESETS["groin-real"].kinds == (Cylinder.kind,)
