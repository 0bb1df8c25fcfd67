"""VaultCad in FreeCAD: vaults as parametric objects, scans fitted with them.

Runs in FreeCAD's own Python with nothing installed there: the geometry is made by a worker in vaultcad's environment.
client.py: that worker. catalogue.py: what it knows of families. properties.py: declarations as properties.
vault.py, view.py: the parametric object and how it looks. scan.py: points. fit.py, panel.py: from scan to vault.
exports.py: STEP and IFC. commands.py, init_gui.py: menu and toolbar.
"""
