"""The room under a vault, in numbers: signed distances, and points spread evenly over the intrados.

kernel.py: distance, component and normal of many points. sampling.py: points, laid on the strips of
sampling_strips.py. profile_outline.py: a profile as walls and arcs.
"""
