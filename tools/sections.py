"""A page of which programs write some sections, each between two markers; what stands around them stays."""

from __future__ import annotations

BEGIN, END = "<!-- {} {} -->", "<!-- end {} -->"


def replaced(page: str, kind: str, name: str, section: str, before: str = "") -> str:
    """The page (Markdown) with another section between `<!-- KIND NAME -->` and `<!-- end NAME -->`.

    A section that is not there yet comes, under its name, before the first line `before`, or else at the end.

    Raises:
        ValueError: there is one of the markers without the other.
    """
    begin, end = BEGIN.format(kind, name), END.format(name)
    block = f"{begin}\n\n{section}\n\n{end}"
    if begin not in page and end not in page:
        head, line, tail = page.partition(f"\n{before}\n") if before else (page, "", "")
        return f"{head.rstrip()}\n\n## {name.capitalize()}\n\n{block}\n{line}{tail}"
    head, opened, rest = page.partition(begin)
    _, closed, tail = rest.partition(end)
    if not (opened and closed):
        raise ValueError(f"{begin} and {end} must both stand in the page, in this order")
    return head + block + tail
