"""
Write the results of `lta discover` on RGBlimp's flights into docs/discovery_flights.md.

`python test/score/rgblimp_verb.py FOLDER`; the folder has the discovery.json of that command.
"""

from collections.abc import Sequence
import json
import math
from pathlib import Path
import sys
from typing import Any, Final

PAGE: Final = Path(__file__).resolve().parents[2] / 'docs' / 'discovery_flights.md'
BEGIN, END = '<!-- verb: begin -->', '<!-- verb: end -->'
MODELS: Final = ('before', 'tuned', 'after', 'refitted', 'coast')
HORIZONS: Final = (2.0, 3.0, 5.0)  # s


def gaps(told: dict[str, Any]) -> list[str]:
    """Return errors of forecasts as Markdown."""
    out = [
        '| held out | horizon | before | tuned | named | everything refitted | coast |'
        ' named / before | refitted / before |',
        f'|{"---|" * 9}',
    ]
    for channel, unit, factor, digits in (
        ('position', 'm', 1.0, 3),
        ('attitude', 'deg', math.degrees(1.0), 1),
    ):
        for one in told['gaps']:
            if one['channel'] != channel or one['horizon_s'] not in HORIZONS:
                continue
            known = [one[model] or math.nan for model in MODELS]
            figures = ' | '.join(f'{factor * size:.{digits}f}' for size in known)
            ratios = ' | '.join(f'{known[k] / known[0]:.2f}' for k in (2, 3))
            ahead = f'{one["horizon_s"]:g} s'
            out.append(f'| {channel} [{unit}] | {ahead} | {figures} | {ratios} |')
    return out


def names(told: dict[str, Any]) -> list[str]:
    """Return the named effects as Markdown."""
    if not told['effects']:
        return ['No effect is named.']
    out = ['| effect | parameter | value | 95 % | unit |', '|---|---|---|---|---|']
    for effect in told['effects']:
        for name, one in effect['parameters'].items():
            low, high = one['ci95']
            out.append(
                f'| {effect["name"]} | {name} | {one["value"]:.3g} | {low:.2g} to {high:.2g} | '
                f'{one["unit"]} |'
            )
    return out


def regimes(told: dict[str, Any]) -> list[str]:
    """Return regimes left out as Markdown."""
    known = (told['carried'] or {'regimes': []})['regimes']
    out = ['| regime left out | flights | error ratio to the vehicle file |', '|---|---|---|']
    return out + [f'| {one["name"]} | {one["flights"]} | {one["ratio"]:.2f} |' for one in known]


def main(words: Sequence[str]) -> None:
    """Write the page."""
    if len(words) != 1:
        sys.exit('Name the folder that lta discover wrote.')
    told = json.loads((Path(words[0]) / 'discovery.json').read_text(encoding='utf-8'))
    text = [
        f'Verdict: `{told["verdict"]}`.',
        '',
        *names(told),
        '',
        *regimes(told),
        '',
        *gaps(told),
    ]
    page = PAGE.read_text(encoding='utf-8')
    head, _, rest = page.partition(BEGIN)
    _, _, tail = rest.partition(END)
    PAGE.write_text(f'{head}{BEGIN}\n{chr(10).join(text)}\n{END}{tail}', encoding='utf-8')


if __name__ == '__main__':
    main(sys.argv[1:])
