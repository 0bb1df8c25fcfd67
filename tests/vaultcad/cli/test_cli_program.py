"""The program as a whole: its commands, its help, its exit codes."""

import subprocess
import sys
from importlib.metadata import version

import pytest

from families import FAMILIES
from vaultcad.cli import app
from vaultcad.cli.family import vault_options
from vaultcad.cli.options import flag, span, with_unit
from vaultcad.scanner import ScannerSettings

HEAVY = (
    "numpy",
    "scipy",
    "numba",
    "families",
    "open3d",
    "build123d",
    "OCP",
    "ifcopenshell",
    "laspy",
    "rich",
    "pydantic",
)
COMMANDS = tuple(app.COMMANDS)


def script(text: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, "-c", text], capture_output=True, text=True, timeout=60, check=False)


@pytest.mark.parametrize("arguments", [["--help"], []])
def test_help_names_every_command_and_imports_nothing_heavy(arguments):
    done = script(
        f"import sys; from vaultcad.cli import main; code = main({arguments})\n"
        f"print(code, [name for name in {HEAVY} if name in sys.modules])"
    )
    assert done.stderr == ""
    assert all(f"\n  {name}" in done.stdout for name in COMMANDS)
    assert done.stdout.endswith("0 []\n")


def test_the_version_is_that_of_the_distribution(run):
    assert run("--version").out == f"vaultcad {version('vaultcad')}\n"


@pytest.mark.parametrize("name", COMMANDS)
def test_every_command_explains_itself(run, name):
    told = run(name, "--help")
    assert told.code == 0
    assert f"vaultcad {name}" in told.out
    assert told.err == ""


@pytest.mark.parametrize("command", ["ideal", "scan"])
@pytest.mark.parametrize("cls", FAMILIES, ids=lambda c: c.id)
def test_help_of_a_family_shows_each_parameter_with_range_unit_and_default(run, command, cls):
    told = " ".join(run(command, cls.id, "--help").out.replace("│", " ").split())
    for p in cls().parameters():
        assert f" {flag(p.name)} " in told
        if len(p.path) == 1:
            assert (
                f"{p.range.meaning}; {span(p.range)}, default {with_unit(cls().values()[p.name], p.range.unit)}" in told
            )


@pytest.mark.parametrize("cls", FAMILIES, ids=lambda c: c.id)
def test_options_of_vault_and_scanner_do_not_share_names(cls):
    names = [o.name for o in vault_options(cls)] + [p.name for p in ScannerSettings().parameters()]
    assert len(names) == len(set(names))


def test_what_is_no_error_of_the_user_asks_for_a_report(run, monkeypatch):
    def broken(name):
        raise RuntimeError("a bug\nof ours")

    monkeypatch.setattr(app, "import_module", broken)
    told = run("doctor")
    assert (told.code, told.out) == (1, "")
    assert told.err.count("\n") == 1
    assert "RuntimeError: a bug of ours" in told.err
    assert "VAULTCAD_DEBUG=1" in told.err
    monkeypatch.setenv("VAULTCAD_DEBUG", "1")
    with pytest.raises(RuntimeError):
        app.main(["doctor"])


def test_an_interrupt_ends_with_130_and_one_line(run, monkeypatch):
    def interrupted(name):
        raise KeyboardInterrupt

    monkeypatch.setattr(app, "import_module", interrupted)
    told = run("doctor")
    assert told.code == 130
    assert told.err == "vaultcad: interrupted; nothing half written is left\n"


@pytest.mark.parametrize(
    ("error", "said"),
    [
        (OSError(28, "No space left on device", "a.laz"), "a.laz: No space left on device"),
        (PermissionError(13, "Permission denied", "out"), "out: Permission denied"),
        (MemoryError(), "not enough memory"),
    ],
)
def test_errors_of_the_system_are_one_line(run, monkeypatch, error, said):
    def failing(name):
        raise error

    monkeypatch.setattr(app, "import_module", failing)
    assert said in run("doctor").complaint


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["fot"], "No such command 'fot'. Did you mean 'fit'?; see vaultcad --help"),
        (["--fit"], "No such option: --fit"),
        (["fit"], "Missing argument 'scan'; see vaultcad fit --help"),
        (["ideal"], "see vaultcad ideal --help"),
        (["ideal", "sail"], "Missing option '--out' / '-o'; see vaultcad ideal sail --help"),
        (
            ["fit", "scan.laz", "-o", "out", "--up", "w"],
            "'w' is not one of 'z', 'y', 'x', '-z', '-y', '-x', 'auto'; see vaultcad fit --help",
        ),
        (["scan", "sail", "--origin", "1"], "--origin"),
    ],
)
def test_a_command_that_makes_no_sense_is_answered_with_where_to_read_on(run, arguments, said):
    assert said in run(*arguments).complaint
