# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""What `lta compare` takes: two bags, and how they are aligned and compared."""

from collections.abc import Sequence
from dataclasses import replace
from fnmatch import fnmatchcase
import math
from pathlib import Path
import re
from typing import Annotated, final

from lta_bag.bag_folder import find_bag
from lta_config.errors import BadInput
from lta_config.quantity import SI_UNITS
from lta_data.bag.recorded_flight import open_flight, RecordedFlight
from lta_data.compare.channel_comparison import ChannelComparison
from lta_data.compare.comparison import compare_flights, ComparisonRequest, count_ticks
from lta_data.compare.frame_alignment import Frames
from lta_data.compare.time_alignment import Align
from lta_report.progress_bar import ProgressBar
from lta_report.report import Report
from lta_report.request import argument, option, ReportRequest, StudyRun
from pydantic import BeforeValidator
from rich.progress import BarColumn, TextColumn, TimeRemainingColumn

# Group 1: number, group 2: optional unit
QUANTITY = re.compile(r'\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(\S.*?)?\s*')


def parse_quantity(text: str, unit: str | None = None) -> float:
    """Return a number with an optional unit in SI units; raise `ValueError` for other text."""
    match = QUANTITY.fullmatch(text)
    own = match and match[2]
    # SI unit and factor of the given unit
    kind, factor = SI_UNITS.get(own or '', (unit, 1.0))
    if match is None or (own and own not in SI_UNITS) or (unit and kind != unit):
        unit_names = ', '.join(
            sorted(name for name, (si, _) in SI_UNITS.items() if unit in (None, si))
        )
        raise ValueError(f"is '{text}'; give a number with an optional unit ({unit_names})")
    value = float(match[1]) * factor
    # A number such as 1e999 overflows to infinity
    if not math.isfinite(value):
        raise ValueError(f"is '{text}'; give a finite number")
    return value


def _parse_offset(value: object) -> object:
    """Return a time in s, also of a text with a unit."""
    return parse_quantity(value, 's') if isinstance(value, str) else value


Offset = Annotated[float, BeforeValidator(_parse_offset)]


@final
class FlightComparisonRequest(ReportRequest, command='compare'):
    """
    Compare two flights, simulated or measured: where, when and by how much they differ.

    Clocks and world frames are aligned, and the alignment is reported. Differences are B minus A,
    on A's clock. Two channels diverge where their difference stays outside the noise of both, or
    outside a tolerance.

    Exit status 0: compared. 1: the flights differ and --same was given. 2: bad input.

    Example: lta compare runs/one runs/two

    Example: lta compare BAG BAG --pair odom=ground_truth/odom
    """

    a: Path = argument('Bag folder, results folder or .mcap file.')
    b: Path = argument(
        'Bag to compare with; the same bag as A to compare two robots or topics in it.'
    )
    pair: tuple[str, ...] = option(
        'Compare a topic or channel of bag A with one of bag B, such as odom=ground_truth/odom; '
        'repeat for further pairs. By default, topics with the same name are compared.',
        default=(),
    )
    topic: tuple[str, ...] = option(
        'Compare only this topic of bag A; repeat for several.', default=()
    )
    robot: str | None = option(
        'Robot to compare, or two as ROBOT_IN_A:ROBOT_IN_B; needed if a bag contains several '
        'robots.',
        default=None,
    )
    align: Align = option(
        'How to align time. clock: both bags recorded the same run. motion: two runs, aligned at '
        'the start of motion. none: use the time stamps unchanged. auto: choose from the data.',
        default='auto',
    )
    offset: Offset | None = option(
        "Time by which the clock of B is ahead of A's, such as 0.12s.", default=None
    )
    frames: Frames = option(
        'How to align the world frames of the bags. given: use them unchanged. fit: fit the path '
        'of B to the path of A. auto: choose from the data.',
        default='auto',
    )
    tolerance: tuple[str, ...] = option(
        'Tolerance of a channel, used instead of its measured noise: CHANNEL=VALUE, such as '
        '"odom/*position*=0.05 m" (* matches any text); repeatable.',
        default=(),
    )
    same: bool = option('Exit with status 1 if the flights differ.', default=False)

    def run(self, run: StudyRun) -> Report:
        """Return the report of both flights."""
        from lta_analysis.comparison.report import build_report

        tolerances = dict(map(parse_tolerance, self.tolerance))
        request = ComparisonRequest(
            self.pair, self.topic, self.align, self.offset, self.frames, tolerances
        )
        # 'A:B' names a robot for each bag; a single name is used for both
        robots = (self.robot or '').partition(':')
        one = open_comparison_flight(self.a, robots[0], 'A')
        other = open_comparison_flight(self.b, robots[2] or robots[0], 'B')
        columns = (TextColumn('{task.description}'), BarColumn(), TimeRemainingColumn())
        total = count_ticks(one, other, request)
        with ProgressBar(run.console, *columns, begin='opening', total=total) as bar:
            comparison = compare_flights(
                one, other, request, lambda step: bar.update_bar(description=step, advance=1)
            )
        # Units of channels are known only after the comparison
        check_units(self.tolerance, comparison.channels)
        differ = self.same and not (comparison.is_identical or comparison.is_within_bands)
        return replace(build_report(comparison), status=int(differ))


def open_comparison_flight(path: Path, robot: str, label: str) -> RecordedFlight:
    """Open a flight; an error about several robots names the side (A or B)."""
    try:
        return open_flight(find_bag(path), robot or None)
    except BadInput as error:
        # The user must choose a robot for this side
        if 'several robots' in str(error):
            raise BadInput(
                f'Bag {label}: {error} If the two bags have different robots, name both: '
                '--robot NAME_IN_A:NAME_IN_B.'
            ) from error
        raise


def parse_tolerance(text: str) -> tuple[str, float]:
    """Return channel and tolerance of a text such as 'odom/pose.pose.position.z=0.05 m'."""
    # From the right, since a channel name may contain '='
    name, equals, value = text.rpartition('=')
    if not equals or not name:
        raise BadInput(
            f"--tolerance '{text}' is not of the form CHANNEL=VALUE; write it like "
            'odom/pose.pose.position.z=0.05.'
        )
    try:
        band = parse_quantity(value)
    except ValueError as error:
        raise BadInput(f'The tolerance of {name} {error}.') from None
    if band < 0.0:
        raise BadInput(f'The tolerance of {name} is {band:g}; it must be 0 or more.')
    return name, band


def check_units(tolerances: Sequence[str], channels: Sequence[ChannelComparison]) -> None:
    """Raise `BadInput` if the unit of a tolerance fits none of its channels."""
    for name, _, value in (text.rpartition('=') for text in tolerances):
        match = QUANTITY.fullmatch(value)
        # A tolerance without a unit is in the channel's own unit
        if match is None or not match[2]:
            continue
        kind = SI_UNITS[match[2]][0]
        fitting = [each for each in channels if each.name == name or fnmatchcase(each.name, name)]
        units = [SI_UNITS.get(each.unit, (each.unit, 1.0))[0] for each in fitting]
        # Channels without a unit accept any
        if fitting and not {'', kind} & {*units}:
            raise BadInput(
                f"The tolerance of {name} is '{value}', but {fitting[0].name} is in {units[0]}; "
                f'give the tolerance in {units[0]}.'
            )
