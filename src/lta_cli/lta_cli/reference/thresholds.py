"""The thresholds of discovery as a page, from the constants that declare them."""

from collections.abc import Iterator
from importlib import resources
import json
from pathlib import Path
import re
from typing import Final, final, NamedTuple

PACKAGE: Final = 'lta_discovery'
# What decides, by the part of the study that asks it; the rest of the package draws and writes.
PARTS: Final = {
    'flights': 'Which readings count',
    'model': 'What can be turned',
    'replay': 'How finely a flight is replayed',
    'fit': 'Fitting',
    'selection': 'Naming',
    'unmodeled': 'Unexplained forces',
    'forecast': 'Forecasts',
    'transfer': 'Names by forecasts, on real flights',
    'conclusion': 'The conclusion',
    'study': 'The whole study',
}
DECLARED: Final = re.compile(
    r'^(?P<name>[A-Z][A-Z_]*): Final = '
    r'(?P<value>-?[\d.]+(?:e-?\d+)?(?:\*\*-?[\d.]+| \* math\.pi / 180\.0)?)'
    r'(?:  # (?P<beside>.*))?$'
)
# How many numbers a state, a wrench or a column has is no threshold.
SHAPES: Final = ('AXES', 'POSE', 'RIGID', 'WIDTH')
KEPT: Final = 'discovery_sensitivity.json'
TABLE: Final = """| constant | value | what it is | doubled | halved |
|---|---|---|---|---|
"""
HEAD: Final = """# Thresholds of discovery

Generated from the constants in `src/lta_discovery` by `make reference`.

Each number that decides something is declared once, in the module that uses it. The last two
columns tell what happens when it is doubled or halved: which of the cases of `make sensitivity`
come out differently, or nothing. A dash has not been measured.
"""


@final
class Threshold(NamedTuple):
    """
    One constant.

    Attributes
    ----------
    module, name : str
        Where it is declared, below the package: 'selection.acceptance', 'GAIN'.
    value : str
        As the source has it.
    about : str
        Its comment: the unit, and what it guards against.

    """

    module: str
    name: str
    value: str
    about: str

    @property
    def key(self) -> str:
        """How a measurement of it is called."""
        return f'{self.module}.{self.name}'


def list_thresholds() -> Iterator[Threshold]:
    """Yield the thresholds of all parts, in the order of the page."""
    for part in PARTS:
        for source in read_sources(part):
            yield from parse_thresholds(*source)


def read_sources(part: str) -> Iterator[tuple[str, str]]:
    """Yield name and text of the modules of a part: it is one itself, or a package of some."""
    folder = resources.files(PACKAGE)
    if not (folder / part).is_dir():
        yield part, (folder / f'{part}.py').read_text(encoding='utf-8')
        return
    for each in sorted((folder / part).iterdir(), key=lambda one: one.name):
        if each.name.endswith('.py'):
            yield f'{part}.{each.name.removesuffix(".py")}', each.read_text(encoding='utf-8')


def parse_thresholds(module: str, text: str) -> Iterator[Threshold]:
    """Yield the numbers that a module declares, each with the comment beside or above it."""
    above: list[str] = []
    for line in text.splitlines():
        found = DECLARED.match(line)
        if found is not None and found['name'] not in SHAPES:
            about = found['beside'] or ' '.join(above)
            yield Threshold(module, found['name'], found['value'], about)
        above = [*above, line.removeprefix('# ')] if line.startswith('# ') else []


def render_page() -> str:
    """Return the page: a section for each part."""
    measured = load_sensitivity()
    out = [HEAD]
    for part, title in PARTS.items():
        rows = [
            format_row(each, measured)
            for source in read_sources(part)
            for each in parse_thresholds(*source)
        ]
        if rows:
            out.append(f'\n## {title}\n\n{TABLE}{"".join(rows)}')
    return ''.join(out)


def format_row(one: Threshold, measured: dict[str, dict[str, str]]) -> str:
    """Return the row of one threshold."""
    moved = measured.get(one.key, {})
    cells = (f'`{one.key}`', one.value, one.about, moved.get('2', '-'), moved.get('0.5', '-'))
    return f'| {" | ".join(cells)} |\n'


def load_sensitivity() -> dict[str, dict[str, str]]:
    """Return what was measured of each threshold, by factor; nothing where nobody measured."""
    path = Path('docs') / KEPT
    if not path.exists():
        return {}
    found: dict[str, dict[str, str]] = json.loads(path.read_text(encoding='utf-8'))
    return found
