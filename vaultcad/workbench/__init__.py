"""FreeCAD: a worker in this project's environment makes what the add-on under Mod/ shows.

worker.py: the process itself, JSON lines in and out. protocol.py: its loop. declarations.py, shapes.py, scans.py,
files.py: what it can be asked. install.py: the add-on in FreeCAD's folders.
The add-on runs in FreeCAD's own Python, imports nothing of this project, and is in turn imported by nothing here.
"""
