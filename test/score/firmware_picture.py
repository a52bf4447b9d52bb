"""A picture of what motors did in each script: time to the right, a bar for each build."""

from collections.abc import Iterator, Mapping, Sequence
from html import escape
from typing import Any, Final

from firmware_scenarios import BUILDS, SCENARIOS
from lta_bridge.crazyflie.supervisor_word import SupervisorBit

COLOURS: Final = {'still': '#c9d1d9', 'idle': '#e69f00', 'turn': '#0072b2'}
LEGEND: Final = {'turn': 'motors turn', 'idle': 'motors run idle', 'still': 'motors stopped'}
LOCKED: Final = '#d55e00'
LEFT, RIGHT, TOP = 330, 20, 46  # px
SECOND, BAR, GAP = 62, 9, 9  # px
LONGEST: Final = 12.0  # s
WIDTH: Final = LEFT + round(SECOND * LONGEST) + RIGHT


def text(x: float, y: float, words: str, anchor: str = 'start') -> str:
    """Return a text element."""
    return f'<text x="{x:.0f}" y="{y:.0f}" text-anchor="{anchor}">{escape(words)}</text>'


def bar(y: float, begin: float, end: float, colour: str) -> str:
    """Return a bar from one time to another. [s]"""
    return (
        f'<rect x="{LEFT + SECOND * begin:.1f}" y="{y:.0f}" '
        f'width="{SECOND * (end - begin):.1f}" height="{BAR}" fill="{colour}"/>'
    )


def build_row(y: float, changes: Sequence[Sequence[Any]], seconds: float) -> Iterator[str]:
    """Yield the bars of one build in one script, and a mark where it locked."""
    ends = [*(change[0] for change in changes[1:]), seconds]
    for (begin, word, motors), end in zip(changes, ends, strict=True):
        yield bar(y, begin, end, COLOURS[motors])
        if word & SupervisorBit.LOCKED:
            yield bar(y, begin, begin + 0.05, LOCKED)


def legend() -> Iterator[str]:
    """Yield what the colours and the three bars mean."""
    entries = [*((COLOURS[name], words) for name, words in LEGEND.items()), (LOCKED, 'locked')]
    for place, (colour, words) in enumerate(entries):
        x = LEFT + 150 * place
        yield f'<rect x="{x}" y="10" width="12" height="12" fill="{colour}"/>'
        yield text(x + 18, 20, words)
    yield text(10, 20, 'bars: as sold, arming required, our app')


def axis(height: float) -> Iterator[str]:
    """Yield the lines of the seconds."""
    for second in range(0, round(LONGEST) + 1, 2):
        x = LEFT + SECOND * second
        yield f'<line x1="{x}" x2="{x}" y1="{TOP - 8}" y2="{height - 20}" stroke="#8b949e44"/>'
        yield text(x, height - 6, f'{second} s', 'middle')


def draw(builds: Mapping[str, Any]) -> str:
    """Return the picture of a record as SVG."""
    lines, y = [], float(TOP)
    for name, scenario in SCENARIOS.items():
        played = [each for each in BUILDS if each in scenario.builds]
        lines.append(text(10, y + BAR * len(played) / 2 + 5, scenario.about))
        for each in played:
            lines += build_row(y, builds[each]['scenarios'][name], scenario.seconds)
            y += BAR + 1
        y += GAP
    height = y + 24
    return '\n'.join([
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height:.0f}" '
        'font-family="sans-serif" font-size="13" fill="#57606a">',
        f'<rect width="{WIDTH}" height="{height:.0f}" fill="#ffffff"/>',
        *legend(),
        *axis(height),
        *lines,
        '</svg>\n',
    ])  # fmt: skip
