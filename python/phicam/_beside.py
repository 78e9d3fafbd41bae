"""What photographs hold beside the light of the hidden surface."""

from __future__ import annotations

from typing import Any, TypedDict

from numpy.typing import ArrayLike

from ._arrays import flag, maybe, setting, shaped, whole


class Beside(TypedDict):
    """Terms that are estimated with what is asked for."""

    frame_constant: bool
    frame_polynomial: int | None
    frame_patterns: Any
    background: bool
    glare_pattern: Any
    free_scale: bool
    frame_gain: float | None
    scale_error: float | None
    left_out: Any
    pixels: tuple[int, int] | None


def beside(
    shape: tuple[int, int],
    pixels: tuple[int, int] | None,
    *,
    frame_constant: bool,
    frame_polynomial: int | None,
    frame_patterns: ArrayLike | None,
    background: bool,
    glare_pattern: ArrayLike | None,
    free_scale: bool,
    frame_gain: float | None,
    scale_error: float | None,
    left_out: ArrayLike | None,
) -> Beside:
    """They, checked, of photographs of this shape, pixels × spots."""
    glare, flags = maybe(glare_pattern, "glare_pattern"), maybe(left_out, "left_out")
    return Beside(
        frame_constant=flag(frame_constant, "frame_constant"),
        frame_polynomial=None if frame_polynomial is None else whole(frame_polynomial, "frame_polynomial", 0, 8),
        frame_patterns=maybe(frame_patterns, "frame_patterns"),
        background=flag(background, "background"),
        glare_pattern=None if glare is None else shaped(glare, shape, "glare_pattern"),
        free_scale=flag(free_scale, "free_scale"),
        frame_gain=setting(frame_gain, "frame_gain"),
        scale_error=setting(scale_error, "scale_error"),
        left_out=None if flags is None else shaped(flags, shape, "left_out"),
        pixels=pixels,
    )
