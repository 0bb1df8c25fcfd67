"""The intrados laid flat: maps of deviation, height, intensity and colour, and the way back.

`families.unrolled` says where points lie on a sheet. raster.py: what a scan shows there, in pixels; gaps.py fills those
between points. contours.py: lines of one deviation or height. pictures.py: rasters as PNG and GeoTIFF. maps.py: all
files of all sheets. drawn_lines.py: lines drawn on a sheet, from files and to files; back.py: on the vault.
"""
