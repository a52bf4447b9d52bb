# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
The colours of pages, each with its counterpart in the dark theme.

Figures are drawn in light colours, and the page replaces each by its dark counterpart. So no light
colour may have two meanings. The hues follow Okabe and Ito's colour-blind-safe set.
"""

from typing import Final

PAPER: Final = '#ffffff'
INK: Final = '#1b2330'
SOFT: Final = '#5d6878'
GRID: Final = '#e6eaf0'
WALL: Final = '#8c96a5'
TRUTH: Final = '#0b62a8'
ESTIMATE: Final = '#c8500a'
SETPOINT: Final = '#3d4757'
RAW: Final = '#a9b3c1'
LAMP: Final = '#8a6100'
GOOD: Final = '#0f7b5f'
# Translucent: a cover for inactive parts, an area under a curve, the light of a lamp
VEIL: Final = 'rgba(255,255,255,0.62)'
FILL: Final = 'rgba(11,98,168,0.16)'
GLOW: Final = ('rgba(255,190,20,0.00)', 'rgba(255,190,20,0.38)')
# Scales: time along a path, signal strength, heat maps
TIME: Final = ('#41217a', '#2b5f9e', '#1f8f8a', '#58a846', '#c79a00')
STRENGTH: Final = ('#d9a3b0', '#c9667f', '#a5304f', '#6d0d2c')
HEAT: Final = ('#f6f7fa', '#d5e0ef', '#8fb4da', '#3b7fbf', '#0d4c8c', '#062a55')

DARK: Final[dict[str, str]] = {
    # Keys are the light colours
    PAPER: '#151b24',
    INK: '#e8ecf2',
    SOFT: '#9aa5b5',
    GRID: '#27303d',
    WALL: '#667285',
    TRUTH: '#62b5f5',
    ESTIMATE: '#ff9a55',
    SETPOINT: '#c3ccd8',
    RAW: '#566274',
    LAMP: '#f5c542',
    GOOD: '#4fd1a5',
    VEIL: 'rgba(21,27,36,0.55)',
    FILL: 'rgba(98,181,245,0.22)',
    GLOW[0]: 'rgba(255,205,90,0.00)',
    GLOW[1]: 'rgba(255,205,90,0.34)',
    **dict(zip(TIME, ('#a68bf0', '#6f9df2', '#45c2d6', '#7fdc8a', '#ffe066'), strict=True)),
    **dict(zip(STRENGTH, ('#6b4552', '#a85a73', '#e4819f', '#ffc9d6'), strict=True)),
    **dict(
        zip(
            HEAT,
            ('#18202b', '#1d3350', '#24558a', '#3d8bd0', '#8fc6f5', '#e6f4ff'),
            strict=True,
        )
    ),
}


def build_color_scale(colours: tuple[str, ...]) -> list[tuple[float, str]]:
    """Return a plotly colour scale of evenly spaced colours."""
    return [(k / (len(colours) - 1), colour) for k, colour in enumerate(colours)]
