import pytest

from families import FAMILIES, Dome, Groin, Mirror, Pointed, Sail, Segmental, Trough, family, ideal


@pytest.mark.parametrize("cls", FAMILIES)
def test_a_family_answers_to_its_names_in_four_languages(cls):
    assert set(cls.aliases) == {"it", "fr", "de", "es"}
    for name in (cls.id, cls.title, *(n for names in cls.aliases.values() for n in names)):
        assert family(name) is cls
        assert family(name.upper()) is cls


@pytest.mark.parametrize(
    ("name", "cls"),
    [
        ("Crociera", Groin),
        ("voute d'aretes", Groin),
        ("Kreuzgewölbe", Groin),
        ("Kreuzgewolbe", Groin),
        ("padiglione", Trough),
        ("volta a schifo", Mirror),
        ("bóveda vaída", Sail),
        ("cupola", Dome),
    ],
)
def test_case_accents_and_spaces_do_not_matter(name, cls):
    assert family(name) is cls


def test_no_name_means_two_families():
    names = [n.casefold() for cls in FAMILIES for group in cls.aliases.values() for n in group]
    assert len(names) == len(set(names))


@pytest.mark.parametrize("name", ["", "vault", "fan"])
def test_an_unknown_name_is_named_with_the_families(name):
    with pytest.raises(ValueError, match=r"sail.*groin.*dome") as error:
        family(name)
    assert repr(name) in str(error.value)


@pytest.mark.parametrize("cls", FAMILIES)
def test_an_ideal_vault_is_made_by_name_and_numbers(cls):
    vault = cls()
    numbers = {p.name: vault.values()[p.name] for p in vault.parameters()}
    assert ideal(next(iter(cls.aliases["it"]))) == vault
    assert ideal(cls.id, **numbers) == vault


def test_an_ideal_vault_takes_profiles_by_any_name_and_lengths_for_ratios():
    vault = ideal("crociera", span_x=6, profile_x="Spitzbogen", profile_y=Segmental(0.2), rise_y=2)
    assert vault == Groin(6, 5, Pointed(), Segmental(0.4))
    assert ideal("mirror", run_x=1.2, run_y=1.2, cove_rise=1.2).cove_rise == pytest.approx(1.2)  # the most that can be


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ({"span_x": 5000}, r"span_x = 5000 lies outside \[0.5, 40\] m"),
        ({"span": 5}, "a groin vault has no 'span'; it has profile_x, profile_y, span_x"),
        ({"span_x": "5"}, "span_x = '5' is no number"),
        ({"span_x": True}, "span_x = True is no number"),
        ({"profile_x": 3}, "profile_x = 3 is no profile; there are semicircular"),
        ({"profile_x": "flat"}, "no profile is called 'flat'"),
        ({"rise_x": 2}, "rise_x 2: its profile makes it 2.5 m"),
        ({"profile_x": "segmental", "rise_x": 3}, "rise_x 3: with the other sizes it can be 0.25 to 2.5 m"),
        ({"profile_x": "segmental", "rise_x": float("nan")}, "rise_x nan: with the other sizes it can be"),
        ({"profile_x": "segmental", "rise_x": 2, "rise_ratio_x": 0.4}, "say the same"),
    ],
)
def test_what_no_ideal_vault_can_have_is_refused_by_name(given, told):
    with pytest.raises(ValueError, match=told):
        ideal("groin", **given)
