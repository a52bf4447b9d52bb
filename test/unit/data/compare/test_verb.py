# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""`lta compare`: its status, its page and figures, and bad input in one sentence."""

import json
import sys

from lta_bag import BagWriter
from lta_bag.schemas import load_jazzy_types
from lta_cli import app
import pytest

from ...report_flight import make, pose  # noqa: TID252 - `test` is Python's own
from .compare_flight import stamped, write_motion
from .compare_two import NOISY, OTHER, X, Z

ODOMETRY = 'nav_msgs/msg/Odometry'


def run(monkeypatch, *words):
    monkeypatch.setattr(sys, 'argv', ['lta', 'compare', *map(str, words)])
    return app.run_command_line()


def test_the_command_writes_page_and_figures_and_tells_by_its_status(
    tmp_path, monkeypatch, capsys
):
    a = write_motion(tmp_path / 'a', **NOISY, until=20.0)
    b = write_motion(tmp_path / 'b', **OTHER, offset=0.1234, step=(10.0, 0.3), until=20.0)
    out = tmp_path / 'out'
    assert run(monkeypatch, a, b, '--out', out, '--json') == 0
    printed = json.loads(capsys.readouterr().out)
    assert printed['verdict'] == 'different'
    assert printed['timing']['offset'] == pytest.approx(0.1234, abs=0.01)
    assert printed['channels'][0]['name'] == Z
    assert printed['channels'][0]['parting']['at'] == pytest.approx(10.0, abs=0.05)
    kept = json.loads((out / 'compare.json').read_text())
    assert kept == {key: value for key, value in printed.items() if key != 'page'}
    page = (out / 'report.html').read_text(encoding='utf-8')
    assert 'altitude of odom' in page
    assert 'http' not in page.split('<script>')[0]
    again = ['--no-page', '--topic', 'odom']
    assert run(monkeypatch, a, b, '--out', tmp_path / '1', '--same', *again) == 1
    wide = ['--tolerance', 'odom/*=40 cm', '--offset', '123.4ms']
    assert run(monkeypatch, a, b, '--out', tmp_path / '2', '--same', *again, *wide) == 0
    assert not (tmp_path / '2' / 'report.html').exists()
    assert run(monkeypatch, a, a, '--out', tmp_path / '3', '--same', '--no-page') == 0


def test_the_pictures_of_the_page_are_taken_if_asked_for(tmp_path, monkeypatch, capsys):
    taken = []
    monkeypatch.setattr('lta_analysis.door.find_chromium', lambda: 'chromium')
    monkeypatch.setattr(
        'lta_report.report_page.write_pictures', lambda *given: taken.append(given)
    )
    bag, out, pictures = write_motion(tmp_path / 'a', until=5.0), tmp_path / 'out', tmp_path / 'p'
    assert run(monkeypatch, bag, bag, '--out', out, '--pictures', pictures) == 0
    ((page, folder),) = taken
    assert (page.name, folder) == ('report.html', pictures)
    (pictures / 'mine').mkdir(parents=True)
    assert run(monkeypatch, bag, bag, '--out', tmp_path / '2', '--pictures', pictures) == 2
    assert 'is not empty' in capsys.readouterr().err
    assert not (tmp_path / '2').exists()


def test_robots_of_one_bag_are_named_and_compared(tmp_path, monkeypatch, capsys):
    bag = tmp_path / 'pair'
    with BagWriter(bag, {}) as writer:
        for robot in ('lta1', 'lta2'):
            writer.add_topic(f'/{robot}/odom', ODOMETRY, [])
        for k in range(100):
            for robot, x in (('lta1', 0.0), ('lta2', 0.5)):
                place = make(
                    'geometry_msgs/msg/PoseWithCovariance', pose=pose(x, 0.0, 0.01 * k, 0)
                )
                time = 1_000_000_000 + 10_000_000 * k
                message = make(ODOMETRY, header=stamped(time, 'map'), pose=place)
                writer.write(
                    f'/{robot}/odom',
                    bytes(load_jazzy_types().serialize_cdr(message, ODOMETRY)),
                    time,
                )
    out = ['--out', tmp_path / 'out', '--no-page', '--json']
    assert run(monkeypatch, bag, bag, *out) == 2
    told = capsys.readouterr().err
    assert told.startswith(f"Bag A: '{bag}' contains several robots (lta1, lta2);")
    assert told.count('\n') == 1
    assert run(monkeypatch, bag, bag, '--robot', 'lta1:lta2', *out) == 0
    content = json.loads(capsys.readouterr().out)
    assert [content[side]['robot'] for side in 'ab'] == ['lta1', 'lta2']
    x = next(each for each in content['channels'] if each['name'] == X)
    assert x['measures']['bias'] == pytest.approx(0.5)
    assert x['parting']['at'] == 0.0
