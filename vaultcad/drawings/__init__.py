"""Sheets to scale: sections, plans and unrolled vaults as DXF, PDF and SVG."""
