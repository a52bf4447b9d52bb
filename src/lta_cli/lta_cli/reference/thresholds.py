"""Generate the page of discovery thresholds from the constants in the source."""

from collections.abc import Iterator
from importlib import resources
import json
from pathlib import Path
import re
from typing import Final, final, NamedTuple

PACKAGE: Final = 'lta_discovery'
# Modules that contain decision thresholds, in order; the rest of the package is presentation.
PARTS: Final = {
    'flights': 'Selection of sensor readings',
    'calibration': 'Calibration before the search',
    'model': 'Model parameters that can be fitted',
    'replay': 'Resolution of the flight replay',
    'fit': 'Fitting',
    'selection': 'Selection of effects',
    'unmodeled': 'Unexplained forces',
    'laws': 'Laws for unexplained forces',
    'forecast': 'Forecasts',
    'transfer': 'Selection of effects by forecasts, on real flights',
    'conclusion': 'The conclusion',
    'study': 'The whole study',
}
# A line `NAME: Final = number  # comment`; the number may be a power or degrees in radians
DECLARED: Final = re.compile(
    r'^(?P<name>[A-Z][A-Z_]*): Final = '
    r'(?P<value>-?[\d.]+(?:e-?\d+)?(?:\*\*-?[\d.]+| \* math\.pi / 180\.0)?)'
    r'(?:  # (?P<beside>.*))?$'
)
# Array sizes (of a state, a wrench or a column) are not thresholds.
SHAPES: Final = ('AXES', 'POSE', 'RIGID', 'WIDTH')
KEPT: Final = 'discovery_sensitivity.json'
TABLE: Final = """| constant | value | unit and meaning | if doubled | if halved |
|---|---|---|---|---|
"""
HEAD: Final = """# Thresholds of discovery

Generated from the constants in `src/lta_discovery` by `make reference`.

Each decision threshold is declared once, in the module that uses it. The last two columns show
which cases of `make sensitivity` change when it is doubled or halved. A dash means not measured.
"""


@final
class Threshold(NamedTuple):
    """A threshold constant."""

    # Module below the package and constant: 'selection.candidate_acceptance', 'GAIN'
    module: str
    name: str
    value: str  # source text of the value
    about: str  # its comment: unit and purpose

    @property
    def key(self) -> str:
        """Key of the constant in the sensitivity file."""
        return f'{self.module}.{self.name}'


def list_thresholds() -> Iterator[Threshold]:
    """Yield the thresholds of all parts, in the order of the page."""
    for part in PARTS:
        for source in read_sources(part):
            yield from parse_thresholds(*source)


def read_sources(part: str) -> Iterator[tuple[str, str]]:
    """Yield name and source text of each module of a part (a module or a package)."""
    folder = resources.files(PACKAGE)
    if not (folder / part).is_dir():
        yield part, (folder / f'{part}.py').read_text(encoding='utf-8')
        return
    for each in sorted((folder / part).iterdir(), key=lambda one: one.name):
        if each.name.endswith('.py'):
            yield f'{part}.{each.name.removesuffix(".py")}', each.read_text(encoding='utf-8')


def parse_thresholds(module: str, text: str) -> Iterator[Threshold]:
    """Yield the constants of a module, each with the comment after or above it."""
    above: list[str] = []
    for line in text.splitlines():
        match = DECLARED.match(line)
        if match is not None and match['name'] not in SHAPES:
            about = match['beside'] or ' '.join(above)
            yield Threshold(module, match['name'], match['value'], about)
        # Comment lines directly above a constant; any other line ends them
        above = [*above, line.removeprefix('# ')] if line.startswith('# ') else []


def render_page() -> str:
    """Return the page: a section for each part."""
    measured = load_sensitivity()
    out = [HEAD]
    for part, title in PARTS.items():
        rows = [
            format_threshold_row(each, measured)
            for source in read_sources(part)
            for each in parse_thresholds(*source)
        ]
        if rows:
            out.append(f'\n## {title}\n\n{TABLE}{"".join(rows)}')
    return ''.join(out)


def format_threshold_row(one: Threshold, measured: dict[str, dict[str, str]]) -> str:
    """Return the row of one threshold."""
    moved = measured.get(one.key, {})
    cells = (f'`{one.key}`', one.value, one.about, moved.get('2', '-'), moved.get('0.5', '-'))
    return f'| {" | ".join(cells)} |\n'


def load_sensitivity() -> dict[str, dict[str, str]]:
    """Return the measured sensitivity of each threshold, by factor; empty if there is no file."""
    path = Path('docs') / KEPT
    # The file is missing outside a source tree
    if not path.exists():
        return {}
    table: dict[str, dict[str, str]] = json.loads(path.read_text(encoding='utf-8'))
    return table
