"""Check the order of light blocks by their stamps, and count missing blocks."""

from lta_config.errors import BadInput

ANEW = 10  # blocks by which time goes back when it begins anew, as in a recording played again


class BlockSequence:
    """
    The blocks of one array in time order.

    `period_ns`: from the first sample of a block to that of the next [ns]. Attribute `missing`:
    number of missing blocks so far.
    """

    def __init__(self, period_ns: int) -> None:
        self._period = period_ns
        self._newest: int | None = None
        self.missing = 0

    def count_missing_blocks(self, stamp_ns: int) -> int:
        """
        Return how many blocks are missing before the one whose first sample has this stamp. [ns]

        Raise `BadInput` if it is older than the newest one, or overlaps with it by more than half.
        """
        before, period = self._newest, self._period
        # First block, or a recording that starts again
        if before is None or stamp_ns <= before - ANEW * period:
            self._newest = stamp_ns
            return 0
        gap = stamp_ns - before
        if 2 * gap < period:
            raise BadInput(
                f'A block of photodiode samples with the time stamp {stamp_ns * 1e-9:.3f} '
                f's follows one with {before * 1e-9:.3f} s, but each block lasts '
                f'{period * 1e-9:g} s; send each block once, in time order.'
            )
        self._newest = stamp_ns
        # Rounded to whole periods
        missing = (gap + period // 2) // period - 1
        self.missing += missing
        return missing
