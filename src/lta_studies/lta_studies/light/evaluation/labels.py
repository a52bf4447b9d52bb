"""Label strategies and cases, and format values with their intervals."""

from collections.abc import Mapping
import math
from typing import Final

from lta_flight.sweep.statistics import ShareInterval
from lta_report.formatting import MISSING
from lta_studies.light.evaluation import pilot
from lta_studies.light.evaluation.cells import EvaluationCell
from lta_studies.light.evaluation.intervals import BootstrapMean
from lta_studies.light.evaluation.sets import EvaluationAxis

STRATEGIES: Final[Mapping[str, str]] = {
    'bag': 'BAG', 'dga': 'DGA', 'des': 'DES', 'homing': 'homing', pilot.NAME: 'pilot',
}  # fmt: skip
FACTORS: Final[Mapping[str, str]] = {
    'as_flown': 'as flown',
    'head': 'head wind',
    'cross': 'cross wind',
    'tail': 'tail wind',
    'light_wind': '0.22 m/s outside',
    'more_wind': '0.36 m/s outside',
    'start_heading': 'start heading within 30\N{DEGREE SIGN} of the lamp',
    'open_walls': 'no walls; flights that leave the room fail',
    'not_stopping': 'DGA does not stop to turn',
    'no_computing': 'DGA needs no computing time',
    'plane_through_origin': 'plane of DGA through the origin, as printed',
    'ideal_cosine': 'diodes with an ideal cosine response',
    'narrow_diodes': 'narrow diodes (cosine to the power of 4)',
    'small_swing': 'DES swings its nose by 0.5 rad',
    'gradient_alone': 'DES uses only the gradient',
    'scan_and_gradient': 'DES uses scan and gradient',
}


def label_strategy(name: str) -> str:
    """Return the label of a strategy."""
    return STRATEGIES.get(name, name)


def label_factor(name: str) -> str:
    """Return the label of a named case."""
    return FACTORS.get(name, name.replace('_', ' ')) or MISSING


def label_case(cell: EvaluationCell, axis: EvaluationAxis | None) -> str:
    """Return the label of a cell's case: its name, or its value on the axis."""
    if axis is None or math.isnan(cell.place):
        return label_factor(cell.case)
    family = f'{label_factor(cell.family)}, ' if cell.family else ''
    return f'{family}{cell.place:,.6g} {axis.unit}'


def format_share(value: ShareInterval) -> str:
    """Format a share with its interval in percent."""
    if math.isnan(value.value):
        return MISSING
    return f'{100 * value.value:.0f} % ({100 * value.low:.0f} to {100 * value.high:.0f})'


def format_mean(value: BootstrapMean, digits: int = 1) -> str:
    """Format a mean with its interval, without unit."""
    if math.isnan(value.value):
        return MISSING
    if math.isnan(value.low):
        return f'{value.value:.{digits}f}'
    return f'{value.value:.{digits}f} ({value.low:.{digits}f} to {value.high:.{digits}f})'
