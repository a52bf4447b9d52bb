# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Repair rounded or jittering timestamps of a tracker or an IMU with a regular sampling rate.

A wrong stamp shifts a pose along the motion. Stamps of 1 ms resolution at 120 Hz err in a pattern
of three, which looks like an oscillation on the grid. The stamps alone do not show whether they or
the sampling is irregular. The readings do, because a vehicle moves smoothly: if they follow a
regular raster, it replaces the stamps. Commands and slow sensors keep their stamps.
"""

from dataclasses import replace
from typing import Final

from lta_discovery.flights.measured_flight import FlightStreams, MeasuredFlight, Stream
from lta_discovery.flights.noise import NOISE_MEDIAN
from lta_discovery.flights.regular_times import (
    FEWEST,
    find_stamp_step,
    fit_regular_times,
    NEARLY,
    RASTER_JITTER,
)
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

RASTER_DEVIATION: Final = 0.2  # of a period: largest RMS deviation of stamps from a raster
SLOW: Final = 0.3  # of the deviations, in means of FEWEST: more is an unmodelled drift
SLOPE_MARGIN: Final = 0.1  # s; on either side, for the slope of the readings
SCATTER_PARTS: Final = 20  # parts of a flight, whose scatter gives the standard error
CERTAIN_ERRORS: Final = 3.0  # standard errors
ROUNDING_DEVIATION: Final = 12.0**-0.5  # standard deviation of rounding, in steps
ROUNDED: Final = 0.55  # steps; a larger deviation is not rounding alone
WORTH: Final = 0.3  # of the noise; less is not reported


def estimate_stamp_share(values: Array, raster: Array, off: Array) -> tuple[float, float]:
    """
    Estimate whether readings follow the stamps (1) or the raster (0).

    Between two readings the change is the slope times the elapsed time: that of the raster, plus
    the estimated share of the stamps' deviations.

    Parameters
    ----------
    values : ndarray, shape (n, 3)
        Three axes of one unit and noise.
    raster, off : ndarray, shape (n,)
        Regular sampling times, and the deviations of the stamps from them. [s]

    Returns
    -------
    float and float
        The share and its standard error, infinite without evidence.

    """
    wide = max(2, round(SLOPE_MARGIN / float(np.median(np.diff(raster)))))
    if len(raster) < 4 * wide + SCATTER_PARTS:
        return 0.5, np.inf
    # Slope over a wide interval around each pair of readings
    length = raster[2 * wide + 1 :] - raster[: -2 * wide - 1]
    slope = (values[2 * wide + 1 :] - values[: -2 * wide - 1]) / length[:, None]
    inner = slice(wide, len(raster) - wide)
    # What the motion on the raster does not explain ...
    moved = np.diff(values[inner], axis=0) - slope * np.diff(raster[inner])[:, None]
    # ... and what the deviations of the stamps would explain
    shifted = slope * np.diff(off[inner])[:, None]
    good = np.isfinite(moved).all(axis=1) & (length < 4.0 * SLOPE_MARGIN)
    moved, shifted = moved[good], shifted[good]
    if len(moved) < SCATTER_PARTS:
        return 0.5, np.inf
    usual = np.median(np.abs(moved), axis=0) / NOISE_MEDIAN
    moved = np.clip(moved, -4.0 * usual, 4.0 * usual)  # limit the influence of outliers
    parts = np.linspace(0, len(moved), SCATTER_PARTS, endpoint=False).astype(int)
    over = np.add.reduceat(np.sum(moved * shifted, axis=1), parts)
    under = np.add.reduceat(np.sum(shifted * shifted, axis=1), parts)
    if not under.sum() > 0.0:
        return 0.5, np.inf
    # Least squares through 0
    share = float(over.sum() / under.sum())
    # If one part holds all the motion, the scatter of the parts is too small: use the noise.
    scatter = np.sum((over - share * under) ** 2) / under.sum()
    return share, float(np.sqrt(max(scatter, np.mean(usual**2)) / under.sum()))


def _is_regular(raster: Array, off: Array, step: float) -> bool:
    """Return whether stamps deviate from a raster only a little and without slow drift."""
    there = np.isfinite(off)
    period = float(np.median(np.diff(raster[there])))
    rms = float(np.std(off[there]))
    whole = there.sum() // FEWEST * FEWEST
    # Means over FEWEST poses keep a slow drift and average out rounding
    slow = float(np.std(off[there][:whole].reshape(-1, FEWEST).mean(axis=1)))
    return rms <= RASTER_DEVIATION * period and slow <= SLOW * max(rms, step)


def repair_timestamps(name: str, streams: FlightStreams) -> tuple[FlightStreams, float, list[str]]:
    """
    Replace the stamps of tracker and IMU by a regular raster, where the readings follow one.

    Returns
    -------
    FlightStreams
        With new stamps, or unchanged.
    float
        Standard deviation of rounded tracker stamps without a raster; else 0. [s]
    list of str
        Applied repairs, one sentence each.

    """
    pose, deviation, words = _repair_stream(f"{name}: the tracker's timestamps", streams.pose)
    others, read = dict(streams.others), streams.others.get('rates', streams.others.get('force'))
    if read is not None:
        better, _, more = _repair_stream(f"{name}: the IMU's timestamps", read)
        words += more
        # Both come in one IMU message, so they share the stamps
        for sensor in ('rates', 'force') if more else ():
            if sensor in others and np.array_equal(others[sensor].time, read.time):
                others[sensor] = Stream(better.time, others[sensor].values)
    return (replace(streams, pose=pose, others=others) if words else streams), deviation, words


def _repair_stream(who: str, stream: Stream) -> tuple[Stream, float, list[str]]:
    """Return a stream on its raster, the deviation of stamps without one, and the repairs."""
    time = stream.time
    if len(time) < FEWEST or np.any(np.diff(time) <= 0.0):
        return stream, 0.0, []
    step = find_stamp_step(time)
    raster = fit_regular_times(time, step)
    off, there = time - raster, np.isfinite(raster)
    if there.mean() < 0.5 or not _is_regular(raster, off, step):
        # If all gaps are multiples of one period, readings are missing, but no stamp is wrong.
        gaps = np.rint(np.diff(time) / step).astype(np.int64) if step else np.ones(1, np.int64)
        fine = step > 0.0 and np.median(gaps) >= 3 * np.gcd.reduce(gaps)
        return stream, ROUNDING_DEVIATION * step if fine else 0.0, []
    rms = float(np.std(off[there]))
    share, error = estimate_stamp_share(stream.values[there, :3], raster[there], off[there])
    rounded = bool(np.mean(np.abs(off[there]) <= ROUNDED * step) >= NEARLY)
    # Stamps within half a step of a raster are rounded, unless the readings follow them (as in a
    # simulator with fixed steps). Other deviations are jitter only if the readings show it.
    doubt = share - CERTAIN_ERRORS * error if rounded else share + CERTAIN_ERRORS * error
    put = np.where(there, raster, time)
    if rms < RASTER_JITTER or doubt > 0.5 or np.any(np.diff(put) <= 0.0):
        return stream, 0.0, []
    rate = 1.0 / float(np.median(np.diff(raster[there])))
    what = (
        f'are rounded to {1e3 * step:g} ms' if rounded else 'jitter, but its sampling is regular'
    )
    word = (
        f'{who} {what}; they were replaced by regular times at {rate:.1f} Hz, from which they '
        f'deviate by {1e3 * rms:.2f} ms rms.'
    )
    return Stream(put, stream.values), 0.0, [word]


def add_stamp_noise(
    name: str, flight: MeasuredFlight, deviation: float
) -> tuple[MeasuredFlight, list[str]]:
    """Increase the noise of the poses by the effect of rounded stamps."""
    if deviation == 0.0:
        return flight, []
    apart = float(flight.time[1] - flight.time[0])
    moved = np.sqrt(np.nanmean(np.diff(flight.position, axis=0) ** 2, axis=0))
    # A small rotation is twice the vector part of its quaternion; 4 components have 3 freedoms.
    turned = 2.0 * np.sqrt(np.nanmean(np.diff(flight.quaternion, axis=0) ** 2) * 4.0 / 3.0)
    # Speed times the deviation of the stamps
    more = np.concatenate([moved, [turned] * 3]) / apart * deviation
    noise = flight.noise.copy()
    noise[:6] = np.hypot(noise[:6], more)
    words = [
        f"{name}: the tracker's timestamps are rounded and cannot be repaired; an error of "
        f'{1e3 * deviation:.2f} ms rms is included in the noise of the poses.'
    ]
    return replace(flight, noise=noise), words if np.any(more > WORTH * flight.noise[:6]) else []
