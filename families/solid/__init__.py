"""A vault as exact surfaces and as masonry.

Over the plan every body is a height, and the intrados the maximum over pieces of the minimum over their bodies: its
faces are the regions of the plan where one body shows. brep.py: intrados and solids, by build123d's OpenCASCADE.
mesh.py: their triangles; grid_mesh.py: triangles without them. Inside:

bodies.py, roofs.py, web_roofs.py, arches.py: what a body shows over a place, a roof; heights.py: heights, compiled.
plan_cells.py: the plan cut by lines and circles, so that in a cell every body shows one roof.
envelope.py: each cell parted into regions by the lines in which roofs are as high; laid_curves.py: those as splines.
body.py, faces.py: regions become faces, with the walls at which they step and the sides at which a plan ends;
seamless.py, plane_regions.py: edges run on, loops close. face_net.py: faces share edges and vertices.
boundary.py, curves.py, splines.py, surfaces.py: the curves and surfaces. What is asked of shapes is in occ/.
"""
