"""What a scan says before any family is tried: thinned_scan.py, lean.py, bays.py and the arches between them."""
