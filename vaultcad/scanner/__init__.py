"""A virtual laser scanner: a vault in its room, settled, occluded, scanned with a real instrument's errors."""

from vaultcad.scanner.bays import Bay, SceneScan, row, scan_bays
from vaultcad.scanner.draw import draw
from vaultcad.scanner.scan import VirtualScan, scan
from vaultcad.scanner.settings import ScannerSettings
from vaultcad.scanner.truth import read_truth, truth_path, vault_of, write_scan

__all__ = [
    "Bay",
    "ScannerSettings",
    "SceneScan",
    "VirtualScan",
    "draw",
    "read_truth",
    "row",
    "scan",
    "scan_bays",
    "truth_path",
    "vault_of",
    "write_scan",
]
