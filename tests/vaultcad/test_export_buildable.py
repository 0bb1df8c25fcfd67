"""What OpenCASCADE cannot build is nudged until it can, or refused in one line."""

from __future__ import annotations

from dataclasses import replace

import pytest

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


def test_a_vault_that_cannot_be_built_at_all_is_refused(make_model, monkeypatch) -> None:
    def never(*_):
        raise ValueError("OpenCASCADE cannot do it")

    monkeypatch.setattr(module, "masonry", never)
    with pytest.raises(ExportError, match="cannot build this groin vault"):
        module.buildable(replace(make_model("groin")))
