"""Bays of a row."""

from __future__ import annotations

import pickle

import pytest

from families import FAMILIES, Vault
from vaultcad.fit.demands import constraints_of
from vaultcad.fit.freedom import Demands, decides


@pytest.mark.parametrize("family", FAMILIES, ids=lambda family: family.id)
def test_what_a_fit_may_move_goes_from_process_to_process(family: type[Vault]) -> None:
    vault = family()
    own, values = {p.name for p in vault.parameters()}, vault.derived_values()
    lengths = {name: values[name] for name, parameter in decides(family).items() if parameter in own}
    free = Demands(sizes=lengths).freedom(vault, constraints_of(family))
    again = pickle.loads(pickle.dumps(free))
    assert again.settled(vault, {}) == free.settled(vault, {})
