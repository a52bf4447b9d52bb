"""A comparison as plain data, for --json and compare.json, with units."""

from collections.abc import Mapping
from dataclasses import asdict, is_dataclass
from typing import Any

from lta_data.compare.apart import Apart
from lta_data.compare.comparison import Comparison
from lta_data.compare.faults import Faults
from lta_data.compare.side import Side
from lta_data.compare.spectra import thinned_spectra
from lta_data.compare.words import verdict
from lta_report.json_value import finite
import numpy as np

UNITS = {
    'offset': 's', 'sigma': 's', 'lead': 's', 'drift': '1', 'drift_sigma': '1', 'middle': 's',
    'span': 's', 'yaw': 'rad', 'x': 'm', 'y': 'm', 'z': 'm', 'before': 'm', 'after': 'm',
    'periods': 's', 'at': 's', 'first': 's', 'greatest_at': 's', 'lag': 's', 'frequency': 'Hz',
    'gaps': 's', 'missing': 's', 'backwards': 's', 'start': 'ns', 'nrmse': '1', 'coherence': '1',
    'outside': '1', 'score': '1', 'bias, rms, rms_low, rms_high, greatest, spread, band': 'unit',
    'a, b, difference (spectra)': 'unit2/Hz',
}  # fmt: skip


def to_dict(found: Comparison) -> dict[str, Any]:
    """Return everything that was found; what is not known is null."""
    content = {
        'verdict': found.verdict,
        'sentence': verdict(found),
        'a': side_dict(found.a, found.faults_a, found.only_a),
        'b': side_dict(found.b, found.faults_b, found.only_b),
        'span': found.span,
        'timing': asdict(found.timing),
        'frames': [asdict(each) for each in found.frames],
        'identical_topics': found.identical_topics,
        'remarks': found.remarks,
        'channels': [channel_dict(each) for each in found.channels],
        'normalised_by': 'standard deviation of A at the instants that are compared',
        'units': UNITS,
    }
    plain: dict[str, Any] = bare(content)
    return plain


def side_dict(side: Side, faults: Mapping[str, Faults], only: tuple[str, ...]) -> dict[str, Any]:
    """Return a flight: where it comes from, and what is wrong with it."""
    return {
        'path': side.path,
        'robot': side.robot,
        'start': side.start,
        'span': side.span,
        'topics_only_here': only,
        'faults': {name: asdict(each) for name, each in faults.items() if not each.clean},
        'periods': {name: each.period for name, each in faults.items()},
    }


def channel_dict(each: Apart) -> dict[str, Any]:
    """Return a channel, its spectra at up to 96 frequencies."""
    return {
        'name': each.name,
        'other': each.other,
        'unit': each.unit,
        'angular': each.angular,
        'verdict': each.verdict,
        'score': each.score,
        'periods': each.periods,
        'measures': each.measures,
        'parting': each.parting,
        'correlation': each.peak and each.peak._asdict(),
        'spectra': each.spectra and thinned_spectra(each.spectra),
    }


def bare(value: Any) -> Any:  # noqa: ANN401 - what JSON holds
    """Return a value as JSON can hold it: no NaN, no infinity, no classes."""
    if is_dataclass(value) and not isinstance(value, type):
        value = asdict(value)
    if isinstance(value, Mapping):
        return {str(key): bare(part) for key, part in value.items()}
    if isinstance(value, np.ndarray):
        value = [float(f'{part:.6g}') for part in value]
    if isinstance(value, list | tuple):
        return [bare(part) for part in value]
    if isinstance(value, np.floating):
        value = float(value)
    return finite(value)
