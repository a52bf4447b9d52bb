# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Pages made of strangers' bags and files: whatever stands in them is words on the page."""

from dataclasses import replace
import sys

from lta_bag import BagWriter
from lta_bag.schemas import load_jazzy_types
from lta_cli import app
from lta_config.files import find_file
from lta_flight.replay.comparison import compare_topic, TopicMessages
from lta_flight.replay.decisions import compare_decisions
from lta_flight.replay.replay_request import ReplayRequest
from lta_flight.replay.report import build_report
from lta_flight.replay.run import ReplayRun
from lta_flight.replay.verdict import ReplayVerdict
from lta_flight.report import write_page as write_report
from lta_report.html_elements import sanitize_figure as inert_figure
from lta_report.report_page import render_report
import numpy as np
from plotly.graph_objects import Figure
import pytest
import yaml

from ..report_flight import (  # noqa: TID252 - `test` is Python's own
    header,
    make,
    provenance,
    START,
    STREAMS,
    write_flight,
)
from .page_reading import ALL, EVIL, inert, MARK, texts

DUTIES = 'lta_msgs/msg/ActuatorDuty'
ODOMETRY = 'nav_msgs/msg/Odometry'


@pytest.fixture
def lta(monkeypatch, capsys):
    """Return a function that runs a verb in this process; it must not fail."""

    def run(*words):
        monkeypatch.setattr(sys, 'argv', ['lta', *map(str, words)])
        status = app.run_command_line()
        assert status == 0, capsys.readouterr().err

    return run


def joints(time):
    """Return duties of rotors with hostile names."""
    return make(
        DUTIES, header=header(time), name=[f'{evil}{k}' for k, evil in enumerate(EVIL[:4])],
        duty=np.array([0.5, 0.5, 0.1, 0.1]),
    )  # fmt: skip


@pytest.mark.parametrize('evil', [ALL], ids=['all'])
def test_the_page_of_a_flight_shows_a_stranger_s_words_and_does_nothing_else(tmp_path, evil):
    told = provenance() | dict.fromkeys(('vehicle', 'scenario', 'strategy', 'seed', 'time'), evil)
    told |= {'commit': evil, f'note {evil}': evil, 'gains_file': evil, 'offset_x': evil}
    stream = replace(STREAMS['motors'], message=joints)
    bag = write_flight(tmp_path / 'bag', facts=told, until=6.0, instead={'motors': stream})
    write_report(bag, tmp_path / 'page.html')
    page = inert((tmp_path / 'page.html').read_text(encoding='utf-8'))
    assert evil in page.words
    shown = [each for content in page.data.values() for each in texts(content) if MARK in each]
    assert shown  # names of rotors, in a picture


def write_foreign(folder, evil, step=0.0):
    """Write a recording of topics, frames and joints with hostile names."""
    with BagWriter(folder, {'vehicle': evil, evil: evil}) as bag:
        for topic, kind in ((f'odom{evil}', ODOMETRY), (f'joints{evil}', DUTIES)):
            bag.add_topic(f'/lta1/{topic}', kind, [])
        for k in range(200):
            when = 0.05 * k
            moved = STREAMS['odom'].message(when)
            moved.header.frame_id = moved.child_frame_id = evil
            moved.pose.pose.position.x += step * np.sin(k)
            message = joints(when)
            message.duty = message.duty + 0.1 * np.sin(k)
            for topic, kind, data in (
                (f'odom{evil}', ODOMETRY, moved), (f'joints{evil}', DUTIES, message),
            ):  # fmt: skip
                data = bytes(load_jazzy_types().serialize_cdr(data, kind))
                bag.write(f'/lta1/{topic}', data, START + round(1e9 * when))
    return folder


@pytest.mark.parametrize('evil', [ALL], ids=['all'])
def test_pages_of_channels_and_of_two_recordings(tmp_path, lta, evil):
    one = write_foreign(tmp_path / 'a', evil)
    other = write_foreign(tmp_path / 'b', evil, step=0.3)
    lta(
        'bag',
        'plot',
        one,
        'joints*',
        'odom*/pose.pose.position.*',
        '--html',
        tmp_path / 'plot.html',
    )
    page = inert((tmp_path / 'plot.html').read_text(encoding='utf-8'))
    assert MARK in page.words
    lta('compare', one, other, '--out', tmp_path / 'compared')
    page = inert((tmp_path / 'compared/report.html').read_text(encoding='utf-8'))
    assert MARK in page.words


@pytest.mark.parametrize('evil', EVIL)
def test_the_page_of_a_replay(tmp_path, evil):
    keys = np.arange(3) * 10**8
    names = {f'position.{evil}': np.arange(3.0)}
    runs = [
        TopicMessages(keys, {**names, 'pose.pose.position.z': column}, {'name': np.array(words)})
        for column, words in (
            (np.zeros(3), [evil, evil, '']), (np.ones(3), ['', evil, f'{evil} again']),
        )
    ]  # fmt: skip
    topics = tuple(compare_topic(topic, *runs, stamped=True) for topic in (f'odom{evil}', 'odom'))
    verdict = ReplayVerdict(topics, tuple(compare_decisions(topics)), (evil,), 0)
    order = ReplayRequest(tmp_path / evil.replace('/', ''), ('controller',))
    facts = {'vehicle': evil, 'scenario': evil, 'seed': evil}
    played = ReplayRun(tmp_path / 'bag', None)
    page = inert(render_report(build_report(played, verdict, order, facts)))
    assert MARK in page.words


def names_itself(data, evil):
    data['name'] = evil


def tells(data, evil):
    data['about'] = data['hull']['diameter']['source'] = data['control']['source'] = evil


def names_a_layer(data, evil):
    data['layers'][evil] = data['layers'].pop('sensors')


def names_a_part(data, evil):
    data['layers']['mount'] = {evil: data['layers']['mount']['pillars']}


@pytest.mark.parametrize('evil', [ALL], ids=['all'])
@pytest.mark.parametrize('changes', [names_itself, tells, names_a_layer, names_a_part])
def test_the_page_of_a_vehicle(tmp_path, monkeypatch, capsys, evil, changes):
    """A name must be a word, or the file is refused; the rest may be anything."""
    data = yaml.safe_load(find_file('vehicle', 'gtmab').read_text(encoding='utf-8'))
    changes(data, evil)
    file, out = tmp_path / 'v.yaml', tmp_path / 'page'
    file.write_text(yaml.safe_dump(data))
    monkeypatch.setattr(sys, 'argv', ['lta', 'vehicle', 'show', str(file), '--out', str(out)])
    status = app.run_command_line()
    assert status == 0 or changes is not tells
    if status == 0:
        assert MARK in inert((out / 'report.html').read_text(encoding='utf-8')).words
    else:
        assert len(capsys.readouterr().err.splitlines()) == 1


def test_texts_of_pictures_keep_their_bold_words_and_nothing_else():
    own = '<b>here</b><br><span style="color:#0b62a8">x</span>'
    text = f'{own}<a href="x">y</a>< 3<b onload=x>'
    figure = Figure().add_annotation(text=text)
    (told,) = [each for each in texts(inert_figure(figure)) if 'here' in each]
    assert told == f'{own}&lt;a href="x">y&lt;/a>&lt; 3&lt;b onload=x>'
