"""What comes with an extra is asked for by name where it is missing; cli/test_cli_fit.py has a fit that needs none."""

import subprocess


def test_the_scanner_says_which_extra_it_needs(without_extras, tmp_path):
    command = [*without_extras, "scan", "groin", "-o", tmp_path / "scan.laz"]
    ran = subprocess.run([*map(str, command)], capture_output=True, text=True, check=False)
    assert ran.returncode == 2
    assert ran.stderr == 'vaultcad: vaultcad scan needs open3d: pip install "vaultcad[scanner]"\n'
