"""What holds for all tests."""

import gc

import pytest


@pytest.hookimpl(trylast=True)
def pytest_collection_finish() -> None:
    """Keep the collector of garbage off the libraries and the tests, a million objects that stay until the end."""
    gc.collect()
    gc.freeze()
