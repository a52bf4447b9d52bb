"""
Remove single outliers, since one wrong pose can outweigh a whole flight.

A reading is in doubt if it is off the cubic through its neighbours by many times the noise. A
second cubic through undoubted readings nearby decides. This runs on the grid; tracker outliers
were removed before (`tracker_outliers`).
"""

from dataclasses import replace
from typing import Final

from lta_discovery.flights.measured_flight import MeasuredFlight
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

WILD: Final = 12.0  # standard deviations of the noise, off the cubic
AROUND: Final = 5  # readings on either side for the second cubic
SHARE: Final = 0.3  # of the worst; less is the error of the cubic
LONGEST: Final = 9  # readings in doubt; more are not single outliers


def find_outliers(values: Array, noise: float) -> Flags:
    """
    Return a mask of the outliers of an evenly sampled series.

    `values`, shape (n,): NaN where there is none.
    """
    out = np.zeros(len(values), dtype=np.bool_)
    if not np.isfinite(noise) or len(values) < 5:
        return out
    doubt = np.zeros(len(values), dtype=np.bool_)
    # Cubic through the two neighbours on either side, at the centre: weights -1, 4, 4, -1 by 6.
    through = (4.0 * (values[1:-3] + values[3:-1]) - values[:-4] - values[4:]) / 6.0
    doubt[2:-2] = np.abs(values[2:-2] - through) > WILD * noise
    # Begin and end of each run of doubtful readings
    edges = np.flatnonzero(np.diff(np.concatenate([[0], doubt.astype(np.int8), [0]])))
    for begin, end in edges.reshape(-1, 2):
        around = np.r_[max(0, begin - AROUND) : begin, end : min(len(values), end + AROUND)]
        # Doubtful readings must not shape the second cubic
        around = around[np.isfinite(values[around]) & ~doubt[around]]
        if end - begin <= LONGEST and len(around) > AROUND:
            inside = np.arange(begin, end)
            cubic = np.polynomial.Polynomial.fit(around, values[around], 3)
            off = np.abs(values[inside] - cubic(inside))
            out[inside] = off > max(WILD * noise, SHARE * off.max())
    return out


def remove_outliers(flight: MeasuredFlight) -> tuple[MeasuredFlight, int]:
    """
    Remove outliers from a flight; return it and their number.

    A pose is one reading: its position and attitude are removed together.
    """
    # A quaternion changes by half the rotation angle.
    noise = np.concatenate([flight.noise[:3], np.full(4, 0.5 * flight.noise[3:6].max())])
    poses = np.column_stack([flight.position, flight.quaternion])
    lost = np.any([find_outliers(*each) for each in zip(poses.T, noise, strict=True)], axis=0)
    position, quaternion = flight.position.copy(), flight.quaternion.copy()
    # Position and attitude come from one solution of the tracker
    position[lost] = quaternion[lost] = np.nan
    readings, count = flight.readings.copy(), int(lost.sum())
    for k, level in enumerate(flight.noise[6:]):
        gone = find_outliers(readings[:, k], level)
        readings[gone, k] = np.nan
        count += int(gone.sum())
    out = replace(flight, position=position, quaternion=quaternion, readings=readings)
    return (out if count else flight), count
