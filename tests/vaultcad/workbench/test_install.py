"""The add-on is put in whole, and taken out."""

import ast
import sys
from pathlib import Path

import pytest

from vaultcad.cli import main
from vaultcad.workbench.install import ADD_ON, INTERPRETER, InstallError, by_rule, install, uninstall


def test_it_is_put_in_and_taken_out(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    mod = tmp_path / "user" / "Mod"
    for _ in range(2):  # anew over an earlier one
        assert main(["freecad", "install", "--mod-folder", str(mod)]) == 0
        assert capsys.readouterr().out.startswith(f"{mod / 'VaultCad'}: ")
    assert [path.name for path in mod.iterdir()] == ["VaultCad"], "nothing is left beside it"
    there = {str(path.relative_to(mod / "VaultCad")) for path in (mod / "VaultCad").rglob("*") if path.is_file()}
    here = {str(path.relative_to(ADD_ON)) for path in ADD_ON.rglob("*") if path.suffix in {".py", ".svg", ".xml"}}
    assert there == here | {str(INTERPRETER)}
    assert (mod / "VaultCad" / INTERPRETER).read_text().strip() == sys.executable
    assert main(["freecad", "uninstall", "--mod-folder", str(mod)]) == 0
    assert list(mod.iterdir()) == []


def test_what_is_not_ours_stays(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    other = tmp_path / "VaultCad"
    other.mkdir()
    (other / "notes.txt").write_text("mine")
    with pytest.raises(InstallError, match="is something else; move it away"):
        install(tmp_path)
    with pytest.raises(InstallError, match="holds no add-on of vaultcad's"):
        uninstall(tmp_path)
    assert main(["freecad", "uninstall", "--mod-folder", str(tmp_path)]) == 2
    assert "--mod-folder" in capsys.readouterr().err
    assert [path.name for path in other.iterdir()] == ["notes.txt"]


def test_the_folder_is_found_by_freecads_rules(tmp_path: Path) -> None:
    def found(platform: str = "linux", **environment: str) -> str:
        return str(by_rule(environment, platform, tmp_path).relative_to(tmp_path))

    assert found() == ".local/share/FreeCAD/Mod"
    assert found(XDG_DATA_HOME=str(tmp_path / "data")) == "data/FreeCAD/Mod"
    assert found(FREECAD_USER_HOME=str(tmp_path / "b")) == "b/.local/share/FreeCAD/Mod"
    assert found(FREECAD_USER_DATA=str(tmp_path / "a"), FREECAD_USER_HOME="/b") == "a/Mod"
    assert found("darwin") == "Library/Application Support/FreeCAD/Mod"
    assert found("win32", APPDATA=str(tmp_path / "roaming")) == "roaming/FreeCAD/Mod"
    for version in ("v1-2", "v1-10"):
        (tmp_path / ".local" / "share" / "FreeCAD" / version).mkdir(parents=True)
    assert found() == ".local/share/FreeCAD/v1-10/Mod", "from 1.1 on a folder a version"


def test_the_add_on_stands_alone() -> None:
    """It imports what FreeCAD's own Python has, and nothing else."""
    allowed = {*sys.stdlib_module_names, "FreeCAD", "FreeCADGui", "Part", "Points", "PySide"}
    for path in ADD_ON.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
            if isinstance(node, ast.ImportFrom) and not node.level:
                names = [node.module or ""]
            assert {name.split(".")[0] for name in names} <= allowed, path.name


def test_texts_can_be_translated() -> None:
    """Translators' tools find a text where context and text are written out."""
    texts = 0
    for path in ADD_ON.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Call) and getattr(node.func, "id", "") in {"translate", "QT_TRANSLATE_NOOP"}:
                context, text = node.args
                assert isinstance(context, ast.Constant), path.name
                assert context.value == "VaultCad"
                texts += isinstance(text, ast.Constant)
    assert texts > 30
