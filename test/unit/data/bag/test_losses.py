# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""What is lost of a damaged recording is said by whoever reads it, not by its table alone."""

import sys

import lta_analysis
from lta_cli import app
from lta_data.bag import open_flight
from lta_data.compare.comparison import compare_flights, ComparisonRequest
import pytest

from ..compare.compare_flight import write_motion  # noqa: TID252 - `test` is Python's own


@pytest.fixture
def harmed(tmp_path):
    """Return a finished, indexed bag, in one of whose chunks a byte is another."""
    bag = write_motion(tmp_path / 'harmed', until=60.0)
    (file,) = bag.glob('*.mcap')
    data = bytearray(file.read_bytes())
    data[len(data) // 3] ^= 0xFF
    file.write_bytes(data)
    return bag


@pytest.fixture
def call(monkeypatch, capsys):
    def call(*words):
        monkeypatch.setattr(sys, 'argv', ['lta', *map(str, words)])
        return app.run_command_line(), ' '.join(''.join(capsys.readouterr()).split())

    return call


def losses(bag):
    """Return what reading all of it finds."""
    flight = open_flight(bag)
    list(flight.bag.iterate_messages())
    (told,) = flight.bag.losses
    return told


def test_a_notebook_sees_it(harmed):
    flight = lta_analysis.open(harmed)
    assert 0 < len(flight['odom']) < 60 * 50
    assert flight.losses == [losses(harmed)]
    assert losses(harmed) in repr(flight)


def test_an_export_says_it(harmed, tmp_path, call):
    status, told = call('bag', 'export', harmed, '--out', tmp_path / 'out')
    assert status == 0
    assert losses(harmed) in told


@pytest.mark.parametrize('words', [(), ('odom/pose.pose.position.x',)])
def test_a_quick_look_says_it(harmed, call, words):
    status, told = call('bag', 'plot', harmed, *words)
    assert status == 0
    assert told.count(losses(harmed)) == 1


def test_a_comparison_says_it(harmed, tmp_path):
    whole = write_motion(tmp_path / 'whole', until=60.0)
    found = compare_flights(open_flight(whole), open_flight(harmed), ComparisonRequest())
    assert f'B: {losses(harmed)}' in found.remarks
    assert found.verdict != 'identical'
