"""Results that the seed paper prints of its flights."""

from typing import Final, NamedTuple


class PaperFlight(NamedTuple):
    """An indoor flight of the paper: path [m] and time [s]; None if not printed."""

    path: float
    time: float | None


INDOORS: Final[dict[str, PaperFlight]] = {
    'bag': PaperFlight(7.3, 8.4),
    'dga': PaperFlight(8.6, 21.4),
    'des': PaperFlight(12.2, None),
}
ORDER: Final = ('bag', 'dga', 'des')  # from the shortest path to the longest
# Strategies that reached the lamp, by reference wind [m/s].
OUTDOORS: Final[dict[float, tuple[str, ...]]] = {8.0: ('bag',), 14.0: ()}
CAUTIONS: Final = (
    'The paper prints one flight per strategy, without a spread. Its 7.3 m in 8.4 s are '
    '0.87 m/s, although it states a speed of 0.5 m/s. It does not print the time of DES.',
    'The paper does not state the initial heading of its flights, nor where and over which '
    'ground it measured the wind. Every result here states both.',
)
