"""Bodies of vaults from all over the ranges of all parameters: sound and of the right volume, or refused by a line."""

from __future__ import annotations

import dataclasses
from math import exp, log

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from OCP.TopoDS import TopoDS_Shape

from families import FAMILIES, PROFILES, Vault
from families.declaration.parameters import Parametric
from families.solid import brep
from families.solid.occ.shapes import is_sound, volume
from fuzz.bodies import BOX, stone_of, volume_of

T = 0.15


@pytest.mark.parametrize("family", FAMILIES, ids=lambda cls: cls.id)
@settings(max_examples=200, deadline=None)
@given(data=st.data())
def test_a_vault_within_the_ranges_is_built_or_refused(family: type[Vault], data: st.DataObject) -> None:
    base = family()
    profiles = {name: data.draw(st.sampled_from(PROFILES))() for name in base.profiles}
    profiles = {name: dataclasses.replace(profile, **_values(profile, data)) for name, profile in profiles.items()}
    vault = dataclasses.replace(base, **_values(base, data), **profiles)
    body = _built(vault)
    if isinstance(body, str):
        assert "change a parameter a little" in body
        assert "\n" not in body
        return
    assert is_sound(body)
    size, deviation = volume_of(vault, stone_of(vault, T), T, BOX[:200_000])
    assert abs(volume(body) / 1e9 - size) < 6 * deviation


def _built(vault: Vault) -> TopoDS_Shape | str:
    try:
        return brep.masonry(vault, T)
    except ValueError as error:
        return str(error)


def _values(declared: Parametric, data: st.DataObject) -> dict[str, float]:
    """A value for each of a class's own parameters: anywhere in its range, lengths between 1.5 and 12 m."""
    own = {field.name for field in dataclasses.fields(declared)}  # type: ignore[arg-type]
    found: dict[str, float] = {}
    for parameter in (p for p in declared.parameters() if p.name in own):
        low, high = parameter.range.low, parameter.range.high
        if parameter.range.unit == "m":
            found[parameter.name] = exp(data.draw(st.floats(log(1.5), log(12))))
        elif isinstance(getattr(declared, parameter.name), int):
            found[parameter.name] = data.draw(st.integers(int(low), int(high)))
        else:
            found[parameter.name] = data.draw(st.floats(low, high))
    return found
