# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Study real flights with `lta discover`.

The flights are those of `forecasts.py` in LTA_DATA. What is learned from one day or from some
inputs is judged by forecasts of another day or of other inputs. Some minutes for each study.
"""

from argparse import Namespace
from collections.abc import Iterator
import math
from pathlib import Path
import tempfile
import time
from typing import Final

from lta_discovery.discovery.run import discover_effects, DiscoveryRequest
from lta_report.formatting import format_markdown_table, MISSING
from lta_report.report import Report

from campaigns.forecasts import list_mocap, list_rgblimp, MOCAP, RealStudy, RGBLIMP
from campaigns.harness import Campaign, Case, Row, Rows

MODELS: Final = {
    'coast': 'coasting', 'before': 'vehicle file', 'calibrated': 'calibrated.yaml',
    'tuned': 'tolerances fitted',
    'after': 'with what is named or closest', 'written': 'vehicle.yaml',
}  # fmt: skip
SETS: Final = {'mocap_blimp': (MOCAP, list_mocap), 'rgblimp': (RGBLIMP, list_rgblimp)}


def format_study(title: str, report: Report, seconds: float) -> Iterator[str]:
    """Yield the Markdown of a study."""
    assert isinstance(report.data, dict)
    data = report.data
    yield f'### {title}\n'
    said = data['conclusion']
    yield ' '.join([said['headline'], *said['details'], said['advice']]) + '\n'
    rows = [
        [f'{one["name"]}.{name}', f'{each["value"]:.3g} {each["unit"]}',
         f'{each["ci95"][0]:.2g} to {each["ci95"][1]:.2g}',
         'none' if each['before'] is None else f'{each["before"]:.3g}',
         f'{one["log_evidence"]:.0f}', ', '.join(one['confusable_with']) or MISSING]
        for one in [*data['effects'], *data['closest']]
        for name, each in one['parameters'].items()
    ]  # fmt: skip
    rows += [
        [f'force: {one["name"]}', '', '', '', f'{one["log_evidence"]:.0f}', '']
        for one in data['forces']
    ]
    heads = ('missing', 'value', '95 %', 'vehicle file', 'evidence [nats]', 'or instead')
    if rows:
        yield format_markdown_table(heads, rows) + '\n'
    rows = [
        [f'{one["channel"]}, {one["horizon_s"]:g} s',
         *(f'{factor * one[key]:.1f} {unit}' if key in one else MISSING for key in MODELS),
         str(one['pieces'])]
        for one in data['gaps']
        for factor, unit in [(100.0, 'cm') if one['unit'] == 'm' else (math.degrees(1.0), '°')]
    ]  # fmt: skip
    yield format_markdown_table(('error after', *MODELS.values(), 'forecasts'), rows) + '\n'
    yield f'{seconds:.0f} s of processor time.\n'


def run_study(study: RealStudy) -> Iterator[str]:
    """Yield the Markdown of a study of real flights."""
    held_out = [bag for group in study.held_out.values() for bag in group]
    begin = time.process_time()
    request = DiscoveryRequest(
        vehicle=study.vehicle, train=tuple(study.train), holdout=tuple(held_out)
    )
    report = discover_effects(request, lambda _what, _part: None)
    title = f'{" and ".join(study.held_out)}: {len(study.train)} flights teach'
    yield from format_study(title, report, time.process_time() - begin)


def run(case: Case, options: Namespace) -> Row:
    """Return the text on a set of flights."""
    data, list_studies = SETS[case.kind]
    if not data.is_dir():
        return {'wrong': f'{data} is not there; set LTA_DATA'}
    with tempfile.TemporaryDirectory() as place:
        return {'text': [line for one in list_studies(Path(place)) for line in run_study(one)]}


def list_table(rows: Rows, options: Namespace) -> Iterator[str]:
    """Yield the texts."""
    yield from (line for row in rows.values() for line in row.get('text', ()))


CAMPAIGN: Final = Campaign(
    lambda options: list(SETS), run, list_table, page='discovery_flights.md', alone=True
)
