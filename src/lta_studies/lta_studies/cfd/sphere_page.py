"""The page of the validation: the tunnel's sphere beside real ones."""

from collections.abc import Mapping, Sequence
from html import escape
from pathlib import Path
from typing import Final

from lta_bridge.provenance import commit
from lta_report.formatting import Tile
from lta_report.frame import framed, written
from lta_report.pieces import section, tile_html
from lta_sim.cfd.openfoam.engine import version
from lta_sim.cfd.tunnel import MODELLED
from lta_sim.cfd.validation import Judged
from lta_studies.cfd.pictures import sphere_picture
from lta_studies.cfd.tables import spheres
from lta_studies.energy.tables import table_html

CAPTION: Final = (
    'Line: Morrison 2013. Band: 0.45 to 0.50, measured by Achenbach 1972 between 5e4 and 1.2e5. '
    'Points: this tunnel.'
)
METHOD: Final = (
    'The steady model makes the boundary layer turbulent too early and sheds no wake: it is right '
    'at 0.2 m/s and low at 2 m/s, the more the finer the mesh. It is for comparing designs.',
    'The transient setting was chosen because it met a sphere: up to a Reynolds number of '
    f'{MODELLED:,.0f} without a model of eddies, beyond with one. It is no independent test of '
    'it.',
)


def write_page(found: Sequence[Judged], commands: Mapping[str, str], out: Path) -> Path:
    """Write the page and return where it is; `BadInput` where it cannot be written."""
    return written(page(found, commands), out)


def page(found: Sequence[Judged], commands: Mapping[str, str]) -> str:
    """Return the whole page."""
    return framed(
        'energy.html',
        title=escape(title(found)),
        kicker='cfd validate · sphere',
        about='A sphere of 1 m in the wind tunnel, beside what was measured of real ones.',
        tiles='\n'.join(tile_html(*each) for each in tiles(found)),
        first=section('sphere', 'Drag coefficient', CAPTION, sphere_picture(found)),
        pictures='',
        tables=table_html(spheres(list(found))),
        method=''.join(f'<p class="note">{escape(each)}</p>' for each in METHOD),
        facts={'engine': version(), 'commit': commit()},
        commands=commands,
    )


def title(found: Sequence[Judged]) -> str:
    """Return what came out, in a sentence."""
    parts = []
    for setting in dict.fromkeys(each.setting for each in found):
        worst = max((each for each in found if each.setting == setting), key=lambda e: abs(e.off))
        parts.append(f'{setting}: at worst {100 * worst.off:+.0f} % at Re {worst.reynolds:.2g}')
    return f'Sphere beside the measured scatter: {"; ".join(parts)}.'


def tiles(found: Sequence[Judged]) -> list[Tile]:
    """Return each point."""
    return [
        Tile(
            f'{each.setting}, {each.speed:g} m/s', f'{each.coefficient:.3f}', '',
            f'measured {each.measured:.2f}',
        )
        for each in found
        if each.speed in (0.2, 1.0, 2.0)
    ]  # fmt: skip
