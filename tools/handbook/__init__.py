"""The pages that are written from the families' declarations: `python -m tools.handbook`."""
