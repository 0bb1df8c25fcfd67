"""Scans of whole buildings, parted: ceilings, soffits of arches, storeys."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from families import Annular, Barrel, Cloister, Conch, Dome, Groin, Sail, Segmental, Semicircular, Vault
from segmentation.cloud import Cloud
from vaultcad.errors import NoVaultError
from vaultcad.fit.label import ArchBand, label
from vaultcad.fit.solve import Placed
from vaultcad.pose import Pose
from vaultcad.scanner import ScannerSettings, draw, scan
from vaultcad.scanner.building import Arch, Bay, Building, BuildingScan, Place, Style, scan_building
from vaultcad.scanner.building.rows import beside, in_row
from vaultcad.survey.parting import Ceiling, Part, Parting, parted
from vaultcad.survey.patches import Patches, hung_and_other, patches_of
from vaultcad.survey.plan_grid import PlanGrid
from vaultcad.survey.soffits import Soffit, measured
from vaultcad.survey.thinned_scan import Thin, thin_scan

NAVE = Groin(4, 3.5, Semicircular(), Segmental(0.4))
SETTINGS = ScannerSettings(points=150_000, stations=4, noise=0.002, settlement=0.01, mixed=0, registration_shift=0)


def nave(vault: Vault = NAVE, bays: int = 2, z: float = 3.0) -> tuple[Bay, ...]:
    return tuple(Bay(vault, place) for place in in_row([vault] * bays, Place(0, 0, z, 0.2), 0.5))


def ambulatory() -> Building:
    """An apse and the walk about it, with arches through the round wall between them."""
    conch, ring = Conch(2.8), Annular(4.5, 0.5, np.pi)
    (x, y), (a, b) = conch.plan.centre, ring.plan.centre
    bays = Bay(conch, Place(0, 0, 4.5)), Bay(ring, Place(x - a, y - b, 2.4))
    angles = np.pi * (np.arange(4) + 0.5) / 4
    middles = [Place(x + 3.0 * np.cos(t), y + 3.0 * np.sin(t), 2.2, t - np.pi / 2) for t in angles]
    return Building("ambulatory", bays, tuple(Arch.of(Semicircular(), 1.2, p, 0.85, 0.15, 0.0) for p in middles))


def stairs() -> Building:
    """A flight between two landings, whose barrel falls away from the upper arch."""
    landing, flight = Groin(2.1, 2.1), Barrel(2.1, 4.5, slope=0.6)
    places = [Place(0, 0, 2.3)]
    for last, vault, leave in ((landing, flight, "north"), (flight, landing, "north")):
        places.append(beside(last, places[-1], leave, vault, 0.4, enter="south"))
    bays = zip((landing, flight, landing), places, (0.0, 0.0, 2.7), strict=True)
    style = Style(0.13, "jambs")
    return Building("stairs", tuple(Bay(vault, replace(p, z=f + 2.3), f, style) for vault, p, f in bays))


@cache
def surveyed(name: str) -> tuple[BuildingScan, Thin, Parting]:
    bays = nave()
    conch = Conch(1.6)
    buildings = {
        "nave and apse": (*bays, Bay(conch, beside(NAVE, bays[-1].place, "north", conch, 0.4, enter="1"))),
        "two storeys": (*nave(Sail(4, 4)), *(replace(bay, floor=5.5) for bay in nave(Sail(4, 4), z=8.0))),
        "two sails": tuple(
            Bay(Sail(2.8, 2.6, 0.74), p) for p in in_row([Sail(2.8, 2.6, 0.74)] * 2, Place(0, 0, 2, 0.2), 0.28)
        ),
        "dome on a drum": (Bay(Dome(), Place(0, 0, 4.0, 0.3)),),
        "octagon on squinches": (Bay(Cloister(8, 2.5, drum_ratio=0.6, crossing=2), Place(0, 0, 4.0, 0.3)),),
    }
    others = {"ambulatory": ambulatory, "stairs": stairs}
    building = others[name]() if name in others else Building(name, buildings[name])
    scan = scan_building(replace(building, settings=SETTINGS), rng=np.random.default_rng(3))
    xyz = scan.xyz.astype(np.float32)
    thin = thin_scan(Cloud(xyz))
    return scan, thin, parted(thin, xyz)


def owners(name: str) -> list[int]:
    """The vault that each ceiling hangs on, by its number in the truth; all but none of its points are another's."""
    from scipy.spatial import cKDTree

    scan, _, parting = surveyed(name)
    tree, found = cKDTree(scan.xyz), []
    for ceiling in parting.ceilings:
        vault = scan.vault[tree.query(ceiling.points)[1]]
        counts = np.bincount(vault[vault > 0])
        assert counts.max() > 0.98 * counts.sum()
        found.append(int(counts.argmax()))
    return sorted(found)


@pytest.mark.parametrize(
    ("name", "vaults"),
    [
        ("nave and apse", 3),
        ("two storeys", 4),
        ("dome on a drum", 1),
        ("octagon on squinches", 1),
        ("ambulatory", 2),
        ("stairs", 3),
    ],
)
def test_each_vault_is_a_ceiling_of_its_own(name: str, vaults: int) -> None:
    assert owners(name) == list(range(1, vaults + 1))


@pytest.mark.parametrize("name", ["dome on a drum", "octagon on squinches"])
def test_a_drum_does_not_part_what_hangs_under_it_from_its_dome(name: str) -> None:
    _, _, parting = surveyed(name)
    assert not parting.is_parted


@pytest.mark.parametrize(
    "seed", [1072, 1085, 1098], ids=["a cornice under squinches", "creases between webs", "benches in the corners"]
)
def test_drawn_cloister_vaults_keep_what_carries_them(seed: int) -> None:
    """Their creases had been taken for a rim that is not level, cornices and benches for what their drums stand on."""
    rng = np.random.default_rng(seed)
    vault, settings = draw(Cloister, rng)
    xyz = scan(vault, replace(settings, points=150_000, origin=(0.0, 0.0, 0.0)), rng=rng).xyz.astype(np.float32)
    largest = parted(thin_scan(Cloud(xyz)), xyz).ceilings[0].points
    assert np.ptp(largest[:, 2]) > 0.75 * vault.derived_values()["rise"]


@pytest.mark.parametrize("high", [2.3, 2.9], ids=["beside the springings", "far below them"])
def test_a_lintel_does_not_join_the_vaults_of_two_rooms(high: float) -> None:
    """Each is a barrel along y, the lintel a level square between them, 2.4 m above the floor."""
    turn, along = np.meshgrid(np.arange(0.2, np.pi - 0.2, 0.025), np.arange(-3, 3, 0.05))
    facing = np.column_stack([np.cos(turn).ravel(), np.zeros(turn.size), np.sin(turn).ravel()])
    barrel = 2 * facing + np.column_stack([np.zeros(turn.size), along.ravel(), np.full(turn.size, high)])
    square = np.stack(np.meshgrid(np.arange(-0.55, 0.55, 0.05), np.arange(-0.6, 0.6, 0.05), [2.4]), -1).reshape(-1, 3)
    points = np.concatenate([barrel + [-2.6, 0, 0], barrel + [2.6, 0, 0], square])
    normals = np.concatenate([facing, facing, np.tile([0.0, 0.0, 1.0], (len(square), 1))])
    found = parted(Thin(points, normals, np.ones(len(points)), 0.05), points.astype(np.float32)).ceilings
    assert sorted(np.sign(ceiling.points[:, 0]).mean() for ceiling in found) == [-1.0, 1.0]


def test_the_back_of_a_vault_is_none_of_its_part() -> None:
    """A barrel along y, its back 0.2 m above, which an attic under a level roof shows."""
    turn, along = (part.ravel() for part in np.meshgrid(np.arange(0.1, np.pi - 0.1, 0.02), np.arange(-3, 3, 0.05)))
    facing = np.column_stack([np.cos(turn), np.zeros(turn.size), np.sin(turn)])
    face, back = (r * facing + np.column_stack([np.zeros(turn.size), along, np.full(turn.size, 3)]) for r in (2.0, 2.2))
    roof = np.stack(np.meshgrid(np.arange(-2.5, 2.5, 0.05), np.arange(-3, 3, 0.05), [7.5]), -1).reshape(-1, 3)
    points = np.concatenate([face, back, roof])
    normals = np.concatenate([facing, facing, np.tile([0.0, 0.0, 1.0], (len(roof), 1))])
    found = parted(Thin(points, normals, np.ones(len(points)), 0.05), points.astype(np.float32)).ceilings
    vault = next(one for one in found if one.points[:, 2].max() < 6)
    assert vault.part.holds(face).mean() > 0.97
    over = np.abs(back[:, 0]) < 1.9
    assert vault.part.holds(back)[over].mean() < 0.03


def test_a_crease_parts_patches_and_a_bend_does_not() -> None:
    """Two planes that meet at 25°, and a cylinder that turns by 84°."""
    xy = np.random.default_rng(5).uniform(-2, 2, (8_000, 2))

    def patches(slant: np.ndarray, height: np.ndarray) -> int:
        facing = np.column_stack([np.sin(slant), np.zeros(len(xy)), np.cos(slant)])
        return patches_of(Thin(np.column_stack([xy, height]), facing, np.ones(len(xy)), 0.05)).count

    turn = np.radians(12.5)
    assert patches(turn * np.sign(xy[:, 0]), -np.abs(xy[:, 0]) * np.tan(turn)) == 2
    assert patches(np.arcsin(xy[:, 0] / 3), np.sqrt(9 - xy[:, 0] ** 2)) == 1


def test_windows_between_a_nave_and_its_aisle_do_not_join_them() -> None:
    """A bay of the nave's barrel along y, the head of a window in its wall below, and under that a barrel along x."""
    turn, along = np.meshgrid(np.arange(0.2, np.pi - 0.2, 0.0125), np.arange(-2.5, 2.5, 0.05))
    up, over = np.sin(turn).ravel(), np.cos(turn).ravel()
    nave = np.column_stack([over, np.zeros(up.size), up])
    y, depth = (part.ravel() for part in np.meshgrid(np.arange(-1, 1, 0.05), np.arange(3.95, 4.7, 0.05)))
    head = np.column_stack([np.zeros(y.size), 0.6 * y, np.ones(y.size)])
    aisle = np.column_stack([np.zeros(up.size), over, up])
    points = np.concatenate(
        [
            4 * nave + np.column_stack([np.zeros(up.size), along.ravel(), np.full(up.size, 5.0)]),
            np.column_stack([depth, y, 4.8 - 0.3 * y**2]),
            1.6 * aisle + np.column_stack([6.4 + along.ravel() * 0.62, np.zeros(up.size), np.full(up.size, 2.0)]),
        ]
    )
    normals = np.concatenate([nave, head / np.linalg.norm(head, axis=1)[:, None], aisle])
    found = parted(Thin(points, normals, np.ones(len(points)), 0.05), points.astype(np.float32)).ceilings
    assert [one.area > 10 for one in found[:2]] == [True, True]
    assert found[0].points[:, 2].min() > 5 > found[1].points[:, 2].max()


@pytest.mark.parametrize(("z", "hung"), [(0.0, 1), (1.6, 2)], ids=["a floor", "a ceiling"])
def test_what_is_seen_of_the_next_floor_through_a_door_hangs_over_no_room(z: float, hung: int) -> None:
    """A room with a level ceiling, and beyond its door a strip of stone that nothing is seen over or under."""

    def level(x: tuple[float, float], y: tuple[float, float], z: float) -> np.ndarray:
        return np.stack(np.meshgrid(np.arange(*x, 0.05), np.arange(*y, 0.05), [z]), -1).reshape(-1, 3)

    room, strip = ((-2.0, 2.0), (-2.0, 2.0)), ((2.4, 2.7), (-0.5, 0.5))
    points = np.concatenate([level(*room, 0.0), level(*room, 3.0), level(*strip, z)])
    up = np.tile([0.0, 0.0, 1.0], (len(points), 1))
    assert hung_and_other(Thin(points, up, np.ones(len(points)), 0.05))[0].count == hung


@pytest.mark.parametrize("heap", [0.0, 0.4, 0.8])
def test_an_earth_floor_with_heaps_hangs_over_no_room(heap: float) -> None:
    x, y = (axis.ravel() for axis in np.mgrid[-3:3:0.05, -2:2:0.05])
    waves = 0.1 * (np.sin(4 * x) + np.cos(5 * y)) + heap * np.exp(-((x - 1) ** 2) - (y + 0.5) ** 2)
    slopes = [np.gradient(waves.reshape(120, 80), 0.05, axis=axis).ravel() for axis in (0, 1)]
    vault = Barrel(4.0, 6.0, Segmental(0.2)).sample(8_000, np.random.default_rng(1))
    points = np.concatenate([np.column_stack([x, y, waves]), vault.xyz[:, [1, 0, 2]] + [0, 0, 2.4]])
    facing = np.concatenate([np.column_stack([-slopes[0], -slopes[1], np.ones(len(x))]), vault.normals[:, [1, 0, 2]]])
    facing /= np.linalg.norm(facing, axis=1)[:, None]
    hung, others = hung_and_other(Thin(points, facing, np.ones(len(points)), 0.05))
    assert hung.points[:, 2].min() > 2 > others.points[:, 2].max()


def test_soffits_are_where_the_arches_are() -> None:
    scan, _, parting = surveyed("nave and apse")
    assert len(parting.soffits) == len(scan.case["arches"]) == 2
    for told in scan.case["arches"]:
        place = np.array(told["place"][:2]) - scan.origin[:2]
        soffit = min(parting.soffits, key=lambda soffit: float(np.linalg.norm(soffit.place - place)))
        assert soffit.place == pytest.approx(place, abs=0.03)
        assert soffit.width == pytest.approx(told["width"], abs=0.02)
        assert abs(np.sin(soffit.yaw - np.radians(told["yaw_deg"]))) < 0.02


@pytest.mark.parametrize(("unseen", "found"), [([1], 2), ([1, 2], 0)])
def test_an_arch_of_an_arcade_tells_what_another_is_where_the_walk_behind_it_is_not_seen(
    unseen: list[int], found: int
) -> None:
    """An opening through a wall behind which no ceiling is seen is a window, unless it is as an arch beside it.

    The two at the ends of this arcade are half hidden themselves.
    """
    virtual, thin, parting = surveyed("ambulatory")
    arches = [virtual.case["arches"][k] for k in unseen]
    assert len(parting.soffits) == 2
    hidden = np.zeros(len(thin.points), np.bool_)
    for arch in arches:
        place, turn = np.array(arch["place"][:2]) - virtual.origin[:2], np.radians(arch["yaw_deg"])
        along, out = Soffit(place, float(turn), 0, 0, np.empty((0, 2))).local(thin.points)
        hidden |= (np.abs(along) < 1.0) & (out > 0.3) & (out < 1.5)
    left = thin.only(~hidden)
    assert len(parted(left, virtual.xyz.astype(np.float32)).soffits) == found


def test_what_crosses_a_soffit_beyond_its_edges_does_not_widen_it() -> None:
    """Webs of an octagon are as high as the arch before them at two places, 9 to 14 cm beyond its edge."""
    rng = np.random.default_rng(6)
    u, v = rng.uniform(-1.5, 1.5, 4000), rng.uniform(-0.25, 0.25, 4000)
    web = np.abs(u) > 0.9
    v[web & (rng.random(4000) < 0.2)] = rng.uniform(0.34, 0.39)
    points = np.column_stack([u, v, np.full(4000, 3.0)])
    soffit = Soffit(np.zeros(2), 0.0, 3.0, 0.44, np.array([[-1.5, 3.0], [1.5, 3.0]]))
    assert measured(measured(soffit, points), points).width == pytest.approx(0.5, abs=0.02)


def test_a_narrow_arch_over_a_tie_rod_hangs_over_the_room_below_and_a_shell_over_a_vault_does_not() -> None:
    x, y = (axis.ravel() for axis in np.mgrid[-2:2:0.05, -2:2:0.05])

    def over(width: float, low: float) -> list[int]:
        """How many points hang over a room: of a strip that wide over a floor, and of another 0.5 m over it."""
        strip = np.abs(y) < width / 2
        heights = (np.zeros(len(x)), np.full(strip.sum(), low), np.full(strip.sum(), low + 0.5))
        plans = (np.column_stack([x, y]), *[np.column_stack([x, y])[strip]] * 2)
        points = np.concatenate([np.column_stack(pair) for pair in zip(plans, heights, strict=True)])
        level = np.tile([0.0, 0.0, 1.0], (len(points), 1))
        hung, _ = hung_and_other(Thin(points, level, np.ones(len(points)), 0.05))
        return [int((hung.points[:, 2] == height).sum()) for height in (low, low + 0.5)]

    narrow, wide = (int((np.abs(y) < width / 2).sum()) for width in (0.22, 1.0))
    assert over(0.22, 2.0) == [narrow, narrow]
    assert over(1.0, 2.0) == [wide, 0]


def test_a_tie_rod_under_an_arch_neither_hides_its_soffit_nor_joins_the_vaults_beside_it() -> None:
    """What is seen of a rod is a strip as wide as its strays, from pier to pier and a little over these."""
    virtual, thin, parting = surveyed("two sails")
    (soffit,) = parting.soffits
    along, across = (axis.ravel() for axis in np.mgrid[-soffit.length / 2 - 0.4 : soffit.length / 2 + 0.4 : 0.05, -2:3])
    c, s = np.cos(soffit.yaw), np.sin(soffit.yaw)
    place = soffit.place + np.column_stack([c * along - s * 0.05 * across, s * along + c * 0.05 * across])
    rod = np.column_stack([place, np.full(len(place), soffit.curve[:, 1].min())])
    points = np.concatenate([thin.points, rod])
    normals = np.concatenate([thin.normals, np.tile([0.0, 0.0, -1.0], (len(rod), 1))])
    counts = np.concatenate([thin.counts, np.ones(len(rod))])
    tied = parted(replace(thin, points=points, normals=normals, counts=counts), np.concatenate([virtual.xyz, rod]))
    assert len(tied.soffits) == len(parting.soffits)
    assert len(tied.ceilings) == len(parting.ceilings)


def test_arches_of_two_storeys_are_all_found() -> None:
    virtual, _, parting = surveyed("two storeys")
    told = sorted(arch["place"][2] for arch in virtual.case["arches"])
    found = sorted(float(soffit.curve[:, 1].max()) for soffit in parting.soffits)
    assert len(told) == len(found) == 2
    assert found[0] < told[1] < found[1]


def test_the_points_of_a_part_are_its_vaults_and_walls_and_no_arches() -> None:
    scan, thin, parting = surveyed("nave and apse")
    for ceiling in parting.ceilings:
        own = ceiling.part.holds(scan.xyz)
        numbers = np.bincount(scan.vault[own], minlength=2)[1:]
        assert numbers.max() > 0.97 * numbers.sum()
        assert numbers.max() > 0.97 * (scan.vault == numbers.argmax() + 1).sum()
        assert (scan.arch[own] > 0).mean() < 0.02
        assert len(ceiling.part.thinned(thin).points) < len(thin.points)


def test_rooms_far_from_each_other_are_refused_before_they_take_all_memory() -> None:
    one = np.random.default_rng(0).uniform(0, 5, (3000, 3)) * [1, 1, 0]
    points = np.concatenate([one, one + [15_000, 12_000, 0]])
    thin = Thin(points, np.tile([0.0, 0.0, 1.0], (len(points), 1)), np.ones(len(points)), 0.05)
    with pytest.raises(NoVaultError, match=r"scattered over 15,005 × 12,005 m; crop the scan to one building"):
        parted(thin, points.astype(np.float32))


def test_points_on_the_faces_of_an_arch_are_its_own_as_deep_as_it_is() -> None:
    from families import Barrel

    band = ArchBand(Placed(Barrel(4.0, 0.5), Pose(0, 0, 3, 0)), 0.03, np.array([0.2, np.nan]))
    soffit, south, north = (0.0, 0.1, 5.0), (0.0, -0.25, 5.1), (0.0, 0.25, 5.1)
    deeper, beside_it = (0.0, -0.25, 5.3), (0.0, -0.4, 5.0)
    labels = label(np.array([soffit, south, north, deeper, beside_it]), [], [band])
    assert labels.arch.tolist() == [1, 1, 0, 0, 0]
    assert labels.vault.tolist() == [0] * 5


def test_an_arch_that_reaches_no_part_of_a_plan_holds_none_of_its_points():
    rng = np.random.default_rng(8)
    low, high = np.array([0.0, 0.0]), np.array([3.0, 2.0])
    xy = rng.uniform(low, high, (3000, 2))
    reached = []
    for _ in range(200):
        place, (length, width) = rng.uniform(-3, 6, 2), rng.uniform([1, 0.2], [4, 1])
        soffit = Soffit(place, float(rng.uniform(0, np.pi)), length, width, np.zeros((2, 2)))
        reached.append(soffit.reaches(low, high, 0.3))
        assert reached[-1] or not soffit.holds(xy, 0.05, 0.3).any()
    assert 0.2 < np.mean(reached) < 0.9


def test_the_own_points_of_a_part_are_found_among_those_about_it() -> None:
    rng = np.random.default_rng(4)
    xyz = rng.uniform((-3, -2, 0), (9, 7, 5), (20_000, 3)).astype(np.float32)
    parts = []
    for corner in ((0.0, 0.0), (3.3, 1.1), (5.0, -4.0)):
        grid = PlanGrid(np.array(corner), 0.1, (31, 27))
        held = rng.random(grid.shape) < 0.7
        parts.append(Part(grid, held, rng.uniform(0, 2, grid.shape), rng.uniform(3, 5, grid.shape), ()))
    nothing = Patches(np.empty((0, 3)), np.empty((0, 3)), np.empty(0, np.int64), 0.05)
    ceilings = tuple(Ceiling(np.empty((0, 3)), np.empty(0, np.bool_), 1.0, part) for part in parts)
    laid = Parting(ceilings, (), nothing).laid(xyz)
    for part in parts:
        assert np.array_equal(part.own(laid), xyz[part.holds(xyz)])
    assert any(len(part.own(laid)) for part in parts)
    assert len(Parting((), (), nothing).laid(xyz).about(np.zeros(2), np.ones(2))) == 0
