import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from vaultcad.caches import find_caches

NOWHERE = "/proc/nonexistent"
ROOT = Path(__file__).parents[2]


@pytest.fixture
def homeless(tmp_path, monkeypatch):
    """An account whose home cannot be made; where temporary files go."""
    monkeypatch.setenv("HOME", NOWHERE)
    monkeypatch.setattr("tempfile.gettempdir", lambda: str(tmp_path))
    for name in ("XDG_CACHE_HOME", "MPLCONFIGDIR"):
        monkeypatch.setenv(name, "kept, so that it is put back")
        monkeypatch.delenv(name)
    return tmp_path


def test_where_there_is_no_home_a_private_folder_is_named(homeless):
    find_caches()
    folder = Path(os.environ["XDG_CACHE_HOME"])
    assert folder.parent == homeless
    assert folder.stat().st_mode & 0o777 == 0o700
    assert Path(os.environ["MPLCONFIGDIR"]).parent == folder


def test_without_a_home_no_folder_is_made_where_one_is(homeless, monkeypatch, tmp_path):
    monkeypatch.setattr("os.path.expanduser", lambda path: path)
    monkeypatch.chdir(tmp_path)
    find_caches()
    assert Path(os.environ["XDG_CACHE_HOME"]).is_absolute()
    assert not (tmp_path / "~").exists()


def test_the_same_folder_serves_again(homeless):
    find_caches()
    first = os.environ.pop("XDG_CACHE_HOME")
    find_caches()
    assert os.environ["XDG_CACHE_HOME"] == first


@pytest.mark.parametrize("trap", ["link", "open to all"])
def test_what_a_stranger_may_write_to_is_not_taken(trap, homeless):
    planted = homeless / f"vaultcad-{os.geteuid()}"
    if trap == "link":
        (homeless / "theirs").mkdir()
        planted.symlink_to(homeless / "theirs")
    else:
        planted.mkdir()
        planted.chmod(0o777)
    find_caches()
    assert Path(os.environ["XDG_CACHE_HOME"]) != planted


def test_where_there_is_a_home_nothing_changes(tmp_path, monkeypatch):
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.delenv("XDG_CACHE_HOME", raising=False)
    find_caches()
    assert "XDG_CACHE_HOME" not in os.environ


def compiled_before(caches):
    """Lay into numba's own folder among caches what it keeps beside this code, all but of normals: that saves 30 s."""
    from numba.core.caching import _CacheLocator

    for kept in ROOT.glob("[fsv]*/**/__pycache__/*.nb[ci]"):
        if not kept.name.startswith("normals."):
            folder = caches / "numba" / _CacheLocator.get_suitable_cache_subpath(str(kept.parents[1] / "code.py"))
            folder.mkdir(parents=True, exist_ok=True)
            shutil.copy2(kept, folder)


def test_a_fit_without_home_and_beside_code_that_is_read_only_says_nothing_of_caches(tmp_path, room):
    locator, caches = "UserWideCacheLocator", tmp_path / f"vaultcad-{os.geteuid()}"
    caches.mkdir(0o700)
    compiled_before(caches)
    environment = {"PATH": os.environ["PATH"], "HOME": NOWHERE, "TMPDIR": str(tmp_path)}
    environment |= {"NUMBA_CACHE_LOCATOR_CLASSES": locator, "PYTHONPATH": os.pathsep.join(sys.path)}
    code = "import sys; from vaultcad.cli import main; sys.exit(main())"
    options = ["-o", str(tmp_path / "out"), "--review", "--family", "sail"]
    command = [sys.executable, "-c", code, "fit", str(room), *options]
    run = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    assert run.stderr.count("\n") == 1
    assert "unit: metre" in run.stderr
    assert list(caches.glob("numba/*/normals.*.nbi"))
