# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""What of a recording can be used, what is cut out, and what is refused."""

from dataclasses import replace

from lta_config.errors import BadInput
from lta_discovery.flights.bags import read_bags
from lta_discovery.flights.usable_flights import select_usable_flights
from lta_model.vehicle import load_vehicle
import numpy as np
import pytest

TRUTH = 'ground_truth/odom/'


@pytest.fixture(scope='module')
def gtmab():
    return load_vehicle('gtmab')


@pytest.fixture(scope='module')
def flights(hidden_bags):
    a, b, c = hidden_bags
    return read_bags({'train': [a], 'confirm': [b], 'holdout': [c]})


def _changed(flight, change, *topics):
    """Return a flight with the channels of some topics changed; None leaves one out."""
    channels = {}
    for name, channel in flight.recording.channels.items():
        new = change(channel) if name.startswith(topics) else channel
        if new is not None:
            channels[name] = new
    return replace(flight, recording=replace(flight.recording, channels=channels, arrivals={}))


def _only(channel, keep):
    """Return a channel with some of its messages."""
    return replace(channel, time=channel.time[keep], values=channel.values[keep])


def _frozen(channel):
    """Return a channel that repeats itself for three seconds."""
    values = channel.values.copy()
    inside = (channel.time > 12.0) & (channel.time < 15.0)
    values[inside] = values[inside][0]
    return replace(channel, values=values)


def _believed(flights, gtmab, *changed):
    return select_usable_flights([*changed, *flights[len(changed) :]], gtmab)


def test_whole_flights_are_used_whole_and_told_to_be_simulated(flights, gtmab):
    found = select_usable_flights(flights, gtmab)
    assert [(name, role) for name, role, _ in found.flights] == [
        ('A', 'train'), ('B', 'confirm'), ('C', 'holdout'),
    ]  # fmt: skip
    assert [cut.reason for cut in found.cuts] == [
        'the vehicle stands on the floor or takes off.'
    ] * 3
    assert found.warnings[0] == (
        'A, B, C are marked as simulated: the results do not apply to a real vehicle.'
    )
    for _, _, flight in found.flights:
        assert flight.usable[flight.time > 5.0].all()  # until then it stands, and takes off
        assert np.isfinite(flight.noise).all()


def test_a_frozen_tracker_is_cut_out_of_the_flight(flights, gtmab):
    found = _believed(flights, gtmab, _changed(flights[0], _frozen, TRUTH))
    flight = found.flights[0][2]
    inside = (flight.time > 12.2) & (flight.time < 14.8)
    assert not flight.usable[inside].any()
    assert flight.usable[(flight.time > 17.0) & (flight.time < 28.0)].all()
    assert any(cut.flight == 'A' and cut.channel.startswith(TRUTH) for cut in found.cuts)


def test_a_frozen_gyroscope_costs_its_readings_only(flights, gtmab):
    one = _changed(flights[0], _frozen, 'imu/angular_velocity')
    flight = _believed(flights, gtmab, one).flights[0][2]
    inside = (flight.time > 12.2) & (flight.time < 14.8)
    assert flight.usable[inside].all()
    assert np.isnan(flight.readings[inside, :3]).all()
    assert np.isfinite(flight.readings[inside, 3:6]).all()


def test_a_range_in_the_wrong_unit_is_done_without(flights, gtmab):
    one = _changed(flights[0], lambda c: replace(c, values=1e3 * c.values), 'range/')
    found = _believed(flights, gtmab, one)
    assert np.isinf(found.flights[0][2].noise[12])
    assert any('range' in word and 'is not used' in word for word in found.warnings)


def test_a_range_finder_beyond_its_range_is_left_out_there(flights, gtmab):
    noise = 0.05 * np.random.default_rng(1).standard_normal(10_000)

    def loud(channel):
        inside = (channel.time > 12.0) & (channel.time < 16.0)
        more = np.where(inside, noise[: len(channel.time)], 0.0)
        return replace(channel, values=channel.values + more)

    found = _believed(flights, gtmab, _changed(flights[0], loud, 'range/range'))
    flight = found.flights[0][2]
    inside = (flight.time > 13.0) & (flight.time < 15.0)
    assert np.isnan(flight.readings[inside, 6]).all()
    assert flight.usable[inside].all()
    quiet = (flight.time > 18.0) & (flight.time < 28.0)
    assert np.isfinite(flight.readings[quiet, 6]).all()
    # Before, the flight takes off
    assert {cut.channel for cut in found.cuts if cut.from_s > 5.0} == {'range'}


def test_gaps_of_the_tracker_are_told(flights, gtmab):
    def gaps(channel):
        return _only(channel, ~((channel.time > 8.0) & (channel.time < 12.0)))

    found = _believed(flights, gtmab, _changed(flights[0], gaps, TRUTH))
    assert any('has no pose for 13 % of the flight, in 1 gap' in word for word in found.warnings)
    assert not found.flights[0][2].usable[(found.flights[0][2].time > 8.2)][:80].any()


def test_what_comes_after_a_jump_of_the_clock_is_not_used(flights, gtmab):
    one = _changed(
        flights[0],
        lambda c: replace(c, time=np.where(c.time > 28.5, c.time - 3.0, c.time)),
        TRUTH,
    )
    flight = _believed(flights, gtmab, one).flights[0][2]
    assert not flight.usable[flight.time > 25.5].any()
    assert flight.usable[(flight.time > 5.0) & (flight.time < 22.0)].all()


def _still(level):
    return lambda channel: replace(channel, values=np.full_like(channel.values, level))


def test_a_moving_mass_that_moves_is_a_command(flights, gtmab):
    """Judged over all training flights together: here another place in each."""
    standing = [_changed(one, _still(0.3), 'motors/effort') for one in flights[:2]]
    standing = [replace(one, role='train') for one in standing]
    for k, one in enumerate(standing):
        told = one.recording.channels['motors/effort.up_left']
        places = {
            f'motors/position.moving_mass_{axis}': replace(
                told, values=np.full_like(told.values, 0.05 + 0.01 * k)
            )
            for axis in 'xyz'
        }
        channels = {**one.recording.channels, **places}
        standing[k] = replace(one, recording=replace(one.recording, channels=channels))
    found = select_usable_flights([*standing, flights[2]], gtmab)
    assert len(found.flights) == 3


def test_commands_in_newtons_are_read_as_duties(flights, gtmab):
    """As an import says: at 0.5 of a duty 0.0915 / 4 + 0.0677 / 2 N."""
    newtons = 'topics: [{topic: motors, actuators: {up_left: {effort: {column: a, unit: N}}}}]'
    full = 0.0915 / 4.0 + 0.0677 / 2.0
    one = _changed(flights[1], _still(full), 'motors/effort')
    told = {**one.recording.provenance, 'mapping_file': newtons}
    one = replace(one, recording=replace(one.recording, provenance=told))
    found = select_usable_flights([flights[0], one, flights[2]], gtmab)
    np.testing.assert_allclose(found.flights[1][2].commands.values, 0.5, rtol=2e-3)


def test_an_absurd_pose_costs_itself_and_says_nothing_else(flights, gtmab):
    def spoil(channel):
        values = channel.values.copy()
        values[1000] = 1e300
        return replace(channel, values=values)

    place = f'{TRUTH}pose.pose.position'
    found = _believed(flights, gtmab, _changed(flights[0], spoil, place))
    assert [name for name, *_ in found.flights] == ['A', 'B', 'C']


def _lower(channel):
    return replace(channel, values=channel.values - 0.6)


def test_a_flight_below_the_floor_is_raised_and_said(flights, gtmab):
    """The zero of a tracker is where it was calibrated, such as on a table."""
    place = f'{TRUTH}pose.pose.position.z'
    found = _believed(flights, gtmab, _changed(flights[0], _lower, place))
    (said,) = [words for words in found.warnings if 'below the floor' in words]
    assert said.startswith('A: the hull centre is up to 0.')
    before = select_usable_flights(flights, gtmab).flights[0][2]
    raised = found.flights[0][2].position[:, 2] - before.position[:, 2]
    np.testing.assert_allclose(raised, raised[-1])
    assert abs(raised[-1]) < 0.02  # the flight begins on the floor, so its lowest pose is there


def test_a_flight_whose_lowest_pose_may_be_in_the_air_is_raised_clear_of_the_floor(flights, gtmab):
    """Without a range reading; at the height of standing, the model would touch its floor."""
    blind = {
        name: one for name, one in flights[0].recording.channels.items() if 'range' not in name
    }
    first = replace(flights[0], recording=replace(flights[0].recording, channels=blind))
    high, low = (
        select_usable_flights([one, *flights[1:]], gtmab).flights[0][2]
        for one in (first, _changed(first, _lower, f'{TRUTH}pose.pose.position.z'))
    )
    # Standing poses stay unused
    np.testing.assert_array_equal(low.usable, high.usable)
    np.testing.assert_allclose(low.position[:, 2] - high.position[:, 2], 0.5, atol=0.02)


def _resting(channel):
    """Return a channel of a tracker that sees a vehicle at rest."""
    draw = np.random.default_rng(len(channel.values))
    noise = 1e-3 * draw.standard_normal(len(channel.values))
    return replace(channel, values=channel.values[-1] + noise)


@pytest.mark.parametrize(
    ('sentence', 'changes'),
    [
        ('A: the pose was recorded at 5 Hz', {TRUTH: lambda c: _only(c, slice(None, None, 20))}),
        ('A.* has no commands', {'motors/': lambda _: None}),
        ('A.* has no measured pose', {TRUTH: lambda _: None}),
        ('A: no pose is valid', {TRUTH: _still(np.nan)}),
        ('A: no pose is valid', {TRUTH: _still(np.inf)}),
        ('commands are constant', {'motors/effort': _still(0.3), f'{TRUTH}pose': _resting}),
        (r'Only 1\d s of .* --train are usable', {TRUTH: lambda c: _only(c, c.time < 15.0)}),
    ],
)
def test_what_cannot_be_used_is_refused(flights, gtmab, sentence, changes):
    one = flights[0]
    for topics, change in changes.items():
        one = _changed(one, change, topics)
    with pytest.raises(BadInput, match=sentence):
        _believed(flights, gtmab, one)


def test_constant_commands_are_fine_where_the_vehicle_moves(flights, gtmab):
    one = _changed(flights[0], _still(0.3), 'motors/effort')
    assert [name for name, *_ in _believed(flights, gtmab, one).flights] == ['A', 'B', 'C']


def test_an_unusable_flight_is_left_out_and_the_study_goes_on(flights, gtmab):
    one = _changed(flights[0], lambda _: None, TRUTH)
    two, three = (replace(flight, role='train') for flight in flights[1:])
    # The other two are 19.9 s long together
    found = select_usable_flights([one, two, three], gtmab, 15.0)
    assert [name for name, *_ in found.flights] == ['B', 'C']
    assert any(
        word.startswith('A: ') and 'left out' in word and 'no measured pose' in word
        for word in found.warnings
    )


def test_single_impossible_duties_are_clipped_and_counted(flights, gtmab):
    def spiked(channel):
        values = channel.values.copy()
        values[[500, 900]] = 5.0
        return replace(channel, values=values)

    found = _believed(flights, gtmab, _changed(flights[0], spiked, 'motors/effort.up_left'))
    assert any('A: 2 commands beyond what the actuators can do' in w for w in found.warnings)
    assert found.flights[0][2].commands.values.max() <= 1.0
    assert not any(cut.channel.startswith('motors') for cut in found.cuts)


def test_commands_may_be_constant_in_each_flight_if_they_differ_between_them(flights, gtmab):
    one = _changed(flights[0], _still(0.3), 'motors/effort')
    two = _changed(flights[1], _still(0.5), 'motors/effort')
    found = select_usable_flights(
        [one, replace(two, role='train'), replace(flights[2], role='confirm')], gtmab
    )
    assert len(found.flights) == 3


def test_rotors_at_full_duty_are_told(flights, gtmab):
    def full(channel):
        return replace(channel, values=np.where(channel.time > 8.0, 1.0, channel.values))

    found = _believed(flights, gtmab, _changed(flights[0], full, 'motors/effort'))
    assert any('all rotors are at full duty for 7' in word for word in found.warnings)


def test_one_run_in_two_roles_is_refused_however_it_was_trimmed(flights, gtmab):
    def trimmed(channel):
        late = channel.time > 3.0
        return replace(_only(channel, late), time=channel.time[late] - 3.0)

    copy = replace(_changed(flights[0], trimmed, ''), name='copy', role='confirm')
    with pytest.raises(BadInput, match=r"copy: This is the same run as 'A'.*cannot confirm it"):
        select_usable_flights([flights[0], copy], gtmab)


def test_flights_of_different_vehicles_are_refused(flights, gtmab):
    told = flights[1].recording.provenance
    other = {**told, 'vehicle_file': told['vehicle_file'].replace('name: gtmab', 'name: other')}
    strange = replace(flights[1], recording=replace(flights[1].recording, provenance=other))
    with pytest.raises(BadInput, match=r"different vehicles \('A': gtmab; 'B': other\)"):
        select_usable_flights([flights[0], strange], gtmab)


def test_flights_with_different_rotors_are_refused(flights, gtmab):
    def renamed(channel):
        return replace(channel, name=channel.name.replace('up_left', 'lift'))

    one = _changed(flights[1], renamed, 'motors/effort.up_left')
    channels = {c.name: c for c in one.recording.channels.values()}
    two = replace(one, recording=replace(one.recording, channels=channels))
    with pytest.raises(BadInput, match='command different rotors'):
        select_usable_flights([flights[0], two], gtmab)


def test_single_lost_poses_cost_themselves(flights, gtmab):
    """Every seventh pitch is not a number, as a tracker writes for a lost marker."""

    def lose(channel):
        values = channel.values.copy()
        if channel.field.endswith('orientation.pitch'):
            values[3:-3:7] = np.nan
        return replace(channel, values=values)

    one = _changed(flights[0], lose, 'ground_truth/odom')
    before = select_usable_flights(flights, gtmab).flights[0][2]
    after = _believed(flights, gtmab, one).flights[0][2]
    assert after.usable.sum() > 0.95 * before.usable.sum()


def test_a_swing_needs_no_commands(flights, gtmab):
    """A tracker alone records it; the same without a swing lacks its commands."""
    channels = flights[0].recording.channels
    start = 'ground_truth/odom/pose.pose.'
    time = np.arange(0.0, 15.0, 0.02)
    draw = np.random.default_rng(3)

    def recorded(amplitude, speed):
        pitch = amplitude * np.exp(-time / 6.0) * np.cos(2.0 * np.pi * time / 1.4)
        still = dict.fromkeys(('position.y', 'orientation.yaw', 'orientation.roll'), 0.0 * time)
        motion = {'position.x': speed * time, 'position.z': 1.5 + 0.0 * time,
                  'orientation.pitch': pitch}  # fmt: skip
        own = {
            f'{start}{name}': replace(
                channels[f'{start}{name}'],
                time=time,
                values=values + 1e-3 * draw.standard_normal(len(time)),
            )
            for name, values in (still | motion).items()
        }
        recording = replace(flights[0].recording, channels=own, arrivals={})
        return replace(flights[0], recording=recording)

    found = select_usable_flights([recorded(0.5, 0.02)], gtmab, 5.0)
    assert [name for name, _, _ in found.flights] == ['A']
    assert not found.flights[0][2].commands.values.any()
    for amplitude, speed in ((0.01, 0.02), (0.5, 0.5)):
        with pytest.raises(BadInput, match='has no commands'):
            select_usable_flights([recorded(amplitude, speed)], gtmab, 5.0)
