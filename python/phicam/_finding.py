"""What was found, in one vocabulary: a sentence, tables, figures."""

from __future__ import annotations

import json
import os
from html import escape
from pathlib import Path
from typing import Any

from . import _html


class Finding:
    """What a study, a test or an estimate found.

    Attributes
    ----------
    title : str
        What was studied.
    sentence : str
        The answer, with its numbers; may be empty where tables say all.
    notes : list of str
        Assumptions, settings, what could not be seen.
    values : dict or list
        The whole result, as the command's JSON.
    files : dict
        Text of every table (CSV) and figure (SVG) by its name.
    """

    def __init__(self, found: dict[str, Any]) -> None:
        self._found = dict(found)
        self.values: Any = json.loads(found["json"])
        finding = json.loads(found["finding"])
        self._finding: dict[str, Any] = finding
        self.title: str = finding["title"]
        self.sentence: str = finding["sentence"]
        self.notes: list[str] = finding["notes"]
        self.files: dict[str, str] = dict(found["files"])

    def table(self, number: int = 0) -> dict[str, list[Any]]:
        """A table as columns by their keys: numbers, names, booleans; None where a number is not defined. Of estimates
        there is a column KEY_stderr too. Raises IndexError where there is no such table.

        >>> import phicam
        >>> scene = phicam.Scene("bench").replace({"laser.spots.per_side": 2, "camera.pixels": (4, 4)})
        >>> phicam.study("convergence", scene, samples=[64, 256]).table(0)["estimator"][0]
        'independent'
        """
        table = self._finding["tables"][number]
        columns: dict[str, list[Any]] = {}
        for at, column in enumerate(table["columns"]):
            key = column["key"] or column["name"] or f"column {at}"
            cells = [row[at] for row in table["rows"]]
            columns[key] = [_value(cell) for cell in cells]
            if column["estimated"]:
                columns[f"{key}_stderr"] = [_stderr(cell) for cell in cells]
        return columns

    @property
    def tables(self) -> list[dict[str, list[Any]]]:
        """Every table: see :meth:`table`."""
        return [self.table(number) for number in range(len(self._finding["tables"]))]

    def save(self, folder: str | os.PathLike[str]) -> list[Path]:
        """Writes :attr:`files`, and the result as result.json, into `folder`, which is made; their paths.

        >>> import phicam, tempfile
        >>> scene = phicam.Scene("bench").replace({"laser.spots.per_side": 2, "camera.pixels": (4, 4)})
        >>> found = phicam.study("convergence", scene, samples=[64, 256])
        >>> sorted(path.name for path in found.save(tempfile.mkdtemp()))
        ['convergence.svg', 'result.json']
        """
        to = Path(folder)
        to.mkdir(parents=True, exist_ok=True)
        written: list[Path] = []
        for name, text in {**self.files, "result.json": self._found["json"]}.items():
            path = to / Path(name).name
            path.write_text(text, encoding="utf-8")
            written.append(path)
        return written

    def __str__(self) -> str:
        return str(self._found["text"])

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self.title!r})"

    def _repr_html_(self) -> str:
        parts = [f"<h4>{escape(self.title)}</h4>", _html.sentence(self.sentence, self._finding["tone"])]
        parts += [text for name, text in self.files.items() if name.endswith(".svg")]
        parts += self._found.get("galleries", [])
        for table in self._finding["tables"]:
            if table["place"] == "File":
                continue
            head = [column["name"] for column in table["columns"]]
            rows = [[_shown(cell) for cell in row] for row in table["rows"][:50]]
            parts.append(f"<p>{escape(table['caption'])}</p>" + _html.table(rows, head))
        parts += [f"<p>{escape(note)}</p>" for note in self.notes]
        return "\n".join(parts)

    def __getstate__(self) -> dict[str, Any]:
        return dict(self.__dict__)


def _value(cell: dict[str, Any]) -> Any:
    """What a typed cell holds."""
    (kind, content), *_ = cell.items()
    return content["value"] if kind == "Estimate" else content


def _stderr(cell: dict[str, Any]) -> Any:
    """The standard error of an estimate."""
    return cell["Estimate"]["stderr"] if "Estimate" in cell else None


def _shown(cell: dict[str, Any]) -> str:
    """A cell for people."""
    value, error = _value(cell), _stderr(cell)
    if value is None:
        return "–"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return f"{value:.4g}" + (f" ± {error:.2g}" if error is not None else "")
    return str(value)
