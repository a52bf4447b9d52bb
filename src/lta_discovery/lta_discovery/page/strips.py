"""Render small inline charts in tables as plain HTML: points, bars and intervals on a scale."""

from collections.abc import Mapping, Sequence
import math
from typing import Final

MARGIN: Final = 2.0  # % of the strip on either side


def strip_position(value: float, low: float, high: float) -> float:
    """Return the position of a value on a strip. [%]"""
    share = (value - low) / (high - low) if high > low else 0.5
    return MARGIN + (100.0 - 2.0 * MARGIN) * min(max(share, 0.0), 1.0)


def render_log_points(
    values: Mapping[str, float], low: float, high: float, floor: float = math.nan
) -> str:
    """
    Return points on a logarithmic scale.

    `values`: by kind, which selects the colour; values that are not positive are left out.
    """
    ends = math.log(low), math.log(high)
    parts = []
    if floor > 0.0:
        parts.append(
            f'<i class="floor" style="width:{strip_position(math.log(floor), *ends):.1f}%"></i>'
        )
    logs = {kind: math.log(v) for kind, v in values.items() if v > 0.0 and math.isfinite(v)}
    if 'before' in logs and 'after' in logs:
        a, b = sorted(strip_position(logs[kind], *ends) for kind in ('before', 'after'))
        parts.append(f'<i class="way" style="left:{a:.1f}%;width:{b - a:.1f}%"></i>')
    parts += [
        f'<i class="dot {kind}" style="left:{strip_position(value, *ends):.1f}%"></i>'
        for kind, value in logs.items()
    ]
    return _render_strip(parts)


def render_interval(before: float, value: float, ci95: tuple[float, float]) -> str:
    """Return a value with its interval, and the value before."""
    finite = [part for part in (before, value, *ci95) if math.isfinite(part)]
    low, high = min(finite, default=0.0), max(finite, default=1.0)
    a, b = (strip_position(part, low, high) for part in ci95)
    parts = [
        f'<i class="span" style="left:{a:.1f}%;width:{max(b - a, 0.8):.1f}%"></i>'
        if all(map(math.isfinite, ci95)) else '',
        *(f'<i class="dot {kind}" style="left:{strip_position(part, low, high):.1f}%"></i>'
          for kind, part in (('before', before), ('after', value)) if math.isfinite(part)),
    ]  # fmt: skip
    return _render_strip(parts)


def render_stacked_bar(first: float, second: float, line: float, most: float) -> str:
    """
    Return two stacked amounts and a threshold line, on a square-root scale.

    The root keeps the threshold visible next to much larger values. A negative amount is
    subtracted from the other.
    """

    def clipped_position(value: float) -> float:
        share = math.sqrt(max(value, 0.0) / most) if most > 0.0 else 0.0
        return 100.0 * min(share, 1.0)

    begin = clipped_position(min(first, first + second))
    more = max(clipped_position(first + second) - begin, 0.0)
    return _render_strip(
        [
            f'<i class="bar one" style="left:0;width:{begin:.1f}%"></i>',
            f'<i class="bar two" style="left:{begin:.1f}%;width:{more:.1f}%"></i>',
            f'<i class="line" style="left:{clipped_position(line):.1f}%"></i>',
        ]
    )


def render_bar(value: float, most: float) -> str:
    """Return a bar of one amount."""
    share = 100.0 * min(max(value / most, 0.0), 1.0) if most > 0.0 else 0.0
    return _render_strip([f'<i class="bar off" style="left:0;width:{share:.1f}%"></i>'])


def _render_strip(parts: Sequence[str]) -> str:
    """Return a strip, hidden from screen readers: adjacent cells show the same numbers."""
    return f'<div class="strip" aria-hidden="true">{"".join(parts)}</div>'
