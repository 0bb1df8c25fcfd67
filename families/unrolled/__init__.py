"""The intrados laid flat: charts between places on a sheet and points on the ideal surface, in the vault's frame.

patches.py: bodies as surfaces with two coordinates. visible.py: what of them shows, and under which name.
developments.py: how a patch is laid flat. gores.py: as how many gores, and with how much distortion. layout.py: where
they lie on the sheet. sheet.py: the whole, both ways.
"""
