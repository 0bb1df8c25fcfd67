"""A vault as exact surfaces and as masonry.

brep.py: intrados and solids, by build123d's OpenCASCADE. mesh.py: their triangles; grid_mesh.py: triangles without
them. Inside: a body (body.py) is laid over the cells of the plan (plan_cells.py), in which sides of barrels show
(visible_sides.py, barrel_slopes.py, barrel_faces.py) and turned surfaces (round_faces.py); plane ends close it
(plane_ends.py, plane_regions.py). Faces share their edges (face_net.py), which run along boundary.py and curves.py, on
surfaces.py; bending.py moves all of it, for plans that are no rectangles. What is asked of shapes is in occ/.
"""
