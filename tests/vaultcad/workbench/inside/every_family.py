"""Every family: made, every parameter edited to the ends of its range, undone, made solid, saved and opened again.

What belongs to a kind of arch goes to both ends in the first place of a vault, and to the low one in the others.
"""

import functools
import itertools

import FreeCAD as App
import given
from freecad.vaultcad_wb import client, properties, vault
from freecad.vaultcad_wb.catalogue import families, numbers, title

COUNT = itertools.count()


def edit(document, obj, change):
    """One edit as a user makes it, and its undoing: the state after the one, and the extent after the other."""
    before = document.UndoNames[:1]
    document.openTransaction(f"edit {next(COUNT)}")
    change()
    document.recompute()
    document.commitTransaction()
    after = given.state(obj)
    if document.UndoNames[:1] != before:  # one that changes nothing is no edit
        document.undo()
        document.recompute()
    return {"after": after, "undone": given.extent(obj)}


def tour(document, obj, declaration):
    edits, ends = {}, ("low", "high")
    for parameter in declaration["parameters"]:
        if parameter["kind"] == "choice":
            for kind, own in parameter["choices"].items():
                name = title(parameter["name"])
                edits[f"{name} {kind}"] = edit(document, obj, lambda n=name, k=kind: setattr(obj, n, k))
                for p in own:
                    for end in ends:

                        def both(n=name, k=kind, p=p, end=end):
                            setattr(obj, n, k)
                            properties.put(obj, p, p[end])

                        edits[f"{name} {kind} {p['name']} {end}"] = edit(document, obj, both)
            ends = ("low",)
        else:
            for end in ("low", "high"):
                one = functools.partial(properties.put, obj, parameter, parameter[end])
                edits[f"{parameter['name']} {end}"] = edit(document, obj, one)
    return edits


def work():
    document = App.newDocument("every")
    document.UndoMode = 1
    found = {}
    for name, declaration in families().items():
        document.openTransaction("new")
        obj = vault.make(document, name)
        document.recompute()
        document.commitTransaction()
        shown = [p["name"] for p in numbers(declaration, properties.profiles(obj, declaration))]
        found[name] = {
            "start": given.state(obj),
            "edits": tour(document, obj, declaration),
            "tooltips": [obj.getDocumentationOfProperty(title(p)) for p in shown],
            "types": {p: obj.getTypeIdOfProperty(title(p)) for p in shown},
        }
        document.openTransaction("solid")
        obj.Thickness = "0.2 m"
        document.recompute()
        document.commitTransaction()
        found[name]["solid"] = given.state(obj)
    path = str(given.FOLDER / "every.FCStd")
    document.saveAs(path)
    before = {obj.Name: given.state(obj) for obj in document.Objects}
    kept = document.UndoCount  # FreeCAD forgets what is more than 20 steps ago
    while document.UndoCount:
        document.undo()
    left = len(document.Objects)
    App.closeDocument(document.Name)
    client.BUILDER.stop()
    opened = App.openDocument(path)
    opened.recompute(None, True)
    after = {obj.Name: given.state(obj) for obj in opened.Objects}
    hidden = {o.Name: [p for p in o.PropertiesList if "Hidden" in o.getEditorMode(p)] for o in opened.Objects}
    pid = client.BUILDER.pid
    opened.getObject("Barrel").Span = "6.5 m"
    opened.recompute()
    edited = given.state(opened.getObject("Barrel"))
    return {
        "families": found, "before": before, "after": after, "hidden": hidden, "pid": pid, "left": left,
        "kept": kept, "edited": edited,
    }  # fmt: skip


given.told(work)
