"""Draw what a discovery is worth: the headline, and the error of each model as a bar."""

from html import escape
import math
from textwrap import wrap
from typing import Final

from lta_discovery.calibration.verdict import format_error
from lta_discovery.discovery.conclusion import Conclusion
from lta_discovery.discovery.forecast_comparison import ForecastComparison
from lta_discovery.error_picture import COLOURS

NAME: Final = 'picture.svg'
WIDTH: Final = 760  # px
LEFT: Final = 190  # px; where bars begin
LONGEST_BAR: Final = 460  # px
ROW: Final = 34  # px
LINE: Final = 26  # px; of the headline
LONGEST_LINE: Final = 76  # characters
TOP: Final = 66  # px; of the first bar, below the headline
SHORTEST_BAR: Final = 6  # px
# Readable on light and dark pages alike
STYLE: Final = (
    'text{font-family:system-ui,sans-serif;fill:#57606e}'
    '.head{font-size:19px;font-weight:600;fill:#c8500a}.note{font-size:13px}.bar{font-size:15px}'
)


def draw_picture(conclusion: Conclusion, comparison: ForecastComparison) -> str:
    """
    Return the picture; '' where no flight is long enough for a forecast.

    The length of a bar goes with the logarithm of the position error.
    """
    scores = comparison.scores
    if not scores:
        return ''
    far = scores[-1]
    sizes = {name: one.position for name, one in far.errors.items() if math.isfinite(one.position)}
    least, most = 0.5 * min(sizes.values()), max(sizes.values())
    span = max(math.log(most / least), 1e-9)
    head = wrap(conclusion.headline, LONGEST_LINE)
    top = TOP + LINE * len(head)
    rows = [
        f'<text class="head" x="20" y="{36 + LINE * k}">{escape(line)}</text>'
        for k, line in enumerate(head)
    ]
    for k, (name, size) in enumerate(sorted(sizes.items(), key=lambda one: -one[1])):
        y, share = top + k * ROW, math.log(size / least) / span
        length = max(share * LONGEST_BAR, SHORTEST_BAR)
        rows.append(
            f'<text class="bar" x="{LEFT - 12}" y="{y + 16}" text-anchor="end">{escape(name)}'
            f'</text><rect x="{LEFT}" y="{y}" width="{length:.0f}" height="22" rx="4" '
            f'fill="{COLOURS[name]}"/><text class="bar" x="{LEFT + length + 8:.0f}" '
            f'y="{y + 16}">{format_error(size)}</text>'
        )
    height = top + len(sizes) * ROW + 10
    note = (
        f'Position error {far.horizon:g} s ahead, RMS of {far.forecasts} forecasts of '
        f'{", ".join(comparison.names)}; logarithmic.'
    )
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height}" role="img" '
        f'aria-label="{escape(conclusion.headline)}"><style>{STYLE}</style>'
        f'<text class="note" x="20" y="{top - 30}">{escape(note)}</text>{"".join(rows)}</svg>\n'
    )
