"""Convert the result of a tuning to JSON."""

from dataclasses import asdict
import math
from typing import Any

from lta_report.json_value import replace_nonfinite
from lta_studies.tune.compare import compare_costs, NAMES
from lta_studies.tune.margins import to_decibels
from lta_studies.tune.run import GainSetResult, TuningResult

UNITS = {
    'loss': 'kg',
    'helium': 'g',
    'days': 'd',
    'phase': 'deg',
    'gain': 'dB',
    'delay': 's',
    'crossover': 'rad/s',
    'growth': '1/s',
    'swing': 'rad/s',
    'swing_angle': 'rad',
    'settle': 's',
    'overshoot': '1',
    'steady': '1',
}


def tuning_to_json(tuned: TuningResult) -> Any:  # noqa: ANN401 - what JSON holds
    """Return a tuning as JSON content, in the units that it lists."""
    gap = compare_costs(tuned.old.flights, tuned.new.flights)
    return replace_nonfinite(
        {
            'candidates': len(tuned.found.history),
            'flights': len(tuned.found.history) * len(tuned.losses),
            'stopped': tuned.found.stopped,
            'cost': {'old': tuned.found.first, 'new': tuned.found.cost},
            'fresh_difference': asdict(gap),
            'gains': dict(tuned.found.numbers),
            'old': gain_set_to_json(tuned.old),
            'new': gain_set_to_json(tuned.new),
            'file': str(tuned.file),
            'units': UNITS,
        }
    )


def gain_set_to_json(side: GainSetResult) -> dict[str, object]:
    """Return the results of one set of gains as JSON data."""
    steps = {
        name: {
            figure: asdict(side.flights.summarize_step(k, figure))
            for figure in ('settle', 'overshoot', 'steady')
        }
        for k, name in enumerate(NAMES)
    }
    # A margin is None if the loop never reaches the critical gain or phase
    margins = []
    for each in side.steadiness:
        found = each.margins
        row: dict[str, object] = {
            'loop': each.loop, 'speed': each.speed, 'loss': each.loss, 'stable': each.stable,
            'growth': each.growth, 'swing': each.swing,
        }  # fmt: skip
        if found is not None:
            # Gain in dB, phase in degrees, as in Bode plots
            row |= {
                'gain': None if found.gain is None else to_decibels(found.gain),
                'gain_down': None if found.gain_down is None else to_decibels(found.gain_down),
                'phase': None if found.phase is None else math.degrees(found.phase),
                # Seconds of additional delay at which the loop becomes unstable
                'delay': found.delay,
                'crossover': found.crossover,
            }
        margins.append(row)
    limit = side.limit
    return {
        'lost': side.flights.lost_share._asdict(),
        'reached': side.flights.reached_share._asdict(),
        'cost': asdict(side.flights.compute_metric_quartiles('cost')),
        'swing_angle': asdict(side.flights.compute_metric_quartiles('swing')),
        'steps': steps,
        'margins': margins,
        'helium': {**asdict(limit), 'days': list(limit.days)},
    }
