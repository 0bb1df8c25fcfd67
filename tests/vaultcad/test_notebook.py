"""What a fit shows in a notebook."""

import dataclasses

import numpy as np
import plotly.graph_objects as go
import pytest
from IPython.core.formatters import DisplayFormatter

from families.notebook import HTML, PLOTLY
from vaultcad.fit.label import Labels
from vaultcad.pipeline import Result
from vaultcad.pose import Pose


def displayed(value):
    found, _ = DisplayFormatter(active_types=["text/plain", HTML, PLOTLY]).format(value)
    return found


@pytest.fixture
def result(make_model):
    """Points of a sail vault 5 mm in the stone, and a floor."""
    model = make_model("sail")
    fitted = model.vaults[0]
    sample = fitted.vault.sample(3000, np.random.default_rng(1))
    moved = sample.xyz + 0.005 * fitted.vault.evaluate(sample.xyz).normal
    local = np.concatenate([moved, np.random.default_rng(2).uniform([-2, -2, -1], [2, 2, -1], (400, 3))])
    out = fitted.pose.placement()
    on = np.arange(len(local)) < len(moved)
    own = on.astype(np.uint16)
    labels = Labels(own, own, np.where(on, 0.005, np.nan).astype(np.float32), np.zeros_like(own))
    points = local @ out[:3, :3].T + out[:3, 3]
    return Result(model, labels, points, labels.component, labels.vault, labels.deviation.astype(np.float64))


def test_a_fitted_vault_displays_its_sizes_with_their_deviations(every_family):
    for fitted in every_family.vaults:
        shown = displayed(fitted)
        page = shown[HTML]
        assert f"{fitted.vault.title.capitalize()}, confidence 97%" in page
        assert "deviation rms 12.0 mm" in page
        assert page.count("<svg") == 2
        for name, estimate in fitted.parameters.items():
            assert name.replace("_", " ") in page
            if estimate.unit == "m":
                assert f"{estimate.value:.3f} m" in page
        assert "± 2.0 mm" in page
        names = [trace.name for trace in go.Figure(shown[PLOTLY]).data]
        assert names[:-1] == [name.replace("_", " ") for name in fitted.vault.components]


def test_flags_and_a_fit_that_did_not_settle_are_told(make_model):
    fitted = make_model("sail").vaults[0]
    estimates = {k: dataclasses.replace(e, flags=("unseen",)) for k, e in fitted.parameters.items()}
    page = displayed(dataclasses.replace(fitted, parameters=estimates, converged=False))[HTML]
    assert "± 2.0 mm unseen" in page
    assert "not come to rest" in page


def test_a_model_shows_all_its_vaults_where_they_stand(make_model):
    first = make_model("barrel").vaults[0]
    second = dataclasses.replace(make_model("sail").vaults[0], pose=Pose(20.0, 3.0, 2.5, 0.3))
    shown = displayed(make_model("barrel", vaults=(first, second)))
    assert "2 vaults" in shown[HTML]
    assert "1  Barrel vault" in shown[HTML]
    assert "2  Sail vault" in shown[HTML]
    barrel, sail, _ = go.Figure(shown[PLOTLY]).data
    for trace, fitted in ((barrel, first), (sail, second)):
        points = np.column_stack([trace.x, trace.y, trace.z])
        assert np.abs(fitted.vault.distance(points, frame=fitted.pose.frame())).max() < 3e-4


def test_a_result_shows_the_scan_on_its_model(result):
    shown = displayed(result)
    assert shown[HTML].count("h0") > 50  # dots in the sections
    *_, cloud, table = go.Figure(shown[PLOTLY]).data
    assert cloud.type == "scatter3d"
    assert table.type == "table"
    assert len(cloud.x) == (result.component > 0).sum()
    assert np.array(cloud.marker.color) == pytest.approx(5.0)
    assert cloud.marker.cmin == -cloud.marker.cmax
    assert cloud.marker.cmax == pytest.approx(5.0)
    fitted = result.model.vaults[0]
    points = np.column_stack([cloud.x, cloud.y, cloud.z])
    assert fitted.vault.distance(points, frame=fitted.pose.frame()) == pytest.approx(0.005, abs=2e-3)
