"""Places go back as the scan's file has them, or in metres."""

from dataclasses import replace

import numpy as np
import pytest

from vaultcad.coordinates import placed, says


def test_places_go_back_in_the_axes_and_the_unit_of_the_file(make_model):
    model = make_model("groin")
    model = replace(model, settings={**model.settings, "up": "y", "scale": [0.3048] * 3})
    place = np.array([[3.048, -6.096, 0.3048]])  # z up
    assert placed(model, place, "file") == pytest.approx(np.array([[10.0, 1.0, 20.0]]))
    assert placed(model, place, "metres") is place
    assert says(model, "file").endswith(": ft, y up")
    assert says(model, "metres") == "metres, z up"
