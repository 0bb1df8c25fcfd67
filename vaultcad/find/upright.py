"""Which way is up in a scan that does not say."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from families import FAMILIES, Vault
from segmentation.cloud import AXES, Cloud, Up, stood_up, turn
from vaultcad.errors import NoVaultError
from vaultcad.find.findings import find_vaults
from vaultcad.find.no_vault import on_vault
from vaultcad.one_thread import one_thread
from vaultcad.survey.thinned_scan import Thin, thin_scan

PHONES: tuple[Up, ...] = ("y", "-y")  # which axes are up in scans of phones and of cameras that z is not


@one_thread
def stand_up(
    cloud: Cloud,
    rng: np.random.Generator,
    *,
    families: Sequence[type[Vault]] = FAMILIES,
    axes: Sequence[Up] = tuple(AXES),
) -> Cloud:
    """The cloud with that axis of its file up, of some or all, on which the vaults explain the most of it.

    Raises:
        NoVaultError: there is no vault, whichever axis is up.
        ValueError: the cloud was turned already when it was read.
    """
    thin = thin_scan(cloud)
    explained = {up: _explained(thin, cloud, up, families, rng) for up in axes}
    best = max(explained, key=lambda up: explained[up])
    if not explained[best]:
        raise NoVaultError("no vault found, whichever axis is up; scan a whole room under a vault, or crop to one bay")
    return stood_up(cloud, best)


def _explained(thin: Thin, cloud: Cloud, up: Up, families: Sequence[type[Vault]], rng: np.random.Generator) -> int:
    """How many thinned points lie on the vaults that are found with that axis up."""
    turned = replace(thin, points=turn(thin.points, up), normals=turn(thin.normals, up))
    try:
        found = find_vaults(turned, turn(cloud.xyz, up), families, rng).vaults
    except NoVaultError:
        return 0
    on = [on_vault(one.placed, turned.points, turned.normals, one.tolerance) for one in found]
    return int(np.any(on, axis=0).sum())
