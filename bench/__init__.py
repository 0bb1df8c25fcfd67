"""Accuracy and speed, measured: `python -m bench --help`."""
