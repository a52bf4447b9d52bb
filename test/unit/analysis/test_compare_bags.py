"""Comparing bags: offsets, frames, faults and partings that are known by hand."""

import itertools
import json
from pathlib import Path
import sys

from lta_analysis import app
from lta_analysis.bag import open_flight
from lta_analysis.bag.channels import Channel
from lta_analysis.compare.comparison import Asked, compare, compare_flights
from lta_analysis.compare.pairs import wanted_pairs
from lta_analysis.compare.side import side_from
from lta_analysis.compare.words import fault_words, verdict
from lta_analysis.foreign.progress import ImportProgress
from lta_analysis.foreign.run import import_all, Order
from lta_bridge.bag import BagWriter
from lta_bridge.bag.schemas import jazzy
from lta_config.errors import BadInput
import numpy as np
import pytest
from rich.console import Console

from .compare_flight import motion, stamped, UNIX, write_motion
from .report_flight import make, pose, write_flight

ODOMETRY = 'nav_msgs/msg/Odometry'
X, Z = 'odom/pose.pose.position.x', 'odom/pose.pose.position.z'
YAW = 'odom/pose.pose.orientation.yaw'


@pytest.fixture
def two(tmp_path):
    """Return a function that compares two recordings of the motion."""
    count = itertools.count()

    def make(first=None, second=None, **asked):
        bags = [tmp_path / f'{label}{next(count)}' for label in 'ab']
        for bag, how in zip(bags, (first or {}, second or {}), strict=True):
            write_motion(bag, **how)
        return compare_flights(*map(open_flight, bags), Asked(**asked))

    return make


def channel(found, name):
    return next(each for each in found.channels if each.name == name)


NOISY = {'noise': 0.01, 'seed': 1}
OTHER = {'noise': 0.01, 'seed': 2, 'rate': 30.0, 'phase': 0.003}


def test_a_tracker_and_a_recorder_aboard_are_laid_on_each_other(two):
    turned = {'turn': 0.6, 'shift': (3.0, -1.0, 0.25), 'frame': 'tracker'}
    found = two(NOISY, OTHER | {'offset': 0.1234} | turned)
    timing = found.timing
    assert (timing.how, timing.on_stamps) == ('clock', True)
    assert abs(timing.offset - 0.1234) < 4 * timing.sigma < 0.02
    (frame,) = found.frames
    assert frame.applied
    assert frame.fit.yaw == pytest.approx(-0.6, abs=0.003)
    assert frame.fit.z == pytest.approx(-0.25, abs=0.003)
    assert frame.fit.after < 0.03
    for each in found.channels:
        assert each.verdict == 'together', each.name
        if each.name.startswith('odom/pose.pose.position'):
            # The slower is B; A's noise between two instants is a little smoothed.
            assert 0.010 < each.measures.rms < 0.0145
    assert found.verdict == 'same'
    assert verdict(found).startswith('The same within their noise')


def test_clocks_that_share_nothing_count_from_each_start(two):
    found = two(NOISY, OTHER | {'start': 1_000_000_000, 'offset': 0.4})
    assert (found.timing.how, found.timing.on_stamps) == ('clock', False)
    # B's own time begins at its first message, which is 3 ms into the motion.
    assert found.timing.offset == pytest.approx(-0.003, abs=4 * found.timing.sigma)


def test_a_frame_of_the_same_name_is_fitted_where_one_run_shows_that_it_differs(two):
    found = two(NOISY, OTHER | {'offset': 0.1234, 'turn': 0.6})
    assert found.frames[0].applied
    given = two(NOISY, OTHER | {'offset': 0.1234, 'turn': 0.6}, frames='given')
    assert not given.frames[0].applied
    assert channel(given, YAW).measures.bias == pytest.approx(0.6, abs=0.01)
    assert channel(given, YAW).parting.at is not None


def test_a_step_is_found_as_the_parting_and_comes_first(two):
    step = {'step': (20.0, 0.3)}
    found = two(NOISY, OTHER | {'offset': 0.1234} | step)
    worst = found.channels[0]
    assert (worst.name, worst.verdict) == (Z, 'parted')
    assert worst.parting.at == pytest.approx(20.0, abs=0.05)
    assert found.verdict == 'different'
    assert 'at 20.0' in verdict(found)
    assert 'altitude of odom' in verdict(found)


def test_a_tolerance_takes_the_place_of_the_noise(two):
    step = OTHER | {'offset': 0.1234, 'step': (20.0, 0.3)}
    wide = two(NOISY, step, tolerances={'odom/*position*': 0.5})
    assert channel(wide, Z).parting.band == 0.5
    assert wide.verdict == 'same'
    with pytest.raises(BadInput, match=r"No channel that both flights have is called 'nose'"):
        two(NOISY, step, tolerances={'nose': 0.5})


def test_an_offset_by_hand_is_taken_as_it_is(two):
    found = two(NOISY, OTHER | {'offset': 0.1234}, offset=0.2)
    assert (found.timing.how, found.timing.offset, found.timing.sigma) == ('given', 0.2, 0.0)
    lag = channel(found, Z).peak.lag
    assert lag == pytest.approx(0.1234 - 0.2, abs=0.01)


def test_the_same_stamps_are_one_clock(two):
    found = two(NOISY, NOISY | {'seed': 3})
    assert (found.timing.how, found.timing.offset) == ('none', 0.0)
    assert 'same stamps' in found.timing.reason


def test_a_bag_beside_itself_is_identical(two):
    found = two(NOISY, NOISY)
    assert found.identical
    assert found.verdict == 'identical'
    assert found.identical_topics == ('odom',)
    assert verdict(found) == 'Identical: the one topic is the same byte for byte.'
    assert all(each.measures is None or each.measures.rms == 0.0 for each in found.channels)


def test_gaps_are_named_and_never_bridged(two):
    found = two(NOISY, OTHER | {'offset': 0.1234, 'drop': (10.0, 15.0)})
    (gap,) = found.faults_b['odom'].gaps
    assert gap.end - gap.begin == pytest.approx(5.0, abs=0.07)
    assert found.faults_a['odom'].clean
    both = channel(found, Z).both
    inside = (both.time > 10.1) & (both.time < 14.9)
    assert not np.isfinite(both.difference[inside]).any()
    assert found.verdict == 'same'


def test_an_estimate_is_compared_with_the_truth_of_its_own_bag(tmp_path):
    bag = write_flight(tmp_path / 'bag')
    flights = open_flight(bag), open_flight(bag)
    found = compare_flights(*flights, Asked(pairs=('odom=ground_truth/odom',)))
    assert found.timing.how == 'none'
    # By hand: the estimate is 2 cm too high and its own frame lies at the start of the flight.
    altitude = channel(found, Z)
    assert altitude.other == 'ground_truth/odom/pose.pose.position.z'
    assert altitude.measures.bias == pytest.approx(-0.02, abs=1e-9)
    laid = compare_flights(*flights, Asked(pairs=('odom=ground_truth/odom',), frames='fit'))
    fit = laid.frames[0].fit
    assert fit.yaw == pytest.approx(0.3, abs=1e-6)
    assert (fit.x, fit.y) == pytest.approx((3.5 * np.cos(0.3), 3.5 * np.sin(0.3)), abs=1e-6)
    assert fit.z == pytest.approx(0.02, abs=1e-9)
    # Its yaw runs away by 0.01 rad a second from 4 s on; the flight ends at 17 s.
    assert channel(laid, YAW).both.difference[-1] == pytest.approx(-0.13, abs=1e-6)
    assert channel(laid, YAW).parting.at == pytest.approx(4.0, abs=0.5)


def test_channels_of_other_names_are_paired_by_how_they_end(tmp_path):
    a = side_from([Channel('pose/pose.position.x', 'm', np.arange(50.0), np.arange(50.0))], 'A')
    b = side_from([Channel('odom/pose.pose.position.x', 'm', np.arange(50.0), np.ones(50))], 'B')
    wanted = wanted_pairs(['pose=odom'], (), list(a.topics), list(b.topics))
    found = compare(a, b, wanted, Asked())
    assert found.channels[0].other == 'odom/pose.pose.position.x'


def test_other_units_are_not_compared():
    t = np.arange(50.0)
    a = side_from([Channel('range/range', 'm', t, t), Channel('range/x', 'm', t, t)], 'A')
    b = side_from([Channel('range/range', 'mm', t, t), Channel('range/x', 'm', t, t)], 'B')
    wanted = wanted_pairs((), (), list(a.topics), list(b.topics))
    found = compare(a, b, wanted, Asked())
    assert [each.name for each in found.channels] == ['range/x']
    assert "'range/range' is in m in A and in mm in B; not compared." in found.remarks


def run(monkeypatch, *words):
    monkeypatch.setattr(sys, 'argv', ['lta', 'compare', *map(str, words)])
    return app.status()


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
    page = (out / 'compare.html').read_text(encoding='utf-8')
    assert 'altitude of odom' in page
    assert 'http' not in page.split('<script>')[0]
    again = ['--no-page', '--topic', 'odom']
    assert run(monkeypatch, a, b, '--out', tmp_path / '1', '--same', *again) == 1
    wide = ['--tolerance', 'odom/*=40 cm', '--offset', '123.4ms']
    assert run(monkeypatch, a, b, '--out', tmp_path / '2', '--same', *again, *wide) == 0
    assert not (tmp_path / '2' / 'compare.html').exists()
    assert run(monkeypatch, a, a, '--out', tmp_path / '3', '--same', '--no-page') == 0


@pytest.mark.parametrize(
    ('words', 'sentence'),
    [
        (['--pair', 'odom'], "'odom' is no pair; write A's topic"),
        (['--pair', 'odom=nose'], "B has no topic or channel 'nose'; its topics: odom."),
        (['--pair', 'odom/nose=odom/nose'], "Topic 'odom' has no channel 'nose'; it has: pose"),
        (['--topic', 'motors'], "Topic 'motors' is not compared; those that are: odom."),
        (['--offset', 'soon'], "--offset is 'soon'; give a number"),
        (['--offset', '3 m'], "--offset is '3 m'; give a number"),
        (['--offset', '500'], 'The flights have no time in common'),
        (['--tolerance', 'odom'], "'odom' is no tolerance; write CHANNEL=VALUE"),
        (['--tolerance', f'{Z}=-1'], f'The tolerance of {Z} is -1; give zero or more.'),
        (['--tolerance', f'{Z}=5 deg'], f"The tolerance of {Z} is '5 deg', but {Z} is in m;"),
        (['--robot', 'lta7'], "Unknown robot 'lta7'; known: lta1"),
        (['--align', 'motion'], 'The flights show no start of motion or commands'),
    ],
)
def test_bad_input_is_one_sentence(words, sentence, tmp_path, monkeypatch, capsys):
    bag = write_motion(tmp_path / 'a', until=5.0)
    assert run(monkeypatch, bag, bag, '--out', tmp_path / 'out', *words) == 2
    told = capsys.readouterr().err
    assert told.startswith(sentence)
    assert told.count('\n') == 1
    assert not (tmp_path / 'out').exists()


def test_flights_with_nothing_in_common_say_what_each_has(tmp_path):
    a = write_motion(tmp_path / 'a', until=5.0)
    b = write_motion(tmp_path / 'b', until=5.0, topic='tracker')
    with pytest.raises(BadInput, match=r'no topic in common \(A: odom; B: tracker\); say which'):
        compare_flights(open_flight(a), open_flight(b), Asked())
    found = compare_flights(open_flight(a), open_flight(b), Asked(pairs=('odom=tracker',)))
    assert found.channels[0].verdict == 'identical'
    assert found.a.start == UNIX


def test_doubled_and_backward_messages_are_counted(record):
    def at(k):
        covered = make('geometry_msgs/msg/PoseWithCovariance', pose=pose(0.01 * k, 0.0, 1.0, 0.0))
        time = 1_000_000_000 + 10_000_000 * k
        message = make(ODOMETRY, header=stamped(time, 'map'), pose=covered)
        return '/lta1/odom', ODOMETRY, message, time

    order = [*range(50), 49, *range(50, 80), 75, *range(80, 100)]
    a = open_flight(record([at(k) for k in range(100)], 'a'))
    b = open_flight(record([at(k) for k in order], 'b'))
    found = compare_flights(a, b, Asked())
    wrong = found.faults_b['odom']
    assert (wrong.count, wrong.same_stamp, wrong.repeated) == (102, 2, 1)
    assert wrong.backwards_count == 1
    assert tuple(wrong.backwards[0]) == pytest.approx((0.79, 0.75))
    assert found.faults_a['odom'].clean
    assert not found.identical
    assert found.same
    told = fault_words(wrong)
    assert '2 messages at the time of another, 1 of them byte for byte' in told
    assert 'time runs backwards 1 time, first from 0.790 to 0.750 s' in told


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
                    f'/{robot}/odom', bytes(jazzy().serialize_cdr(message, ODOMETRY)), time
                )
    out = ['--out', tmp_path / 'out', '--no-page', '--json']
    assert run(monkeypatch, bag, bag, *out) == 2
    told = capsys.readouterr().err
    assert told.startswith(f"A: '{bag}' holds several robots (lta1, lta2);")
    assert told.count('\n') == 1
    assert run(monkeypatch, bag, bag, '--robot', 'lta1:lta2', *out) == 0
    content = json.loads(capsys.readouterr().out)
    assert [content[side]['robot'] for side in 'ab'] == ['lta1', 'lta2']
    x = next(each for each in content['channels'] if each['name'] == X)
    assert x['measures']['bias'] == pytest.approx(0.5)
    assert x['parting']['at'] == 0.0


def test_topics_that_one_flight_lacks_are_listed(two):
    found = two(NOISY | {'extra': ('motors',)}, OTHER)
    assert (found.only_a, found.only_b) == (('motors',), ())
    assert not found.identical
    assert {each.name.split('/')[0] for each in found.channels} == {'odom'}


def run_of(start, seed, label, clock):
    """Return a flight that rests until its command, then wanders as its air has it."""
    t = np.arange(0.0, 30.0, 0.01)
    since = np.maximum(t - start, 0.0)
    chance = np.random.default_rng(seed)
    climb = 0.3 * np.minimum(since, 1.0) + 0.4 * np.sin(since * 2.0 + seed) * (since > 0.0)
    noise = 0.003 * chance.normal(size=(2, len(t)))
    speed = since**0.5 * np.cos(seed * t) + noise[1]
    return side_from(
        [
            Channel('motors/effort.left', '1', t, np.where(t >= start, 0.4 + 0.05 * seed, 0.0)),
            Channel('odom/pose.pose.position.z', 'm', t, climb + noise[0]),
            Channel('odom/twist.twist.linear.x', 'm/s', t, speed),
        ],
        label,
        clock,
    )


def test_separate_runs_are_laid_on_each_other_by_their_commands():
    a, b = run_of(4.0, 1, 'A', 0), run_of(5.5, 2, 'B', UNIX)
    wanted = wanted_pairs((), (), list(a.topics), list(b.topics))
    found = compare(a, b, wanted, Asked())
    assert (found.timing.how, found.timing.on_stamps) == ('motion', False)
    assert found.timing.offset == pytest.approx(1.5, abs=0.011)
    assert 'separate runs' in found.timing.reason
    assert found.span == pytest.approx((0.0, 28.49), abs=0.02)
    duty = channel(found, 'motors/effort.left')
    assert duty.parting.at == pytest.approx(4.0, abs=0.02)
    assert duty.measures.greatest == pytest.approx(0.05)
    alone = compare(a, b, wanted, Asked(align='none'))
    assert (alone.timing.how, alone.timing.offset) == ('none', 0.0)


def imported_csv(tmp_path, name, until, phase, time='time: {rate: 50 Hz}'):
    """Import hand-made motion as a text, whose first row is `phase` into the motion."""
    t = phase + np.arange(round(50 * until)) / 50.0
    chance = np.random.default_rng(len(name))
    rows = np.column_stack([t - phase, motion(t)[:, :3] + 0.001 * chance.normal(size=(len(t), 3))])
    source, mapping = tmp_path / f'{name}.csv', tmp_path / 'm.yaml'
    np.savetxt(source, rows, delimiter=',', header='t,x,y,z', comments='', fmt='%.9f')
    mapping.write_text(
        f'schema: 1\nname: m\nabout: a\nformat: csv\n{time}\n'
        'topics:\n  - {topic: odom, position: {columns: [x, y, z], unit: m}}\n'
    )
    with ImportProgress(Console(quiet=True), 1) as progress:
        (done,) = import_all(Order([source], str(mapping)), tmp_path / name, progress)
    return open_flight(Path(done.bag))


@pytest.mark.parametrize('time', ['time: {rate: 50 Hz}', 'time: {column: t}'])
def test_rows_that_are_counted_alike_are_no_common_clock(tmp_path, time):
    # One motion; the second text begins 0.4 s later in it, and both count from zero.
    a = imported_csv(tmp_path, 'one', 40.0, 0.0, time)
    b = imported_csv(tmp_path, 'other', 38.0, 0.4, time)
    found = compare_flights(a, b, Asked())
    assert found.timing.how == 'clock'
    assert found.timing.offset == pytest.approx(-0.4, abs=max(0.005, 4 * found.timing.sigma))
    assert found.verdict == 'same'
    # One text imported twice is one clock.
    assert compare_flights(a, a, Asked()).timing.reason.startswith('Both carry the same stamps')
    assert compare_flights(a, b, Asked(align='none')).timing.offset == 0.0


def test_two_topics_of_one_bag_are_no_two_flights(tmp_path):
    bag = tmp_path / 'bag'
    write_motion(bag, topic='odom', extra=())
    flight = open_flight(bag)
    pairs = ('odom/pose.pose.position.x=odom/pose.pose.position.y',)
    found = compare_flights(flight, flight, Asked(pairs=pairs))
    assert verdict(found).startswith('odom and odom are apart from the start, in x of odom')


def test_the_sentence_names_what_the_ranking_has_first(tmp_path):
    t = np.arange(0.0, 20.0, 0.02)
    chance = np.random.default_rng(0)

    def side(label, faster, slip):
        noise = 1e-4 * chance.normal(size=(3, len(t)))
        lines = {
            'odom/pose.pose.position.x': np.sin(t) + noise[0],
            'odom/twist.twist.linear.x': np.cos(t) + noise[1] + faster * (t > 5.0),
            'odom/twist.twist.linear.y': 0.1 * np.cos(t) + noise[2] + slip * (t > 8.0),
        }
        return side_from([Channel(name, 'm', t, line) for name, line in lines.items()], label)

    a, b = side('A', 0.0, 0.0), side('B', 0.01, 0.2)
    found = compare(a, b, wanted_pairs((), (), ['odom'], ['odom']), Asked(align='none'))
    assert found.channels[0].name == 'odom/twist.twist.linear.y'
    assert verdict(found).startswith('The flights part at 5.02 s, first in forward speed of odom')
    assert 'and most in sideways speed of odom' in verdict(found)


def test_a_bag_is_gone_through_a_few_times_whatever_it_holds(tmp_path, monkeypatch):
    write_flight(tmp_path / 'bag')
    flight = open_flight(tmp_path / 'bag')
    passes = []
    read = type(flight.bag).records

    def counted(bag, topics=None, at=None):
        passes.append(topics)
        return read(bag, topics, at)

    monkeypatch.setattr(type(flight.bag), 'records', counted)
    found = compare_flights(flight, flight, Asked())
    assert found.verdict == 'identical'
    single = [
        name for name in flight.topics
        if 'Image' in flight.type_of(name) or 'PointCloud' in flight.type_of(name)
    ]  # fmt: skip
    assert len(flight.topics) > 5
    # All bytes once, all numbers once, and what has blocks or points by itself.
    assert len(passes) == 2 + len(single)
