"""What the seed paper prints of its flights, and what it claims of their order."""

from typing import Final, NamedTuple


class PaperFlight(NamedTuple):
    """An indoor flight of the paper: path [m] and time [s]; None is not printed."""

    path: float
    time: float | None


INDOORS: Final[dict[str, PaperFlight]] = {
    'bag': PaperFlight(7.3, 8.4),
    'dga': PaperFlight(8.6, 21.4),
    'des': PaperFlight(12.2, None),
}
ORDER: Final = ('bag', 'dga', 'des')  # from the shortest path to the longest
# Reference wind [m/s]: who reached the lamp.
OUTDOORS: Final[dict[float, tuple[str, ...]]] = {8.0: ('bag',), 14.0: ()}
CAUTIONS: Final = (
    'The paper prints one flight of each strategy, without a spread: 7.3 m in 8.4 s is 0.87 m/s, '
    'though it flies at 0.5 m/s; the time of DES is not printed.',
    'It says neither from what heading its flights begin nor where and over what ground its wind '
    'was measured: both are named with every figure here.',
)
