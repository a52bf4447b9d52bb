"""
Score names by forecasts where nothing is missing: `python test/score/carrying.py --cases 20`.

Each case is a clean one of `lta challenge make --row pose`, with more flights: a GT-MAB that is
off from its file by the tolerances of vehicles, poses alone, filtered both ways until no noise is
left, as published ones are. Every case is forced through naming by forecasts, as if the readings
had said that something is missing. Any name is false. Told is also what tolerances leave of the
squared error in regimes left out, below which nothing is named (`carrying.route.LOOSE`), and what
would be named without that limit.
"""

import argparse
import json
from pathlib import Path
import sys
import time
from typing import Any

from lta_analysis.challenge.case import Drawing
from lta_analysis.challenge.make import known
from lta_analysis.discovery.carrying import route
from lta_analysis.discovery.finding import Finding
from lta_analysis.discovery.flights.measured import measured, Stream, Streams
from lta_analysis.discovery.flights.mistaken import mistaken
from lta_analysis.discovery.outside.unexplained import Remainder
from lta_analysis.discovery.study import Flown, ready, Study
from lta_analysis.sweep.statistics import wilson
import numpy as np
from numpy.typing import NDArray
from rich.progress import track
from scipy.signal import butter, filtfilt

SECONDS = (60.0, 90.0)
ROLES = ('train', 'confirm', 'holdout', *('train', 'confirm') * 4)
CUT = 0.03  # of half the sampling rate: 1.5 Hz


def smoothed(pose: tuple[NDArray[Any], NDArray[Any]]) -> Stream:
    """Return poses without those that the tracker mistook, filtered both ways."""
    stamps, values = pose
    good = ~mistaken(values)
    stamps, values = stamps[good], values[good].copy()
    signs = np.where(np.sum(values[1:, 3:] * values[:-1, 3:], axis=1) < 0.0, -1.0, 1.0)
    values[1:, 3:] *= np.cumprod(signs)[:, None]
    values = filtfilt(*butter(2, CUT), values, axis=0)
    values[:, 3:] /= np.linalg.norm(values[:, 3:], axis=1, keepdims=True)
    return Stream(stamps, values)


def cleanly(seed: int) -> Study:
    """Return a study of clean flights, as if its readings had left something without a name."""
    about = known()
    case = Drawing(about, seed, 0, 'pose', 'clean', SECONDS).drawn(ROLES)
    flown = []
    for flight in case.flights:
        pose = smoothed(flight.streams['ground_truth/odom'])
        commands = Stream(*flight.streams['motors'])
        made = measured(Streams(pose, commands))
        flown.append(Flown(flight.name, flight.role, ready(about.vehicle, made, about.knobs)))
    left = (Remainder('surge', 0.02, 30.0, (), 0.0),)
    finding = Finding('unexplained', (), (), (), (), True, left, (), seed, {}, 'gtmab')
    return Study(finding, about.nominal, about.nominal, flown, [])


def judged(seed: int, limit: float) -> dict[str, Any]:
    """Return what came of a case, with a limit of what tolerances may take."""
    began, told = time.process_time(), list[float]()
    study = cleanly(seed)
    route.LOOSE = limit  # type: ignore[misc]
    found = route.by_forecasts(study, lambda what, part: None)
    effects = [one.name for one in found.finding.effects]
    warned = [one for one in found.finding.warnings if 'interpolation' in one]
    return {'seed': seed, 'names': effects, 'warned': warned, 'cpu': time.process_time() - began}



