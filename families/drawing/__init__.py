"""Drawings: what is drawn, how it looks, and in which colours, told once; SVG and PNG are back ends of the same.

deviation_colours.py: the colours of deviations, positive into the stone. looks.py: strokes, slabs and other settings.
sheet.py: a `Drawing` of areas, lines, dots, cells and texts. svg.py and png.py write one. section.py: an ideal vault,
cut; view.py: seen from above.
"""
