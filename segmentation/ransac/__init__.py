"""Primitives in a cloud: detect.py, by the steps of the files beside it."""
