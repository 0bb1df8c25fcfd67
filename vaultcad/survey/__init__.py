"""What a scan says before any family is tried: thinned_scan.py, lean.py, bays.py and the arches between them.

parting.py takes a building apart by its patches.py and soffits.py; dome_rims.py tells what stands on a drum, backs.py
what is a vault seen from above.
"""
