"""
Measure discovery: one flight fitted and every candidate looked at, by length of the flight.

In CPU time of one core. The peer is the plain way to find a missing term: regress what the
accelerations leave over on the same candidates, one more at a time while BIC gets better. It is
faster, and names the wrong thing: here as well the figure says how long, not how well.
"""

from functools import cache, partial
from pathlib import Path
import sys
import time
import tracemalloc

from bench import Figure

sys.path.append(str(Path(__file__).resolve().parents[1] / 'unit'))

from discovery.hidden_flight import flown, nominal, prepared
from lta_discovery.fit.evidence import build_prior
from lta_discovery.fit.joint_fit import fit_flight
from lta_discovery.flights.measured_flight import FlightStreams, PERIOD, Stream
from lta_discovery.replay.flight_linearizer import FlightLinearizer
from lta_discovery.replay.linearized_flight import unchanged_vehicle_point
from lta_discovery.selection.candidate_scan import scan_candidates
import numpy as np
from scipy.signal import savgol_filter

LENGTHS = (60, 120, 180, 360)  # s
SMOOTH = 15  # grid periods; 0.6 s


def cut(stream: Stream, until: float) -> Stream:
    """Return the beginning of a stream."""
    early = stream.time <= until
    return Stream(stream.time[early], stream.values[early])


@cache
def whole() -> FlightStreams:
    """Return one long flight in which nothing is hidden."""
    return flown({}, 1, max(LENGTHS) + 2.0)


@cache
def flight(length: int) -> FlightLinearizer:
    """Return its beginning, ready."""
    told = whole()
    others = {name: cut(stream, length) for name, stream in told.others.items()}
    commands = cut(told.commands, length)
    return prepared(
        FlightStreams(cut(told.pose, length), commands, others, told.floor), nominal()[1]
    )


def look(length: int) -> None:
    """Fit a flight, then look at every candidate."""
    vehicle, knobs = nominal()
    one, prior = flight(length), build_prior(knobs)
    fitted = fit_flight(
        one, vehicle, prior, unchanged_vehicle_point(vehicle, knobs, one.replay.cut)
    )
    seen = scan_candidates(fitted.reduced, fitted.linear.point.values, prior, knobs)
    if len(seen) < 20:
        raise RuntimeError(f'only {len(seen)} candidates were looked at')


def taken(work: object, length: int) -> float:
    """Return the CPU time of some work. [s]"""
    flight(length)
    begin = time.process_time()
    work(length)
    return time.process_time() - begin


def peak(length: int) -> float:
    """Return the greatest memory that a linearisation takes. [MB]"""
    one, (vehicle, knobs) = flight(length), nominal()
    point = unchanged_vehicle_point(vehicle, knobs, one.replay.cut)
    tracemalloc.start()
    one.linearize(point)
    most = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    return most / 1e6


def regress(length: int) -> None:
    """Choose terms for the accelerations that the nominal model leaves over, by BIC."""
    vehicle, knobs = nominal()
    one = flight(length)
    first = one.random
    columns, left = one.compute_whitened_columns(
        unchanged_vehicle_point(vehicle, knobs, one.replay.cut)
    )
    # Of the pose: seconds differences of position and turn, of what is left and of each column.
    known = np.isfinite(left[..., :6]).all(axis=(1, 2))
    rates = [
        savgol_filter(part, SMOOTH, 3, deriv=2, delta=PERIOD, axis=1)
        for part in (left[known][..., :6], columns[known][:, :, :6, first : first + len(knobs)])
    ]
    y, x = rates[0].ravel(), rates[1].reshape(-1, len(knobs))
    chosen: list[int] = []
    best = len(y) * np.log(y @ y / len(y))
    while len(chosen) < 8:
        scores = {}
        for k in set(range(len(knobs))) - set(chosen):
            table = x[:, [*chosen, k]]
            off = y - table @ np.linalg.lstsq(table, y, rcond=None)[0]
            scores[k] = len(y) * np.log(off @ off / len(y)) + (len(chosen) + 1) * np.log(len(y))
        new = min(scores, key=scores.__getitem__)
        if scores[new] >= best:
            break
        chosen.append(new)
        best = scores[new]


def figures() -> list[Figure]:
    """Return what is measured here."""
    rows = []
    for length in LENGTHS:
        name = f'discover.look_{length}'
        rows.append(Figure(name, 's', partial(taken, look, length), rounds=3, choose=min))
    rows.append(
        Figure(
            'discover.regress_180', 's', partial(taken, regress, 180), rounds=3, choose=min,
            of='discover.look_180', peer='equation error + BIC',
        )
    )  # fmt: skip
    rows += [
        Figure(f'discover.memory_{length}', 'MB', partial(peak, length), rounds=1, choose=min)
        for length in LENGTHS
    ]
    return rows
