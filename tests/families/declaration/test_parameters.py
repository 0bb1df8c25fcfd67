import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from families import FAMILIES, Barrel, Groin, Lunette, Mirror, Pointed, Segmental, Semicircular
from families.declaration.parameters import derived_declarations


@pytest.mark.parametrize("family", FAMILIES)
def test_every_parameter_has_a_range_around_its_default_and_a_unit(family):
    vault = family()
    values = vault.values()
    for p in vault.parameters():
        assert p.range.low < p.range.high
        assert p.range.low <= values[p.name] <= p.range.high
        assert p.range.unit in {"m", "rad", "1"}
        assert p.range.meaning


@pytest.mark.parametrize("family", FAMILIES)
def test_parameters_outside_their_range_are_refused_by_name_value_and_range(family):
    for p in family().parameters():
        for value in (p.range.low - 1, p.range.high + 1):
            with pytest.raises(ValueError, match=p.path[-1]) as error:
                family().replaced({p.name: value})
            assert f"{value:g}" in str(error.value)
            assert f"{p.range.high:g}" in str(error.value)


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_what_is_no_number_is_refused(value):
    with pytest.raises(ValueError, match="span"):
        Barrel(span=value)


def test_a_whole_number_is_asked_for_where_one_is_meant():
    with pytest.raises(ValueError, match=r"count = 2\.5"):
        Lunette(count=2.5)
    assert Lunette().replaced({"count": 4.0}).count == 4


def test_nested_parameters_are_named_after_their_profile():
    vault = Groin(profile_x=Pointed(0.9), profile_y=Segmental(0.3))
    assert vault.values()["rise_ratio_x"] == 0.9
    assert vault.values()["rise_ratio_y"] == 0.3
    changed = vault.replaced({"rise_ratio_y": 0.2, "span_x": 6.0})
    assert changed.profile_y == Segmental(0.2)
    assert changed.profile_x == vault.profile_x
    assert changed.span_x == 6.0


def test_profiles_of_one_name_do_not_collide():
    vault = Lunette(profile=Segmental(0.4), lunette_profile=Pointed(0.7))
    values = vault.values()
    assert len(values) == len(vault.parameters())
    assert sorted(v for k, v in values.items() if "rise_ratio" in k) == [0.4, 0.7]


def test_an_unknown_parameter_is_named_with_those_that_exist():
    with pytest.raises(ValueError, match=r"'widht'.*span"):
        Barrel().replaced({"widht": 3.0})


@pytest.mark.parametrize("family", FAMILIES)
@settings(max_examples=50, deadline=None)
@given(data=st.data())
def test_every_vector_within_the_bounds_is_a_vault(family, data):
    vault = family()
    values = {
        p.name: data.draw(st.integers(int(p.range.low), int(p.range.high)))
        if p.integer
        else data.draw(st.floats(p.range.low, p.range.high))
        for p in vault.parameters()
    }
    other = vault.replaced(values)
    assert other.values() == pytest.approx(values)
    assert all(math.isfinite(v) for v in other.derived_values().values())
    assert other.rise > 0
    assert other.replaced(other.values()) == other
    plan = other.plan
    assert plan.half_x > 0
    assert plan.half_y > 0


@pytest.mark.parametrize("family", FAMILIES)
def test_what_follows_from_the_parameters_is_declared_with_a_unit(family):
    declared = derived_declarations(family)
    assert set(family().derived_values()) == set(declared)
    assert "rise" in declared or family.id == "groin"
    assert all(d.unit and d.meaning for d in declared.values())


def test_the_mirror_keeps_the_equation_of_the_paper():
    vault = Mirror(6.0, 8.0, run_x_ratio=0.5, run_y_ratio=0.5, rise_ratio=0.8)
    S, H = vault.run_x, vault.cove_rise
    assert pytest.approx(1.5) == S
    assert vault.radius_x == pytest.approx((S**2 + H**2) / (2 * H))


def test_equal_vaults_are_equal_and_can_be_keys():
    assert {Barrel(5.0, 8.0, Semicircular()): 1}[Barrel()] == 1


@pytest.mark.parametrize("value", [float("nan"), float("inf"), 2.5])
def test_a_count_that_is_no_whole_number_in_range_is_refused_by_name(value):
    with pytest.raises(ValueError, match="count = "):
        Lunette(count=value)
