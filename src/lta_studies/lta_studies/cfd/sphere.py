"""Build the report of the validation: the sphere in the tunnel compared with measurements."""

from collections.abc import Sequence
from dataclasses import asdict
from typing import Final

from lta_report.charts import ChartAxis, Curve, draw_curves
from lta_report.formatting import Tile
from lta_report.palette import ESTIMATE, FILL, GOOD, LAMP, RAW, SETPOINT, TRUTH
from lta_report.report import Picture, Report, TextSection
from lta_report.result_table import build_table, Column
from lta_windtunnel.openfoam.programs import find_openfoam_version
from lta_windtunnel.tunnel import MAX_LAMINAR_REYNOLDS
from lta_windtunnel.validation import (
    morrison_drag_coefficient,
    SCATTER,
    SCATTER_RANGE,
    SphereComparison,
)
import numpy as np
from plotly.graph_objects import Figure

SETTING_COLOURS: Final = (ESTIMATE, LAMP, GOOD, TRUTH, SETPOINT)


def draw_sphere_drag(results: Sequence[SphereComparison]) -> Figure:
    """Plot the drag coefficient of the sphere, compared with measurements."""
    band = {'fill': 'toself', 'fillcolor': FILL, 'hoverinfo': 'skip'}
    ends = [*SCATTER_RANGE, *SCATTER_RANGE[::-1]]
    heights = [SCATTER[0], SCATTER[0], SCATTER[1], SCATTER[1]]
    reynolds = np.geomspace(5e3, 3e5, 200).tolist()
    morrison = [morrison_drag_coefficient(each) for each in reynolds]
    curves = [
        Curve('Achenbach 1972', ends, heights, TRUTH, '', width=0.0, more=band),
        Curve('Morrison 2013', reynolds, morrison, RAW, width=2.0),
    ]
    for k, setting in enumerate(dict.fromkeys(each.setting for each in results)):
        those = [each for each in results if each.setting == setting]
        curves.append(
            Curve(
                setting, [each.reynolds for each in those], [each.coefficient for each in those],
                SETTING_COLOURS[k % len(SETTING_COLOURS)], mode='lines+markers', width=1.0,
                above=[each.error * each.coefficient for each in those],
            )
        )  # fmt: skip
    numbers = ChartAxis('Reynolds number', log=True, more={'exponentformat': 'power', 'dtick': 1})
    return draw_curves(curves, numbers, ChartAxis('drag coefficient', range=(0.2, 0.54)))


SPHERE_COLUMNS: Final[tuple[Column[SphereComparison], ...]] = (
    Column('setting', 'setting'),
    Column('', 'Re', of=lambda each: f'{each.reynolds:.2g}'),
    Column('coefficient', 'Cd', digits=3),
    Column('error', 'error', '%', 1),
    Column('measured', 'Morrison', digits=3),
    Column('', 'from Morrison [%]',
           of=lambda each: f'{100 * (each.coefficient / each.measured - 1.0):+.0f}'),
    Column('', 'from scatter [%]', of=lambda each: f'{100 * each.off:+.0f}'),
    Column('seconds', 'CPU s', digits=0),
)  # fmt: skip
SPHERE_NOTE: Final = (
    'Error: standard error of the mean of a transient flow, or standard deviation of a '
    'steady flow over its averaging window. From scatter: deviation from the measured '
    "range, which reaches from Morrison's value to the 0.50 of Achenbach."
)


SPHERE_CAPTION: Final = (
    'Line: correlation of Morrison (2013). Band: 0.45 to 0.50, measured by Achenbach (1972) '
    'at Reynolds numbers from 5e4 to 1.2e5. Points: simulated in this wind tunnel.'
)
SPHERE_METHOD: Final = (
    'The steady model makes the boundary layer turbulent too early and sheds no vortices. '
    'Its drag is correct at 0.2 m/s and too low at 2 m/s, even more so on finer meshes. Use '
    'it to compare designs.',
    'The settings of the transient model were chosen because they match this sphere: no '
    f'turbulence model up to a Reynolds number of {MAX_LAMINAR_REYNOLDS:,.0f}, one above it. So '
    'the sphere is not an independent test of them.',
)


def build_report(results: Sequence[SphereComparison], count: int) -> Report:
    """Return the report of the validation; `count` results were planned."""
    return Report(
        command='cfd validate',
        subject='sphere',
        headline=format_headline(results, count),
        introduction=(
            'Drag of a sphere of 1 m in the simulated wind tunnel, compared with measurements.'
        ),
        tiles=build_tiles(results),
        blocks=(
            Picture('sphere', 'Drag coefficient', SPHERE_CAPTION, draw_sphere_drag(results)),
            build_table('Sphere', SPHERE_COLUMNS, results, SPHERE_NOTE),
            TextSection('Meaning and method', SPHERE_METHOD),
        ),
        data=[asdict(each) for each in results],
        facts={'engine': find_openfoam_version()},
        json_name='sphere.json',
    )


def format_headline(results: Sequence[SphereComparison], count: int) -> str:
    """Return the headline."""
    parts = []
    for setting in dict.fromkeys(each.setting for each in results):
        worst = max(
            (each for each in results if each.setting == setting), key=lambda e: abs(e.off)
        )
        parts.append(f'{setting} {100 * worst.off:+.0f} % at Re {worst.reynolds:.2g}')
    if failed := count - len(results):
        parts.append(f'{failed} of {count} results failed')
    return (
        f'Largest deviation of the drag of a sphere from the measured range: {"; ".join(parts)}.'
    )


def build_tiles(results: Sequence[SphereComparison]) -> list[Tile]:
    """Return tiles of some points."""
    return [
        Tile(
            f'{each.setting}, {each.speed:g} m/s', f'{each.coefficient:.3f}', '',
            f'measured {each.measured:.2f}',
        )
        for each in results
        # m/s: slowest, middle and fastest of the sweep
        if each.speed in (0.2, 1.0, 2.0)
    ]  # fmt: skip
