"""Build the report of the validation: the sphere in the tunnel compared with measurements."""

from collections.abc import Sequence
from dataclasses import asdict
from typing import Final

from lta_report.formatting import Tile
from lta_report.report import Picture, Report, TextSection
from lta_studies.cfd.pictures import draw_sphere_drag
from lta_studies.cfd.tables import build_sphere_table
from lta_windtunnel.openfoam.programs import find_openfoam_version
from lta_windtunnel.tunnel import MAX_LAMINAR_REYNOLDS
from lta_windtunnel.validation import SphereComparison

CAPTION: Final = (
    'Line: correlation of Morrison (2013). Band: 0.45 to 0.50, measured by Achenbach (1972) '
    'at Reynolds numbers from 5e4 to 1.2e5. Points: simulated in this wind tunnel.'
)
METHOD: Final = (
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
            Picture('sphere', 'Drag coefficient', CAPTION, draw_sphere_drag(results)),
            build_sphere_table(results),
            TextSection('Meaning and method', METHOD),
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
