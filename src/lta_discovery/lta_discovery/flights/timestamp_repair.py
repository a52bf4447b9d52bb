"""
Stamps that are rounded, or jitter, of a tracker or an IMU that reads at a regular rate.

A pose with a wrong stamp is wrong by the way the vehicle goes meanwhile. Stamps of 1 ms at 120 Hz
are wrong in a pattern of three, which on the grid of a study looks like an oscillation. Stamps
alone do not tell whether they or the instants of the readings are irregular. The readings do,
since a vehicle moves smoothly: where they follow a raster, it takes the place of the stamps.
Commands tell nothing of that kind, and slow sensors little: their stamps are left alone.
"""

from dataclasses import replace
from typing import Final

from lta_discovery.flights.measured_flight import FlightStreams, MeasuredFlight, Stream
from lta_discovery.flights.noise import HALF
from lta_discovery.flights.regular_times import (
    FEWEST,
    find_stamp_step,
    fit_regular_times,
    NEARLY,
    NONE,
)
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

SMALL: Final = 0.2  # of a period: deviations that a raster may leave
SLOW: Final = 0.3  # of the deviations, in means of FEWEST: more is a drift that was not fitted
AROUND: Final = 0.1  # s; on either side, over which a slope is taken
PARTS: Final = 20  # of a flight, whose scatter is the error
SURE: Final = 3.0  # standard errors
UNIFORM: Final = 12.0**-0.5  # standard deviation of rounding, in steps
ROUNDED: Final = 0.55  # steps; what is further off a raster is no rounding alone
WORTH: Final = 0.3  # of the noise; less need not be said


def estimate_stamp_share(values: Array, raster: Array, off: Array) -> tuple[float, float]:
    """
    Return how far readings follow the stamps, 1, or the raster, 0.

    From one reading to the next they change by their slope times what went by: of the raster, and
    of that share of the stamps' deviations.

    Parameters
    ----------
    values : ndarray, shape (n, 3)
        Three axes of one unit and noise.
    raster, off : ndarray, shape (n,)
        Regular instants, and by how much the stamps are later. [s]

    Returns
    -------
    float and float
        The share and its standard error, infinite where nothing tells.

    """
    wide = max(2, round(AROUND / float(np.median(np.diff(raster)))))
    if len(raster) < 4 * wide + PARTS:
        return 0.5, np.inf
    length = raster[2 * wide + 1 :] - raster[: -2 * wide - 1]
    slope = (values[2 * wide + 1 :] - values[: -2 * wide - 1]) / length[:, None]
    inner = slice(wide, len(raster) - wide)
    moved = np.diff(values[inner], axis=0) - slope * np.diff(raster[inner])[:, None]
    shifted = slope * np.diff(off[inner])[:, None]
    good = np.isfinite(moved).all(axis=1) & (length < 4.0 * AROUND)
    moved, shifted = moved[good], shifted[good]
    if len(moved) < PARTS:
        return 0.5, np.inf
    usual = np.median(np.abs(moved), axis=0) / HALF
    moved = np.clip(moved, -4.0 * usual, 4.0 * usual)  # a wild reading is no evidence
    parts = np.linspace(0, len(moved), PARTS, endpoint=False).astype(int)
    over = np.add.reduceat(np.sum(moved * shifted, axis=1), parts)
    under = np.add.reduceat(np.sum(shifted * shifted, axis=1), parts)
    if not under.sum() > 0.0:
        return 0.5, np.inf
    share = float(over.sum() / under.sum())
    # The scatter of the parts says little where one of them has all there is.
    scatter = np.sum((over - share * under) ** 2) / under.sum()
    return share, float(np.sqrt(max(scatter, np.mean(usual**2)) / under.sum()))


def _is_regular(raster: Array, off: Array, step: float) -> bool:
    """Tell whether stamps are on a raster but for small deviations that are not slow."""
    there = np.isfinite(off)
    period = float(np.median(np.diff(raster[there])))
    rms = float(np.std(off[there]))
    whole = there.sum() // FEWEST * FEWEST
    slow = float(np.std(off[there][:whole].reshape(-1, FEWEST).mean(axis=1)))
    return rms <= SMALL * period and slow <= SLOW * max(rms, step)


def repair_timestamps(name: str, streams: FlightStreams) -> tuple[FlightStreams, float, list[str]]:
    """
    Return a flight whose tracker and IMU have the stamps of a raster, where they follow one.

    Parameters
    ----------
    name : str
        Of the flight.
    told : Streams
        As recorded.

    Returns
    -------
    Streams
        With other stamps, or as they were.
    float
        Standard deviation of a tracker's stamps that are rounded and on no raster; else 0. [s]
    list of str
        What was done, a sentence each.

    """
    pose, deviation, words = _repair_stream(f"{name}: the tracker's stamps", streams.pose)
    others, read = dict(streams.others), streams.others.get('rates', streams.others.get('force'))
    if read is not None:
        better, _, more = _repair_stream(f"{name}: the IMU's stamps", read)
        words += more
        for sensor in ('rates', 'force') if more else ():
            if sensor in others and np.array_equal(others[sensor].time, read.time):
                others[sensor] = Stream(better.time, others[sensor].values)
    return (replace(streams, pose=pose, others=others) if words else streams), deviation, words


def _repair_stream(who: str, stream: Stream) -> tuple[Stream, float, list[str]]:
    """Return a stream on its raster, the deviation of stamps without one, and what was done."""
    time = stream.time
    if len(time) < FEWEST or np.any(np.diff(time) <= 0.0):
        return stream, 0.0, []
    step = find_stamp_step(time)
    raster = fit_regular_times(time, step)
    off, there = time - raster, np.isfinite(raster)
    if there.mean() < 0.5 or not _is_regular(raster, off, step):
        # Where the step is the period itself, readings are missing, and none is known to be wrong.
        fine = np.median(np.diff(time)) >= 3.0 * step
        return stream, UNIFORM * step if fine else 0.0, []
    rms = float(np.std(off[there]))
    share, error = estimate_stamp_share(stream.values[there, :3], raster[there], off[there])
    rounded = bool(np.mean(np.abs(off[there]) <= ROUNDED * step) >= NEARLY)
    # Stamps within half a step of a raster are rounded, unless the readings follow them: those of
    # a simulator may be taken on its steps. Jitter may be of either: there the readings decide.
    doubt = share - SURE * error if rounded else share + SURE * error
    put = np.where(there, raster, time)
    if rms < NONE or doubt > 0.5 or np.any(np.diff(put) <= 0.0):
        return stream, 0.0, []
    rate = 1.0 / float(np.median(np.diff(raster[there])))
    what = f'are rounded to {1e3 * step:g} ms' if rounded else 'jitter, its readings do not'
    word = (
        f'{who} {what}; they fit a regular {rate:.1f} Hz raster to {1e3 * rms:.2f} ms and were '
        'put on it.'
    )
    return Stream(put, stream.values), 0.0, [word]


def add_stamp_noise(
    name: str, flight: MeasuredFlight, deviation: float
) -> tuple[MeasuredFlight, list[str]]:
    """
    Return a flight whose poses are as uncertain as their stamps make them.

    Parameters
    ----------
    name : str
        Of the flight.
    flight : Measured
        On the grid.
    deviation : float
        Of the stamps. [s]

    """
    if deviation == 0.0:
        return flight, []
    apart = float(flight.time[1] - flight.time[0])
    moved = np.sqrt(np.nanmean(np.diff(flight.position, axis=0) ** 2, axis=0))
    turned = 2.0 * np.sqrt(np.nanmean(np.diff(flight.quaternion, axis=0) ** 2) * 4.0 / 3.0)
    more = np.concatenate([moved, [turned] * 3]) / apart * deviation
    noise = flight.noise.copy()
    noise[:6] = np.hypot(noise[:6], more)
    words = [
        f"{name}: the tracker's stamps are rounded and come at no regular rate; what moves in "
        f'{1e3 * deviation:.2f} ms is counted as noise of the poses.'
    ]
    return replace(flight, noise=noise), words if np.any(more > WORTH * flight.noise[:6]) else []
