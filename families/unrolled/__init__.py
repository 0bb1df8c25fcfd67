"""The intrados laid flat: charts between places on a sheet and points on the ideal surface, in the vault's frame.

patches.py: bodies as surfaces with two coordinates. visible.py: what of them shows, and under which name.
developments.py: how a patch is laid flat; grid_spline.py: between the nodes of a net. stretch.py: how true lengths are;
gores.py: as how many gores they are true enough. layout.py: where these lie. sheet.py: the whole, both ways.
"""
