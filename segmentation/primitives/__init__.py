"""Planes, spheres, cylinders, cones, tori: shapes.py, in numbers (numeric.py), through a few points (minimal_sets.py)
and fitted to many (least_squares.py).
"""
