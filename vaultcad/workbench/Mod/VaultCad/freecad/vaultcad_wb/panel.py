"""The task panel: a fit under way, then what it found, and the families that it could be instead."""

from __future__ import annotations

import json
from html import escape
from math import degrees
from typing import Any

import FreeCADGui as Gui
from PySide import QtCore, QtGui

from .catalogue import families, scale, shown
from .client import GoneError, RefusedError
from .fit import Fit
from .fit import report as measured
from .texts import complain, translate
from .view import icon

EVERY = 100  # [ms] between two looks at the fit
MARGIN = 4  # [px] about a page of results: FreeCAD's own lies around it
ROW = 22  # [px], the least height of a row of the table


def start(
    points: Any, family: str = "auto", region: dict[str, Any] | None = None, instead: Any = None
) -> FitPanel | None:
    """Begin a fit and show its panel; None if it could not begin."""
    try:
        fit = Fit(points, family, region, instead)
    except GoneError as error:
        complain(str(error))
        return None
    panel = FitPanel(fit)
    Gui.Control.closeDialog()
    Gui.Control.showDialog(panel)
    return panel


def show_results(obj: Any) -> None:
    """The panel with what the fit found of a vault."""
    Gui.Control.closeDialog()
    Gui.Control.showDialog(ResultPanel([obj]))


class FitPanel:
    """Progress of a fit, with a button to cancel it."""

    def __init__(self, fit: Fit) -> None:
        self.fit = fit
        self.vaults: list[Any] = []
        self.form = QtGui.QWidget()
        self.form.setWindowTitle(translate("VaultCad", "Fit vault"))
        self.form.setWindowIcon(QtGui.QIcon(icon("fit")))
        self.text = QtGui.QLabel(translate("VaultCad", "reading"))
        self.text.setWordWrap(True)
        self.bar = QtGui.QProgressBar()
        layout = QtGui.QVBoxLayout(self.form)
        layout.addWidget(QtGui.QLabel(translate("VaultCad", "Fitting {}").format(fit.points.Label)))
        layout.addWidget(self.text)
        layout.addWidget(self.bar)
        layout.addStretch()
        self.timer = QtCore.QTimer(self.form)
        self.timer.timeout.connect(self.look)
        self.timer.start(EVERY)

    def getStandardButtons(self) -> int:
        """Cancel alone; close once it failed."""
        return int(QtGui.QDialogButtonBox.Cancel)

    def look(self) -> None:
        """Ask how far the fit is, and go on to the results when it is done."""
        try:
            found = self.fit.poll()
        except (RefusedError, GoneError) as error:
            self.timer.stop()
            self.bar.hide()
            self.text.setText(f"<b>{escape(str(error))}</b>")
            complain(str(error))
            return
        if found is None:
            self.text.setText(translate("VaultCad", self.fit.stage))
            self.bar.setValue(round(100 * self.fit.share))
            return
        self.timer.stop()
        self.vaults = found
        # Not from within the timer of a widget that is to go away.
        QtCore.QTimer.singleShot(0, self._done)

    def _done(self) -> None:
        Gui.Control.closeDialog()
        Gui.Control.showDialog(ResultPanel(self.vaults))

    def reject(self) -> bool:
        """Cancel."""
        if self.timer.isActive():
            self.timer.stop()
            self.fit.cancel()
        Gui.Control.closeDialog()
        return True


class ResultPanel:
    """Parameters with their standard deviations, the deviation of the stone, and other families to switch to."""

    def __init__(self, vaults: list[Any]) -> None:
        self.form = [self._page(obj) for obj in vaults]

    def getStandardButtons(self) -> int:
        """Close."""
        return int(QtGui.QDialogButtonBox.Close)

    def reject(self) -> bool:
        """Close."""
        Gui.Control.closeDialog()
        return True

    def _page(self, obj: Any) -> Any:
        report = json.loads(obj.Report)
        if measured(obj) is None:
            why = translate("VaultCad", "edited since the fit, and not measured: these are the figures of the fit")
            report["flags"] = [why, *report["flags"]]
        scan = getattr(obj, "Scan", None)
        page = QtGui.QWidget()
        page.setWindowTitle(obj.Label)
        page.setWindowIcon(QtGui.QIcon(icon(obj.Proxy.declaration["id"])))
        layout = QtGui.QVBoxLayout(page)
        layout.setContentsMargins(MARGIN, MARGIN, MARGIN, MARGIN)
        summary = QtGui.QLabel(_summary(report))
        summary.setWordWrap(True)
        layout.addWidget(summary)
        layout.addWidget(_legend(scan.Limit.Value if scan else scale()["limit"]))
        layout.addWidget(_table(report["estimates"]))
        if report["alternatives"]:
            layout.addLayout(_alternatives(obj, report))
        return page


def _summary(report: dict[str, Any]) -> str:
    d = report["deviation"]
    sure, deviation = translate("VaultCad", "confidence"), translate("VaultCad", "deviation")
    near, seen = translate("VaultCad", "within"), translate("VaultCad", "of the intrados seen")
    rows = [
        f"<b>{escape(report['title'])}</b>, {sure} {report['confidence']:.0%}",
        f"{deviation}: rms {1000 * d['rms']:.1f} mm, 95 % &lt; {1000 * d['p95']:.1f} mm, {d['loa']}",
        ", ".join(f"{share:.0%} {near} {1000 * float(limit):g} mm" for limit, share in d["within"].items()),
        f"{report['coverage']:.0%} {seen}",
        *(f"<span style='color:#b00'>{escape(flag)}</span>" for flag in report["flags"]),
    ]
    return "<br>".join(rows)


def _legend(limit: float) -> Any:
    """The scale of the deviations as far as a limit [mm], as the points are coloured."""
    stops = ", ".join(
        f"stop:{(1 + share) / 2:g} rgb({', '.join(str(round(255 * c)) for c in colour)})"
        for share, colour in scale()["stops"]
    )
    room, stone = translate("VaultCad", "room"), translate("VaultCad", "stone")
    bar = QtGui.QFrame()
    bar.setObjectName("scale")  # or each label would have a scale of its own
    bar.setStyleSheet(f"#scale {{ background: qlineargradient(x1:0, x2:1, {stops}) }} QLabel {{ color: black }}")
    row = QtGui.QHBoxLayout(bar)
    row.setContentsMargins(4, 2, 4, 2)
    left, middle, right = QtCore.Qt.AlignLeft, QtCore.Qt.AlignCenter, QtCore.Qt.AlignRight
    for text, side in ((f"−{limit:g} mm\n{room}", left), ("0", middle), (f"+{limit:g} mm\n{stone}", right)):
        label = QtGui.QLabel(text)
        label.setAlignment(side | QtCore.Qt.AlignVCenter)
        row.addWidget(label, 1)
    return bar


def _table(estimates: dict[str, dict[str, Any]]) -> Any:
    """Names take the room that the numbers leave, in several lines where they must: the panel is narrow."""
    columns = [translate("VaultCad", "Parameter"), translate("VaultCad", "Value"), "±"]
    table = QtGui.QTableWidget(len(estimates), len(columns))
    table.setHorizontalHeaderLabels(columns)
    table.verticalHeader().hide()
    table.setEditTriggers(QtGui.QAbstractItemView.NoEditTriggers)
    left, right = (side | QtCore.Qt.AlignVCenter for side in (QtCore.Qt.AlignLeft, QtCore.Qt.AlignRight))
    for row, (name, estimate) in enumerate(estimates.items()):
        std = "" if estimate["std"] is None else _std(estimate["std"], estimate["unit"])
        texts = (name.replace("_", " "), shown(estimate["value"], estimate["unit"]), std)
        for column, (text, side) in enumerate(zip(texts, (left, right, right), strict=True)):
            item = QtGui.QTableWidgetItem(text)
            item.setTextAlignment(int(side))
            item.setToolTip(estimate["meaning"])
            table.setItem(row, column, item)
    header, modes = table.horizontalHeader(), QtGui.QHeaderView
    for column, mode in enumerate((modes.Stretch, modes.ResizeToContents, modes.ResizeToContents)):
        header.setSectionResizeMode(column, mode)
    table.verticalHeader().setMinimumSectionSize(ROW)
    table.verticalHeader().setSectionResizeMode(modes.ResizeToContents)
    table.setMinimumHeight(260)
    return table


def _std(value: float, unit: str) -> str:
    if unit == "m":
        return f"{1000 * value:.1f} mm"
    return f"{degrees(value):.2g}°" if unit == "rad" else f"{value:.2g}"


def _alternatives(obj: Any, report: dict[str, Any]) -> Any:
    rows = QtGui.QVBoxLayout()
    rows.addWidget(QtGui.QLabel(translate("VaultCad", "Or else:")))
    choice = QtGui.QComboBox()
    choice.setSizeAdjustPolicy(QtGui.QComboBox.AdjustToMinimumContentsLengthWithIcon)  # long titles widen no panel
    titles = {name: family["title"] for name, family in families().items()}
    for name, score in report["alternatives"]:
        choice.addItem(f"{titles.get(name, name)} ({score:.0%})", name)
    button = QtGui.QPushButton(translate("VaultCad", "Fit this instead"))
    button.setToolTip(
        translate("VaultCad", "Fit the chosen family to the same points; it takes the place of this vault")
    )
    button.clicked.connect(lambda: start(obj.Scan, choice.currentData(), report["region"], obj))
    rows.addWidget(choice)
    rows.addWidget(button)
    return rows
