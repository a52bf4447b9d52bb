"""Convert a comparison to plain data for --json and compare.json, with units."""

from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

from lta_data.compare.channel_comparison import ChannelComparison
from lta_data.compare.compared_flight import ComparedFlight, TopicFaults
from lta_data.compare.comparison import ComparisonResult
from lta_data.compare.sentences import format_verdict
from lta_data.compare.spectra import average_log_bands, ChannelSpectra
from lta_report.json_value import to_json_value
import numpy as np

UNITS = {
    'offset': 's', 'sigma': 's', 'lead': 's', 'drift': '1', 'drift_sigma': '1', 'middle': 's',
    'span': 's', 'yaw': 'rad', 'x': 'm', 'y': 'm', 'z': 'm', 'before': 'm', 'after': 'm',
    'periods': 's', 'at': 's', 'first': 's', 'greatest_at': 's', 'lag': 's', 'frequency': 'Hz',
    'gaps': 's', 'missing': 's', 'backwards': 's', 'start': 'ns', 'nrmse': '1', 'coherence': '1',
    'outside': '1', 'score': '1', 'bias, rms, rms_low, rms_high, greatest, spread, band': 'unit',
    'a, b, difference (spectra)': 'unit2/Hz',
}  # fmt: skip


def comparison_to_dict(comparison: ComparisonResult) -> dict[str, Any]:
    """Return the whole comparison; unknown values are null."""
    content = {
        'verdict': comparison.verdict,
        'sentence': format_verdict(comparison),
        'a': flight_to_dict(comparison.a, comparison.faults_a, comparison.only_a),
        'b': flight_to_dict(comparison.b, comparison.faults_b, comparison.only_b),
        'span': comparison.span,
        'timing': asdict(comparison.timing),
        'frames': [asdict(each) for each in comparison.frames],
        'identical_topics': comparison.identical_topics,
        'remarks': comparison.remarks,
        'channels': [channel_to_dict(each) for each in comparison.channels],
        'normalised_by': 'standard deviation of A at the compared times',
        'units': UNITS,
    }
    plain: dict[str, Any] = to_json_value(content)
    return plain


def flight_to_dict(
    side: ComparedFlight, faults: Mapping[str, TopicFaults], only: tuple[str, ...]
) -> dict[str, Any]:
    """Return the origin and the faults of one flight."""
    return {
        'path': side.path,
        'robot': side.robot,
        'start': side.start,
        'span': side.span,
        'topics_only_here': only,
        'faults': {name: asdict(each) for name, each in faults.items() if not each.is_clean},
        'periods': {name: each.period for name, each in faults.items()},
    }


def channel_to_dict(each: ChannelComparison) -> dict[str, Any]:
    """Return a channel with its spectra at up to 96 frequencies."""
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
        # A NamedTuple would become a list.
        'correlation': each.peak and each.peak._asdict(),
        'spectra': each.spectra and _round_spectra(average_log_bands(each.spectra)),
    }


def _round_spectra(spectra: ChannelSpectra) -> dict[str, Any]:
    """Return spectra with six digits, which are enough and keep the file small."""
    return {
        name: [float(f'{value:.6g}') for value in part] if isinstance(part, np.ndarray) else part
        for name, part in asdict(spectra).items()
    }
