"""The 3D view of report.html: what it shows (`scene`), the library that draws it (`library`), its part of the page.

What runs in the browser lies beside this file: `open.js` in the page, the rest packed until the view is opened.
"""
