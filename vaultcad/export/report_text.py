"""What report.html says about terms, and how it looks."""

from __future__ import annotations

TERMS: tuple[tuple[str, str], ...] = (
    ("intrados, extrados", "the lower and the upper surface of the masonry; a scan from below sees the intrados"),
    ("springing", "the level where the vault leaves its walls; all heights count from it"),
    ("crown", "the highest line or point of the intrados; the rise is its height above the springing"),
    ("deviation", "distance of a scanned point to the ideal model; positive into the stone, negative into the room"),
    ("RMS", "square root of the mean of the squared deviations"),
    ("95 % limit", "the distance that 95 % of the points keep"),
    (
        "LOA",
        "USIBD level of accuracy of that limit: LOA10 above 5 cm, LOA20 to 5 cm, LOA30 to 15 mm, LOA40 to 5 mm, "
        "LOA50 to 1 mm",
    ),
    (
        "±",
        "one standard deviation: about two times in three the true value is nearer. The true value is that of the "
        "vault as it was built: a settlement that looks like another shape is allowed for",
    ),
    ("seen", "of what a scan of the whole vault would tell of a size, the share that this scan tells"),
    ("coverage", "share of the surface on which there are scanned points"),
    ("as built", "the ideal model bent smoothly to follow settlement and bulges of the stone"),
)
"""Terms of every report; those of its families follow."""

FILES: tuple[tuple[str, str], ...] = (
    ("model.step", "exact solids for CAD: FreeCAD, Rhino, CATIA"),
    ("model.ifc", "IFC4 for BIM; in Revit link it"),
    ("model.glb", "coloured mesh for any 3D viewer"),
    ("plan.dxf", "plan for CAD, in metres: outlines, projected groins, arches, numbers, heights"),
    ("model.wld", "world file: where the coordinates of model.step lie in those of the scan"),
    ("segments.laz", "every point with its component and its deviation: CloudCompare, ReCap"),
    ("report.json", "all figures of this page for programs"),
)

STYLE = """
:root { color-scheme: light dark; --ink: #1d1f23; --soft: #5d6470; --paper: #fbfaf8; --card: #fff; --line: #dcd9d2;
  --accent: #2f6f8f; }
@media (prefers-color-scheme: dark) { :root { --ink: #e8e6e1; --soft: #a3a9b3; --paper: #17191c; --card: #1f2226;
  --line: #3a3e45; --accent: #7fbbd6; } }
* { box-sizing: border-box; }
body { margin: 0 auto; max-width: 66rem; padding: 2rem 1.25rem 4rem; background: var(--paper); color: var(--ink);
  font: 15px/1.5 system-ui, "Segoe UI", Roboto, "Helvetica Neue", sans-serif; overflow-wrap: break-word; }
h1 { font-size: 1.9rem; line-height: 1.2; margin: 0 0 .25rem; }
h2 { font-size: 1.15rem; margin: 2.2rem 0 .6rem; }
p { margin: .3rem 0 .8rem; max-width: 48rem; }
.soft, figcaption, .meaning { color: var(--soft); }
.lead { font-size: 1.08rem; }
.warning { border-left: 4px solid #c77; padding-left: .7rem; }
.figures { display: grid; grid-template-columns: repeat(auto-fit, minmax(10rem, 1fr)); gap: .6rem; margin: 1.2rem 0; }
.figures div { background: var(--card); border: 1px solid var(--line); border-radius: .5rem; padding: .6rem .7rem; }
.figures b { display: block; white-space: nowrap; font-size: 1.15rem; font-weight: 600;
  font-variant-numeric: tabular-nums; }
.figures span { color: var(--soft); font-size: .85rem; }
.drawings { display: flex; flex-wrap: wrap; gap: 1rem; align-items: flex-end; }
figure { margin: 0; background: var(--card); border: 1px solid var(--line); border-radius: .5rem; padding: .6rem; }
.drawings figure { flex: 1 1 0; min-width: 0; max-width: 34rem; }
@media (max-width: 44rem) { .drawings { display: block; } .drawings figure { max-width: none; margin-bottom: 1rem; } }
.map { max-width: 24rem; margin-top: 1rem; }
.plans .drawings { display: block; } .plans figure { max-width: none; margin-bottom: 1rem; }
header ~ header { border-top: 2px solid var(--line); margin-top: 3rem; padding-top: 1.5rem; }
figcaption { font-size: .85rem; margin-top: .3rem; }
svg { display: block; width: 100%; height: auto; max-height: 34rem; }
.chart text { font-size: 11px; fill: var(--soft); text-anchor: middle; }
.chart rect { stroke: var(--soft); stroke-width: .5; }
.chart path { stroke: var(--soft); stroke-width: 1; fill: none; }
table { border-collapse: collapse; width: 100%; background: var(--card); border: 1px solid var(--line); }
th, td { text-align: left; padding: .3rem .6rem; border-bottom: 1px solid var(--line); vertical-align: top; }
th { font-weight: 600; font-size: .85rem; color: var(--soft); }
td.n, th.n { text-align: right; font-variant-numeric: tabular-nums; white-space: nowrap; }
.swatch { display: inline-block; width: .85em; height: .85em; border-radius: .2em; margin-right: .45em; }
.bar { display: inline-block; height: .6em; background: var(--accent); border-radius: .2em; vertical-align: middle; }
.two { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(19rem, 100%), 1fr)); gap: 1rem;
  align-items: start; }
.wide { overflow-x: auto; }
@media screen and (max-width: 44rem) { thead { display: none; } table, tbody, td { display: block; }
  tr { display: grid; grid-template-columns: repeat(auto-fill, minmax(5.5rem, 1fr)); gap: .3rem .6rem;
    padding: .5rem .6rem; border-bottom: 1px solid var(--line); font-size: .875rem; }
  td, td.n { padding: 0; border: 0; text-align: left; white-space: normal; } td.long { grid-column: 1 / -1; }
  td::before { content: attr(data-title); display: block; font-size: .75rem; color: var(--soft); }
  .bar { display: block; margin: .35em 0 0; } }
@media (max-width: 30rem) { .figures { grid-template-columns: repeat(2, 1fr); }
  .figures b { white-space: normal; font-size: 1rem; }
  .chart { overflow: visible; } .chart text { font-size: 20px; } }
dl { display: grid; grid-template-columns: fit-content(40%) 1fr; gap: .2rem 1rem; margin: 0; }
dt { font-weight: 600; } dd { margin: 0; color: var(--soft); overflow-wrap: anywhere; }
a { color: var(--accent); }
.swatch, .bar, .drawing, .chart rect { print-color-adjust: exact; -webkit-print-color-adjust: exact; }
@media print { body { padding: 0; max-width: none; font-size: 11pt; background: none; } .wide { overflow: visible; }
  section, figure, table, .figures { break-inside: avoid; } h2 { break-after: avoid; }
  header ~ header { break-before: page; } }
"""
