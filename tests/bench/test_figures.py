"""Figures of benchmarks: as text, as JSON, in the documentation, and against those of an earlier run."""

from dataclasses import replace

import pytest

from bench import __main__ as program
from bench import measured, tables
from bench.figures import Table, clock, count, iou, label, number, share
from bench.record import Record
from bench.regressions import compared, main, verdict
from tools.sections import BEGIN, END

COLUMNS = (label("cloud"), clock("time"), iou("IoU"), number("rooms"), count("right", "rooms", "more"))
ROWS = (("sail", 1.0, 0.99, 100, 97), ("two words", 0.5, None, 100, 90))
HERE = Record(
    "2026-11-29", {"cores": 2, "memory_gib": 8, "processor": "P", "system": "Linux"}, {"python": "3.11"}, "abc", 0.5
)


def table(rows=ROWS, **settings) -> Table:
    return Table("clouds", "some clouds", {"points": 10_000} | settings, COLUMNS, rows, ["a note"])


def record(rows=ROWS, machine=None, **settings) -> Record:
    return replace(HERE, machine=machine or HERE.machine, benchmarks={"shapes": (table(rows, **settings),)})


def slower(ratio: float):
    return [(name, time * ratio, *rest) for name, time, *rest in ROWS]


def test_rows_are_shown_one_by_one_as_they_come(capsys):
    seen = []

    def rows():
        for row in ROWS:
            seen.append(capsys.readouterr().out)
            yield row

    told = tables.show(table(rows()))
    assert told.rows == ROWS
    assert "cloud" in seen[0]
    assert "sail" in seen[1]
    assert "a note" in capsys.readouterr().out


def test_figures_stand_under_their_names_with_units():
    title, names, sail, words, note = tables.lines(table())
    assert title == "some clouds (points 10,000)"
    assert names == "cloud           time [s]      IoU    rooms    right"
    assert sail == "sail                1.00   0.9900      100       97"
    assert words.split() == ["two", "words", "0.50", "–", "100", "90"]
    assert note == "a note"


def test_a_record_comes_back_from_json_as_it_was(tmp_path):
    record().write(tmp_path / "figures.json")
    assert Record.read(tmp_path / "figures.json") == record()


def test_a_record_tells_machine_and_code_and_no_name_of_the_machine():
    import platform

    here = Record.here()
    assert here.machine["cores"] >= 1
    assert here.machine["memory_gib"] >= 1
    assert platform.node() not in str(here)
    assert here.versions["numpy"]


@pytest.mark.parametrize("text", ["", "[]", "{}", '{"schema": 9}', '{"schema": 1, "date": ""}'])
def test_a_file_that_holds_no_figures_is_named(tmp_path, text, capsys):
    path = tmp_path / "other.json"
    path.write_text(text, encoding="utf-8")
    assert main([str(path), str(path)]) == 2
    assert str(path) in capsys.readouterr().out


def test_a_section_is_replaced_and_what_stands_around_it_stays(tmp_path):
    page = tmp_path / "measured.md"
    page.write_text("before\n\n<!-- bench shapes -->\nold\n<!-- end shapes -->\n\nafter\n", encoding="utf-8")
    for _ in range(2):  # the second time changes nothing
        measured.write(record(), page)
        told = page.read_text(encoding="utf-8")
        assert told.startswith(
            "before\n\n<!-- bench shapes -->\n\nOn 2026-11-29, 2 cores, 8 GiB, P, Linux, load 0.5 before, "
        )
        assert told.endswith("    a note\n\n<!-- end shapes -->\n\nafter\n")
        assert "old" not in told


def test_a_benchmark_without_a_section_gets_one_at_the_end_and_details_stay_out(tmp_path):
    page = tmp_path / "measured.md"
    page.write_text("# Measured\n", encoding="utf-8")
    measured.write(
        replace(HERE, benchmarks={"rooms": (replace(table(), title="every room", detail=True), table())}), page
    )
    assert "## Rooms\n\n<!-- bench rooms -->" in page.read_text(encoding="utf-8")
    assert "every room" not in page.read_text(encoding="utf-8")


def test_half_a_section_is_refused(tmp_path):
    page = tmp_path / "measured.md"
    page.write_text("<!-- bench shapes -->\n", encoding="utf-8")
    with pytest.raises(ValueError, match="<!-- end shapes -->"):
        measured.write(record(), page)


def test_every_benchmark_has_its_section_in_the_documentation():
    page = measured.PAGE.read_text(encoding="utf-8")
    for name in program.BENCHMARKS:
        assert page.count(BEGIN.format("bench", name)) == page.count(END.format(name)) == 1


@pytest.mark.parametrize(
    ("column", "old", "new", "cases", "said"),
    [
        (clock("time"), 1.0, 1.2, (1, 1), ""),
        (clock("time"), 1.0, 1.3, (1, 1), "worse"),
        (clock("time"), 1.3, 1.0, (1, 1), "better"),
        (clock("time"), 0.010, 0.015, (1, 1), ""),  # less than its digits tell
        (iou("IoU"), 0.99, 0.985, (1, 1), "worse"),
        (iou("IoU"), 0.99, 0.9895, (1, 1), ""),
        (count("right", "rooms", "more"), 97, 95, (100, 100), ""),
        (count("right", "rooms", "more"), 97, 88, (100, 100), "worse"),
        (count("invented", "scenes", "less"), 0, 6, (200, 200), "worse"),
        (share("within", "numbers"), 0.95, 0.94, (1000, 1000), ""),
        (share("within", "numbers"), 0.95, 0.90, (1000, 1000), "worse"),
        (share("within", "numbers"), 0.90, 0.95, (1000, 1000), "better"),
    ],
)
def test_what_moved_by_more_than_its_noise_is_told(column, old, new, cases, said):
    assert verdict(column, old, new, cases) == said


def test_what_got_worse_is_said_with_its_ratio_and_ends_with_one(tmp_path, capsys):
    old, new = tmp_path / "old.json", tmp_path / "new.json"
    record().write(old)
    record(slower(1.5)).write(new)
    assert main([str(old), str(new)]) == 1
    assert "worse   shapes, clouds, sail, time: 1.00 -> 1.50, x 1.500" in capsys.readouterr().out
    assert main([str(new), str(old)]) == 0
    assert main([str(old), str(old)]) == 0


def test_times_of_another_machine_are_not_judged():
    changes, _ = compared(record(), record(slower(9), machine={**HERE.machine, "cores": 64}))
    assert {change.where.rpartition(", ")[2] for change in changes} == {"IoU", "right"}


def test_times_of_a_busy_machine_are_not_judged(tmp_path, capsys):
    old, new = tmp_path / "old.json", tmp_path / "new.json"
    record().write(old)
    replace(record(slower(9)), load=2.0).write(new)
    assert main([str(old), str(new)]) == 0
    assert "busy: times are not judged" in capsys.readouterr().out


def test_other_settings_and_rows_that_are_gone_are_said():
    assert compared(record(), record(points=5)) == ([], ["shapes, clouds: the settings differ"])
    assert compared(record(), record(ROWS[:1]))[1] == ["shapes, clouds, two words: only in the old run"]
    assert compared(record(), HERE) == ([], ["shapes, clouds: only in the old run"])


def test_the_program_writes_what_it_shows(tmp_path, monkeypatch, capsys):
    page = tmp_path / "measured.md"
    page.write_text("# Measured\n", encoding="utf-8")
    monkeypatch.setattr(measured, "write", lambda record, write=measured.write: write(record, page))
    monkeypatch.setitem(program.BENCHMARKS, "shapes", lambda chosen: [table()])
    assert program.main(["shapes", "--json", str(tmp_path / "f.json"), "--write"]) == 0
    shown = capsys.readouterr().out
    for line in tables.lines(table()):
        assert line in shown
        assert line in page.read_text(encoding="utf-8")
    assert Record.read(tmp_path / "f.json").benchmarks == {"shapes": (table(),)}
