"""The report as one HTML page."""
import html
import os
from pathlib import Path

STYLE = """
body { font: 15px/1.5 "DejaVu Sans", sans-serif; background: #16181c; color: #dcdfe4; margin: 2em auto; max-width: 1240px; padding: 0 1em }
h1, h2 { color: #fff } h2 { border-top: 1px solid #3e434c; padding-top: 1em; margin-top: 2em } a { color: #eca754 }
table { border-collapse: collapse; margin: 1em 0 } td, th { border: 1px solid #3e434c; padding: .25em .7em; text-align: right }
td:first-child, th { text-align: left; background: #202329 }
figure { display: inline-block; width: min-content; margin: .4em; vertical-align: top } figure img { display: block; image-rendering: pixelated }
figcaption { font-size: 12px; color: #a6adb8 } details { color: #a6adb8 } pre { white-space: pre-wrap; font-size: 12px }
"""


class Page:
    """Collects sections; write() gives the file. Pictures are named from the root and linked relative to the page."""

    def __init__(self, root, folder, title, introduction):
        self.root, self.folder = root, folder
        self.title, self.parts, self.contents = title, [f"<p>{introduction}</p>"], []

    def section(self, title, text):
        """Begins a section; `text` is HTML."""
        name = f"s{len(self.contents) + 1}"
        self.contents.append(f'<li><a href="#{name}">{html.escape(title)}</a></li>')
        self.parts.append(f'<h2 id="{name}">{html.escape(title)}</h2>\n<p>{text}</p>')

    def table(self, head, rows):
        """Plain text cells."""
        cells = lambda row, tag: "".join(f"<{tag}>{html.escape(str(cell))}</{tag}>" for cell in row)
        self.parts.append("<table><tr>" + cells(head, "th") + "</tr>\n" +
                          "\n".join(f"<tr>{cells(row, 'td')}</tr>" for row in rows) + "</table>")

    def pictures(self, items):
        """(file, caption) pairs side by side, beginning on a new line."""
        figures = []
        for file, caption in items:
            link = os.path.relpath(self.root / file, self.root / self.folder)
            figures.append(f'<figure><img src="{html.escape(link)}" alt="{html.escape(caption)}">'
                           f"<figcaption>{html.escape(caption)}</figcaption></figure>")
        self.parts.append("<div>" + "\n".join(figures) + "</div>")

    def note(self, text):
        """A paragraph of HTML."""
        self.parts.append(f"<p>{text}</p>")

    def commands(self, lines):
        """The command lines behind what was shown."""
        unique = list(dict.fromkeys(lines))
        self.parts.append(f"<details><summary>{len(unique)} commands</summary><pre>{html.escape(chr(10).join(unique))}"
                          "</pre></details>")

    def write(self):
        """Writes index.html."""
        file = Path(self.root / self.folder / "index.html")
        file.write_text(f"<!DOCTYPE html>\n<html lang=\"en\"><meta charset=\"utf-8\"><title>{html.escape(self.title)}</title>"
                        f"<style>{STYLE}</style>\n<h1>{html.escape(self.title)}</h1>\n<ol>{''.join(self.contents)}</ol>\n" +
                        "\n".join(self.parts) + "\n</html>\n", encoding="utf-8")
        return file
