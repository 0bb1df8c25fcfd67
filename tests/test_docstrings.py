"""The examples in docstrings show what they say."""

import doctest
from importlib import import_module
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
FLAGS = doctest.NORMALIZE_WHITESPACE | doctest.ELLIPSIS
MODULES = [
    ".".join(path.relative_to(ROOT).with_suffix("").parts)
    for package in ("families", "segmentation", "vaultcad")
    for path in sorted((ROOT / package).rglob("*.py"))
    if ">>> " in path.read_text(encoding="utf-8")
]


@pytest.mark.parametrize("name", MODULES)
def test_examples_of_a_module_show_what_they_say(name, monkeypatch):
    monkeypatch.chdir(ROOT)  # where examples/ is
    found = doctest.testmod(import_module(name), optionflags=FLAGS)
    assert found.attempted
    assert not found.failed, "see the output above"
