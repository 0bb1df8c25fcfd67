"""What a vault is, in numbers: what all families are declared with.

vault.py: the base of all, and the façade of the floors above. facts.py: what a family has to say of itself.
parameters.py, constraints.py, symmetry.py: what a size is, with its range; what is alike by habit; what a turn changes.
profiles.py, usual_arches.py: arches, and how builders chose them. pieces.py: bodies, of which a void is made.
corners.py: plans that are no rectangles. lengths.py: what people measure, for ratios. palette.py: a colour a component.
"""
