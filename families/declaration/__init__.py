"""What a vault is, in numbers: what all families are declared with.

vault.py: the base of all, and the façade of the floors above. parameters.py, constraints.py: what a size is, with its
range, and what is alike by habit. profiles.py: arches. pieces.py: bodies, of which a void is made. corners.py: plans
that are no rectangles. lengths.py: what people measure, for ratios. palette.py: one colour a component.
"""
