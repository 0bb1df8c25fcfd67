"""Each family has an icon of its own, for its command and for its vaults in the tree."""

from xml.etree import ElementTree

from families import FAMILIES
from vaultcad.workbench.install import ADD_ON

ICONS = ADD_ON / "freecad" / "vaultcad_wb" / "icons"
COLOURS = ("#cbbfa9", "#3b3a38")  # of vault.svg


def test_each_family_has_an_icon_of_its_own() -> None:
    texts = [(ICONS / f"{cls.id}.svg").read_text(encoding="utf-8") for cls in FAMILIES]
    for text in texts:
        icon = ElementTree.fromstring(text)
        assert icon.tag == "{http://www.w3.org/2000/svg}svg"
        assert icon.get("viewBox") == "0 0 64 64"
        assert all(colour in text for colour in COLOURS)
    assert len({*texts, (ICONS / "vault.svg").read_text(encoding="utf-8")}) == len(FAMILIES) + 1
