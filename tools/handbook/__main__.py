"""Writes what docs/families.md, its pictures and README.md say of the families anew from their declarations."""

from tools.handbook.pages import pages

if __name__ == "__main__":
    for path, text in pages().items():
        path.parent.mkdir(exist_ok=True)
        path.write_text(text, encoding="utf-8")
