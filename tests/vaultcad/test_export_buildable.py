"""What OpenCASCADE cannot build is nudged until it can, or refused in one line."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from families import BasketHandle, Groin, Semicircular, Stilted
from vaultcad.errors import ExportError
from vaultcad.export import buildable as module


def test_a_vault_that_can_be_built_stays_as_it_is(make_model) -> None:
    model = make_model("trough")
    assert module.buildable(model).vaults[0].vault == model.vaults[0].vault


def test_a_vault_that_cannot_be_built_is_moved_by_less_than_a_millimetre(make_model, monkeypatch) -> None:
    model = make_model("groin")
    vault = model.vaults[0].vault
    tried = []

    def masonry(trial, thickness):
        tried.append(trial)
        if trial == vault:
            raise ValueError("OpenCASCADE cannot do it")

    monkeypatch.setattr(module, "masonry", masonry)
    monkeypatch.setattr(module, "bodies", lambda *_: ())
    moved = module.buildable(model).vaults[0].vault
    assert tried[0] == vault
    assert moved != vault
    assert moved.derived_values() == pytest.approx(vault.derived_values(), abs=1e-3)


@pytest.mark.parametrize(
    "vault",
    [
        Groin(5.008893549912352, 5.017148503046791, Stilted(0.5008240296037618), Semicircular()),
        Groin(4.669792448817519, 4.669746390492405, Stilted(0.5007358811106092), Semicircular(), 0.0, 0.0421895281),
        Groin(5.600789675341074, 5.614254317397447, Stilted(0.5008506768048707), BasketHandle(0.4899506210073029, 0.5)),
        Groin(
            3.717822108881830, 4.161868033436969, Stilted(0.5008943931), BasketHandle(0.4897435106, 0.5), 0.0, 0.0086888
        ),
    ],
    ids=["stilted and round", "with an offset", "stilted and basket-handle", "of a rectangle"],
)
def test_arches_that_all_but_are_one_are_built_and_it_is_said(make_model, vault) -> None:
    model = make_model("groin")
    drawn = module.buildable(replace(model, vaults=(replace(model.vaults[0], vault=vault),)))
    (built,) = (fitted.vault for fitted in drawn.vaults)
    assert built != vault
    assert np.abs(built.distance(vault.sample(500, np.random.default_rng(1)).xyz)).max() < 0.01
    assert [note.code for note in drawn.notes] == ["nudged"]
    assert "mm off the fitted groin vault" in drawn.notes[0].text


def test_a_vault_that_cannot_be_built_at_all_is_refused(make_model, monkeypatch) -> None:
    def never(*_):
        raise ValueError("OpenCASCADE cannot do it")

    monkeypatch.setattr(module, "masonry", never)
    with pytest.raises(ExportError, match="cannot build this groin vault"):
        module.buildable(replace(make_model("groin")))
