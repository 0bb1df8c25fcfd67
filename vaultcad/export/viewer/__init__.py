"""The 3D view of report.html: what it shows (`scene`, `packing`), what draws it (`library`), its HTML (`embed`).

What runs in the browser lies beside this file: `open.js` in the page, the rest packed until the view is opened.
"""
