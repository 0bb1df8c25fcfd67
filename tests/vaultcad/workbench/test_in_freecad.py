"""The add-on in the real FreeCAD, without a window."""

import pytest

from families import FAMILIES, Groin

pytestmark = pytest.mark.freecad


def sound(state: dict) -> bool:
    return (
        state["states"] == ["Up-to-date"]
        and state["valid"]
        and state["faces"] == len(state["names"]) == state["colours"] > 0
    )


def test_every_family_is_edited_to_all_ends_undone_saved_and_opened(in_freecad) -> None:
    found = in_freecad("every_family")
    assert list(found["families"]) == [cls.id for cls in FAMILIES]
    for cls in FAMILIES:
        of = found["families"][cls.id]
        assert sound(of["start"]), cls.id
        assert set(of["start"]["names"]) <= set(cls().components)
        for name, edit in of["edits"].items():
            assert sound(edit["after"]), (cls.id, name, edit["after"])
            assert edit["undone"]["box"] == of["start"]["box"], (cls.id, name)
        boxes = {str(edit["after"]["box"]) for edit in of["edits"].values()}
        assert len(boxes) > 2, "edits change the shape"
        assert all(" to " in text for text in of["tooltips"])
        assert set(of["types"].values()) <= {f"App::Property{kind}" for kind in ("Length", "Angle", "Float", "Integer")}
        assert sound(of["solid"])
        assert {"extrados", "side"} <= set(of["solid"]["names"])
        assert of["solid"]["volume"] > 0
    assert found["before"] == found["after"], "documents open as they were saved"
    assert found["pid"] is None, "without a worker"
    assert found["left"] == 0, "all is undone"
    assert all("Built" in names and "Report" in names for names in found["hidden"].values())
    assert "RiseRatioX" in found["hidden"][Groin.__name__]
    assert sound(found["edited"])
    assert found["edited"]["box"][1] - found["edited"]["box"][0] == pytest.approx(6500 + 400)
    assert "Traceback" not in found["said"]
