import pytest

from families import FAMILIES, Dome, Groin, Mirror, Sail, Trough, family


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
