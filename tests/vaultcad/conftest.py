"""Models made by hand from every family, with made-up deviations: what the exporters' tests write and read back.

And a small scan, for fits whose accuracy is not what matters.
"""

import dataclasses
import sys
from collections.abc import Callable
from functools import cache
from math import nan, radians, sqrt
from pathlib import Path

import numpy as np
import pytest

from families import FAMILIES, Barrel, Groin, Pointed, Sail, Vault, family
from families.declaration.parameters import derived_declarations
from vaultcad.model import Component, FittedArch, FittedVault, Model, Rival
from vaultcad.pose import Pose
from vaultcad.scanner import ScannerSettings, scan, write_scan
from vaultcad.uncertain import Covariance, Deviation, Estimate

IDS = tuple(cls.id for cls in FAMILIES)
WITHOUT_EXTRAS = """
import sys
class Missing:
    def find_spec(self, name, path, target=None):
        if name.partition(".")[0] in ("open3d", "cadquery", "vtk", "vtkmodules", "plotly", "pytest", "mypy"):
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)
sys.meta_path.insert(0, Missing())
from vaultcad.cli import main
sys.exit(main())
"""


def deviation(scale: float = 0.01) -> Deviation:
    within = {0.01: 0.61, 0.03: 0.95, 0.06: 0.998}
    return Deviation(mean=scale, rms=1.2 * scale, p95=2.4 * scale, max=6 * scale, within=within, loa="LOA20")


def estimates(vault: Vault) -> dict[str, Estimate]:
    values = vault.values()
    found = {p.name: Estimate(values[p.name], p.range.unit, 0.002, p.range.meaning) for p in vault.parameters()}
    declared = derived_declarations(type(vault))
    for name, value in vault.derived_values().items():
        found[name] = Estimate(value, declared[name].unit, None, declared[name].meaning, derived=True)
    return found | {"yaw": Estimate(radians(25), "rad", radians(0.02), "turn about the vertical")}


def fitted(vault: Vault, pose: Pose) -> FittedVault:
    components = tuple(
        Component(k, name, 1000 * k, deviation(0.004 * k), 0.9) for k, name in enumerate(vault.components, 1)
    )
    return FittedVault(
        vault=vault,
        pose=pose,
        confidence=0.97,
        alternatives=(("barrel", 0.4), ("sail", 0.1)),
        parameters=estimates(vault),
        components=components,
        deviation=deviation(),
        coverage=0.93,
    )


@cache  # the same value every time, so that its solid is made once
def made(name: str) -> Model:
    return Model(
        scan=Path(f"scan of a {name}.laz"),
        points=123_456,
        bounds=np.array([[0.0, 0.0, 0.0], [9.0, 8.0, 7.0]]),
        origin=np.zeros(3),
        vaults=(fitted(family(name)(), Pose(4.0, 3.0, 2.5, radians(25))),),
        settings={"family": "auto", "seed": 0},
        versions={"vaultcad": "0.1.0", "numpy": "2"},
        seconds={"read": 1.2345, "fit": 2.5},
    )


def make(name: str, **changes: object) -> Model:
    return dataclasses.replace(made(name), **changes) if changes else made(name)


def arched(beside: tuple[int, int], pose: Pose) -> FittedArch:
    """A pointed arch between two bays, set out with the fifth point, 0.25 m deep to its south."""
    barrel = Barrel(span=4.6, length=0.5, profile=Pointed(sqrt(0.55)))
    names = ("x", "y", "z", "yaw", "span", "rise_ratio")
    known = fitted(barrel, pose)
    spread = Covariance(names, np.diag(np.square([0.004, 0.003, 0.002, 0.001, 0.005, 0.001])))
    rivals = (Rival(1.0, {"profile": "pointed"}, (), {"span": 4.6, "rise": 4.6 * sqrt(0.55)}, 0.0),)
    fields = {f.name: getattr(known, f.name) for f in dataclasses.fields(known)}
    fields |= {"covariance": spread, "rivals": rivals, "odds": {"profile": {"pointed": 1.0}}}
    return FittedArch(**fields, depth=(0.25, nan), beside=beside)


@pytest.fixture(scope="session")
def building() -> Model:
    """A row of two groin bays with an arch between, and a sail vault over the first of them, in a national grid."""
    bays = tuple(fitted(Groin(4.6, 5.0), Pose(5.1 * k, 0.0, 3.0, 0.0)) for k in (1, 0))
    upper = fitted(Sail(4.6, 5.0), Pose(0.1, 0.0, 8.0, 0.0))
    between = arched((2, 1), Pose(2.55, 0.0, 3.0, radians(90)))
    origin = np.array([512_000.0, 4_871_000.0, 210.0])
    return make("groin", vaults=(*bays, upper), arches=(between,), origin=origin, scan=Path("two bays.e57"))


@pytest.fixture(scope="session")
def without_extras() -> list[str]:
    """The program in a process of its own that has none of the extras; its arguments are to follow."""
    return [sys.executable, "-c", WITHOUT_EXTRAS]


@pytest.fixture(scope="session")
def room(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A small scan of a room under a sail vault, with its truth beside it."""
    path = tmp_path_factory.mktemp("room") / "room.laz"
    settings = ScannerSettings(points=60_000, tie_rods=0, furniture=1, settlement=0.01)
    write_scan(scan(Sail(), settings, rng=np.random.default_rng(3)), path)
    return path


@pytest.fixture(scope="session")
def make_model() -> Callable[..., Model]:
    """A model of one vault by its family's id; further fields of `Model` as keywords."""
    return make


@pytest.fixture(scope="session")
def every_family(make_model) -> Model:
    """One model with a vault of each family, in their order, spread out, in a national grid."""
    vaults = tuple(
        dataclasses.replace(make_model(name).vaults[0], pose=Pose(15.0 * k, -3.0, 2.5, radians(10 * k)))
        for k, name in enumerate(IDS)
    )
    origin = np.array([512_000.0, 4_871_000.0, 210.0])
    return make_model("groin", vaults=vaults, origin=origin, scan=Path("all of them.e57"))
