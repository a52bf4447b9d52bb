"""
Score names by forecasts on smooth flights: `python test/score/transfer.py --cases 20`.

Each case is one of `lta challenge make --row pose`, with more flights: a GT-MAB that is off from
its file by the tolerances of vehicles, poses alone, filtered both ways until no noise is left, as
published ones are. Hidden is nothing, or one effect (`--kind single`). Every case is forced
through naming by forecasts, as if the readings had said that something is missing. On clean
flights any name is false. `--free` lifts the limit of what tolerances may explain
(`forecast_identification.LOOSE`), to see what it prevents.
"""

import argparse
from collections.abc import Iterator
import sys
import time

from lta_challenge.case import CaseGenerator
from lta_challenge.make import load_challenge_vehicle
from lta_challenge.rows import Kind, parse_case_kind
from lta_discovery.finding import StudyResult
from lta_discovery.flights.measured_flight import FlightStreams, resample_flight, Stream
from lta_discovery.flights.tracker_outliers import find_tracker_outliers
from lta_discovery.study import DiscoveryStudy, prepare_flight, StudyFlight
from lta_discovery.transfer import forecast_identification
from lta_discovery.unmodeled.unexplained_force import Remainder
from lta_flight.sweep.statistics import wilson_interval
import numpy as np
from numpy.typing import NDArray
from rich.progress import track
from scipy.signal import butter, filtfilt

Array = NDArray[np.float64]

SECONDS = (60.0, 90.0)
ROLES = ('train', 'confirm', 'holdout', *('train', 'confirm') * 4)
CUT = 0.03  # of half the rate of the tracker: 1.5 Hz
LEFT = (Remainder('surge', 0.02, 30.0, (), 0.0),)  # floors enough to ask forecasts


def smoothed(time: Array, poses: Array) -> Stream:
    """Return poses without those that the tracker mistook, filtered both ways."""
    good = ~find_tracker_outliers(poses)
    values = poses[good]
    turned = np.where(np.sum(values[1:, 3:] * values[:-1, 3:], axis=1) < 0.0, -1.0, 1.0)
    values[1:, 3:] *= np.cumprod(turned)[:, None]
    values = filtfilt(*butter(2, CUT), values, axis=0)
    values[:, 3:] /= np.linalg.norm(values[:, 3:], axis=1, keepdims=True)
    return Stream(time[good], values)


def case(seed: int, hidden: Kind) -> tuple[list[str], DiscoveryStudy]:
    """Return what is hidden, and a study as if readings had left something without a name."""
    about, flown = load_challenge_vehicle(), []
    drawn = CaseGenerator(about, seed, 0, 'pose', hidden, SECONDS).generate_case(ROLES)
    for flight in drawn.flights:
        pose = smoothed(*flight.streams['ground_truth/odom'])
        made = resample_flight(FlightStreams(pose, Stream(*flight.streams['motors'])))
        flown.append(
            StudyFlight(flight.name, flight.role, prepare_flight(about.vehicle, made, about.knobs))
        )
    finding = StudyResult('unexplained', (), (), (), (), True, LEFT, (), seed, {}, 'gtmab')
    names = [f'{one["knob"]} {one["value"]:.3g}' for one in drawn.answer['hidden']]
    return names, DiscoveryStudy(finding, about.nominal, about.nominal, flown, [])


def lines(seeds: range, hidden: Kind) -> Iterator[str]:
    """Yield a line for each case, then the count."""
    named = 0
    for seed in track(seeds, 'judging', disable=not sys.stderr.isatty()):
        began = time.process_time()
        truth, study = case(seed, hidden)
        found = forecast_identification.add_forecast_effects(
            study, lambda what, share: None
        ).finding
        names = [one.name for one in found.effects]
        named += bool(names)
        seconds = time.process_time() - began
        hid = f'hidden {", ".join(truth)}; ' if truth else ''
        said = f'named {names or "nothing"}; {seconds:.0f} s; {" ".join(found.warnings)}'
        yield f'{seed} {hid}{said}'
    share = wilson_interval(named, len(seeds))
    yield f'named {named}/{len(seeds)}, {100 * share.low:.0f}..{100 * share.high:.0f} %'


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description='Score names by forecasts.')
    parser.add_argument('--cases', type=int, default=20)
    parser.add_argument('--first', type=int, default=3101, help='seed of the first one')
    parser.add_argument('--kind', default='clean', help='clean or single')
    parser.add_argument('--free', action='store_true', help='without the limit of tolerances')
    asked = parser.parse_args()
    if asked.free:
        forecast_identification.LOOSE = 0.0  # type: ignore[misc]
    for line in lines(range(asked.first, asked.first + asked.cases), parse_case_kind(asked.kind)):
        sys.stdout.write(line + '\n')
        sys.stdout.flush()


if __name__ == '__main__':
    main()
