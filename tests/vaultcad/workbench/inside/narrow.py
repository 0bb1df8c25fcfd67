"""The panel with what fits found, in a dock as narrow as FreeCAD's own: what of its text is wider than its place."""

import json

import FreeCAD as App
import given
import session
from freecad.vaultcad_wb import panel, vault
from PySide import QtCore, QtGui

DOCK = 300


def cut(table):
    """The texts of a table that do not fit their cells, wrapped or not."""
    margin = 1 + table.style().pixelMetric(QtGui.QStyle.PM_FocusFrameHMargin)
    found = []
    for row in range(table.rowCount()):
        for column in range(table.columnCount()):
            item = table.item(row, column)
            room = table.visualItemRect(item).adjusted(margin, 0, -margin, 0)
            metrics = QtGui.QFontMetrics(item.font())
            within = QtCore.QRect(0, 0, room.width(), 10 * room.height())
            needed = metrics.boundingRect(within, QtCore.Qt.TextWordWrap, item.text())
            if needed.width() > room.width() or needed.height() > room.height():
                found.append(item.text())
    header = table.horizontalHeader()
    return found + [
        table.horizontalHeaderItem(column).text()
        for column in range(table.columnCount())
        if header.sectionSizeFromContents(column).width() > header.sectionSize(column)
    ]


def around(widget, kind):
    """The nearest widget of a kind that holds another."""
    while not isinstance(widget, kind):
        widget = widget.parent()
    return widget


def look(page):
    table = page.findChildren(QtGui.QTableWidget)[0]
    dock, area = around(page, QtGui.QDockWidget), around(page, QtGui.QScrollArea)
    return {
        "dock": dock.width(),
        "scrolled": area.horizontalScrollBar().maximum(),
        "cut": cut(table),
        "labels": [
            label.text()
            for label in page.findChildren(QtGui.QLabel)
            if label.width() < label.minimumSizeHint().width() or label.height() < label.heightForWidth(label.width())
        ],
    }


def user(found):
    session.window(DOCK)
    yield 500
    document = App.newDocument("narrow")
    for report in given.GIVEN["vaults"]:
        obj = vault.make(document, report["family"])
        obj.Report = json.dumps(report)
        panel.show_results(obj)
        yield 500
        page = next(w for w in QtGui.QApplication.allWidgets() if w.windowTitle() == obj.Label and w.isVisible())
        found[report["family"]] = look(page)
        session.screenshot(f"panel_{report['family']}")


session.run(user)
