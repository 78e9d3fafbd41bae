"""What notebooks show."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape

from . import _native
from ._arrays import Floats

#: Title, values (rows × columns, row 0 lowest), names of the axes, width in inches.
Panel = tuple[str, Floats, tuple[str, str], float]


def gallery(title: str, unit: str, panels: Iterable[Panel], *, reflectance: bool = False) -> str:
    """Pictures side by side on one scale, as SVG."""
    given = [
        (name, (values.shape[1], values.shape[0]), values.ravel().tolist(), axes, width)
        for name, values, axes, width in panels
    ]
    return _native.gallery_svg(title, unit, reflectance, given)


def table(rows: Sequence[Sequence[object]], head: Sequence[str]) -> str:
    """A table with a head."""
    first = "".join(f"<th>{escape(name)}</th>" for name in head)
    body = "".join("<tr>" + "".join(f"<td>{escape(str(cell))}</td>" for cell in row) + "</tr>" for row in rows)
    return f"<table><thead><tr>{first}</tr></thead><tbody>{body}</tbody></table>"


def sentence(text: str, tone: str = "Plain") -> str:
    """What is said, in the colour of its tone."""
    colour = {"Good": "#009e73", "Bad": "#d55e00"}.get(tone, "currentColor")
    return f'<p style="color: {colour}; font-weight: bold">{escape(text)}</p>'
