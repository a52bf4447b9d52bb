"""What is known of the energy after a reading."""

import math
from typing import NamedTuple

from lta_energy.faults.watch import Watch
from lta_energy.monitoring.belief import Belief, Surprise
from lta_energy.monitoring.books import Books
from lta_energy.monitoring.latch import Latch
from lta_energy.monitoring.load import Load
from lta_energy.monitoring.reading import Reading
from lta_energy.monitoring.reserve import Stock
from lta_energy.monitoring.way_home import Travel


class Estimate(NamedTuple):
    """
    What is known after a reading.

    Attributes
    ----------
    belief : Belief or None
        Of the cell; None before the first usable reading.
    load : Load
        Power that leaves the cell's chemistry, losses included.
    travel : Travel or None
        What flying takes.
    stock : Stock or None
        The charge against reserve and way home.
    low : bool
        Whether the reserve is reached by the charge, with hysteresis.
    reserve : bool
        Whether it counts as reached: by the charge, or because the energy is doubtful.
    critical : Latch
        Whether the voltage is so low that nothing but landing is left.
    watch : Watch
        What the detectors of bad readings know.
    surprise : Surprise or None
        How far the newest voltage was off what was expected.
    gap : float
        Time since the reading before. [s]
    last : Reading or None
        The newest reading.
    good : Reading or None
        The newest one that no detector spoilt.
    books : Books
        Energy since the first good reading.
    behind : tuple of int
        Stamps of readings after `last` that lie before it and came in order. [ns]

    """

    belief: Belief | None = None
    load: Load = Load()
    travel: Travel | None = None
    stock: Stock | None = None
    low: bool = False
    reserve: bool = True
    critical: Latch = Latch()
    watch: Watch = Watch()
    surprise: Surprise | None = None
    gap: float = 0.0
    last: Reading | None = None
    good: Reading | None = None
    books: Books = Books()
    behind: tuple[int, ...] = ()

    @property
    def charge(self) -> float:
        """State of charge, NaN before the first usable reading. [1]"""
        return math.nan if self.belief is None else self.belief.charge

    @property
    def deviation(self) -> float:
        """Standard deviation of the state of charge. [1]"""
        return math.nan if self.belief is None else self.belief.deviation

    @property
    def urgent(self) -> bool:
        """Whether to come down at once: a cell that gives way, or readings that mean nothing."""
        return self.belief is None or self.critical.on or self.watch.doubtful
