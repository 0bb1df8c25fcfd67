"""What is told of a fitted vault: deviation.py, coverage.py, estimates.py, and as_built.py, the stone as it stands."""
