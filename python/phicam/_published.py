"""The published tables and figures, computed again."""

from __future__ import annotations

from typing import Any

from . import _native
from ._arrays import threads_of, whole
from ._finding import Finding
from ._progress import Progress, told


class Reproduction(Finding):
    """A published table or figure, computed again; ``values`` holds its checks, published beside computed."""

    def __init__(self, found: dict[str, Any], holds: bool) -> None:
        super().__init__(found)
        #: Whether what was published holds: its numbers, or where no double can reach them its trends.
        self.holds = holds


def published() -> list[str]:
    """The published items that :func:`reproduce` computes.

    >>> import phicam
    >>> "table2" in phicam.published()
    True
    """
    return _native.published()


def reproduce(
    item: str,
    *,
    most_elements: int = 64,
    draws: int = 20,
    seed: int = 1,
    threads: int | None = None,
    progress: Progress = False,
) -> Reproduction:
    """Computes a published table or figure again, as ``phicam reproduce ITEM`` does.

    Parameters
    ----------
    item : str
        One of :func:`published`, or another figure of the same computation: ``fig16``.
    most_elements : int
        Curves with more elements a side are left out, 8 to 64.
    draws, seed : int
        Draws of the noise where there is any, and the first seed.

    >>> import phicam
    >>> found = phicam.reproduce("table2", most_elements=8)
    >>> found.holds
    True
    """
    report = told(f"reproduce {item}", progress)
    found, holds = _native.reproduce(
        item,
        most_elements=whole(most_elements, "most_elements", 8, 64),
        draws=whole(draws, "draws", 2, 100_000),
        seed=whole(seed, "seed"),
        threads=threads_of(threads),
        progress=report,
    )
    return Reproduction(found, holds)
