# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""What follows from a vehicle file that is not GT-MAB's: other parts, rotors, scales and trims."""

from lta_config.errors import BadInput
from lta_model.effects import initial_memory
from lta_model.limits import level_force
from lta_model.state import pack_state
from lta_model.vehicle import load_vehicle
from lta_sim.kernels import kernel
from lta_sim.simulated_vehicle import SIM_LAYOUT
import numpy as np
import pytest

from .changed_vehicle import build, G, given, GTMAB, refused, RHO, VOLUME


@pytest.fixture(scope='module')
def gtmab():
    return load_vehicle('gtmab', RHO)


def test_a_layer_is_swapped_by_one_edit(gtmab):
    """A board of 20 g for the two of 72.7 g at the same height: ballast, lower, takes over."""
    box = GTMAB['layers']['sensors']['light_board']
    vehicle = build(('layers.sensors', {'small_board': box | {'mass': given(20, 'g')}}))
    assert vehicle.mass == pytest.approx(gtmab.mass, rel=1e-12)
    assert vehicle.ballast_mass == pytest.approx(gtmab.ballast_mass + 0.0527)
    lower = 0.0527 * (0.395 - 0.33) / gtmab.mass
    assert vehicle.cg[2] == pytest.approx(gtmab.cg[2] - lower, rel=1e-12)


def test_the_drag_of_parts_comes_on_top_of_the_wind_tunnel():
    drag = {'coefficient': given(1.17, '1')}
    frame = 'layers.propulsion_and_control.frame.drag'  # 10 x 32 x 6 cm
    draggy, known = build((frame, drag)), build((frame, drag | {'in_aero': True}))
    plate = 0.5 * RHO * 1.17 * np.array([0.32 * 0.06, 0.10 * 0.06, 0.10 * 0.32])
    axes = ('surge', 'sway', 'heave')
    bare = build((frame, None))
    for vehicle, more in ((draggy, plate), (known, np.zeros(3)), (bare, np.zeros(3))):
        forces = [vehicle.collect_effects()['quadratic_drag'][axis] for axis in axes]
        np.testing.assert_allclose(forces, np.array((0.092, 0.092, 0.359)) + more, rtol=1e-12)
    # Its turning is damped in both cases: one strip, 32 cm along y at its place.
    for vehicle in (draggy, known):
        strip = vehicle.collect_effects()['strip_damping']
        assert [strip[name] for name in ('x_1', 'y_1', 'z_1')] == pytest.approx((0, 0, -0.345))
        assert [strip[f'half_{axis}_1'] for axis in 'xyz'] == pytest.approx((0, 0.16, 0))
        assert [strip[f'{axis}_1'] for axis in axes] == pytest.approx(plate)
        assert strip['translation'] == 0.0
    assert 'strip_damping' not in bare.collect_effects()


def test_a_rotor_without_a_column_has_that_of_its_geometry():
    """Up left at (0, 19, -34.35) cm: lifts, and rolls by its arm of 19 cm."""
    plain = build(('aero.thrust_allocation.up_left', None))
    np.testing.assert_allclose(plain.allocation[0], (0, 0, 1, 0.19, 0, 0), atol=1e-15)
    assert plain.allocation[1][2] == 0.961


@pytest.mark.parametrize('reversible', [False, True])
def test_the_torque_of_a_motor_comes_on_top_of_the_column_of_its_jet(reversible):
    """The wind tunnel's jets have no swirl: without it a multirotor in a hull could not turn."""
    torque = {'per_thrust': given(0.006, 'm'), 'spin': 'anticlockwise'}
    rotor = {**GTMAB['rotors']['up_left'], 'reversible': reversible}
    plain = build(('rotors.up_left', rotor))
    turned = build(('rotors.up_left', {**rotor, 'torque': torque}))
    for mode in ('column', 'reverse'):
        without, with_it = (getattr(each.rotors[0], mode) for each in (plain, turned))
        np.testing.assert_allclose(np.subtract(with_it, without), [0, 0, 0, 0, 0, -0.006])


def test_reversed_thrust_has_its_own_column_and_size():
    """The wind tunnel's V1 reversed: -0.252 N of 1; half as strong backwards here."""
    vehicle = build(
        ('rotors.up_left.reversible', True),
        ('rotors.up_left.thrust_curve', GTMAB['thrust_curve'] | {'reverse': given(0.0796, 'N')}),
        ('effects.motor_lag', None),
    )
    assert vehicle.reversible == (True, False, False, False)
    jets = {}
    for duty in (1.0, -1.0):
        state = pack_state((0, 0, 1.0), memory=initial_memory())
        look = kernel.effect_wrenches(state, vehicle.build_model(), (duty, 0, 0, 0))
        jets[duty] = look['rotor_thrust'] + look['rotor_envelope_interaction']
    np.testing.assert_allclose(jets[1.0], 0.1592 * np.array((0, 0.013, 0.961, 0.188, 0, 0)))
    np.testing.assert_allclose(
        jets[-1.0], -0.0796 * np.array((0, -0.23, 0.252, 0.072, 0, 0)), atol=1e-15
    )


def test_a_step_too_long_for_the_motors(gtmab):
    gtmab.check_step(0.194)
    with pytest.raises(BadInput) as caught:
        gtmab.check_step(0.25)
    assert str(caught.value) == (
        'gtmab has motors with a time constant of 72 ms, too short for a simulation time step of '
        '250 ms; use a time step of 194 ms or less.'
    )
    build(('effects.motor_lag', None), ('effects.floor_contact', None)).check_step(10.0)


def test_the_sentence_about_the_step_is_true():
    """RK4 of a lag: 0.19 s settles, 0.21 s grows (limit 2.785 tau = 0.2005 s)."""
    vehicle = build(('effects.floor_contact', None))
    for step, settles in ((0.19, True), (0.21, False)):
        start = pack_state((0, 0, 1.0), memory=initial_memory())
        state = kernel.advance(start, vehicle.build_model(), (1e-3,), np.zeros(3), step, 200)
        lagged = state[SIM_LAYOUT.remembers['motor_lag']]
        assert (abs(lagged - 1e-3) < 1e-4) == settles


def weighed(**more):
    """Return GT-MAB as weighed: 400 g, 10 cm below the hull centre."""
    return [
        ('layers', {}),
        ('energy.array.part', None),
        ('sensors.panel_position', given([0, 0, 30.2], 'cm')),
        (
            'measured',
            {
                'mass': given(400, 'g'),
                'position': given([0, 0, -10], 'cm'),
                'inertia': given([0.04, 0.04, 0.03], 'kg m2'),
                'products': given([0.001, 0.002, 0.003], 'kg m2'),
            },
        ),
        ('trim', more),
    ]


def test_a_weighed_vehicle_is_what_the_scale_says():
    """Filled until it is 2 g heavy, or as heavy as 0.3432 m3 of air leave it."""
    filled = build(*weighed(heaviness=given(2, 'g')))
    assert (filled.mass, filled.displaced_mass) == (0.4, pytest.approx(0.398, rel=1e-12))
    np.testing.assert_array_equal(filled.cg, (0, 0, -0.1))
    expected = [[0.04, 0.001, 0.002], [0.001, 0.04, 0.003], [0.002, 0.003, 0.03]]
    np.testing.assert_array_equal(filled.inertia, expected)
    free = build(*weighed(ballast='none'))
    assert free.displaced_mass == pytest.approx(VOLUME * RHO)
    assert free.heaviness == pytest.approx(0.4 - VOLUME * RHO)
    assert refused(*weighed(heaviness=given(500, 'g'))) == (
        'gtmab cannot be heavier than air by more than its own measured mass of 400.0 g; '
        'lower trim.heaviness.'
    )


def test_parts_that_fly_as_heavy_as_they_are():
    """Without ballast the 13.4 g that the trim would add are missing: 11.4 g light."""
    free = build(('trim', {'ballast': 'none'}))
    assert free.ballast_mass == 0.0
    assert 1e3 * free.heaviness == pytest.approx(319.8 - 331.23, abs=0.01)
    assert free.hover_duty == 0.0


def test_a_moving_mass_counts_where_it_rests(gtmab):
    """50 g at (10, 0, -40) cm in place of as much ballast elsewhere."""
    moving = {
        'mass': given(10, 'g'),
        'position': given([10, 0, -40], 'cm'),
        'low': given([5, 0, -40], 'cm'),
        'high': given([15, 0, -40], 'cm'),
        'time_constant': given(0.2, 's'),
    }
    vehicle = build(('moving_mass', moving))
    assert vehicle.mass == pytest.approx(gtmab.mass, rel=1e-12)
    assert vehicle.ballast_mass == pytest.approx(gtmab.ballast_mass - 0.010)
    assert vehicle.cg[0] == pytest.approx(0.010 * 0.1 / gtmab.mass, rel=1e-12)
    shift = 0.010 * (-0.40 + 0.395) / gtmab.mass  # it was ballast at -39.5 cm
    assert vehicle.cg[2] == pytest.approx(gtmab.cg[2] + shift, rel=1e-12)
    x, z = vehicle.cg[0], vehicle.cg[2]
    about = gtmab.inertia[1, 1] + gtmab.mass * gtmab.cg[2] ** 2
    about += 0.010 * (0.1**2 + 0.40**2 - 0.395**2) - gtmab.mass * (x * x + z * z)
    assert vehicle.inertia[1, 1] == pytest.approx(about, rel=1e-12)
    assert vehicle.collect_effects()['moving_mass'] == {
        'mass': 0.010, 'x': 0.1, 'y': 0.0, 'z': -0.4, 'lag': 0.2,
    }  # fmt: skip


def test_rotors_with_curves_of_their_own_have_no_common_one(gtmab):
    weaker = {'a': given(0, 'N'), 'b': given(0.1, 'N')}
    vehicle = build(('rotors.up_left.thrust_curve', weaker))
    assert vehicle.collect_effects()['thrust_curve']['b_1'] == 0.1
    assert vehicle.collect_effects()['thrust_curve']['b_2'] == 0.0677
    # The pair hovers with equal thrust, and the weaker one at the larger duty.
    each = 0.002 * G / (2 * 0.961)
    assert vehicle.hover_duty == pytest.approx(max(each / 0.1, gtmab.hover_duty))
    with pytest.raises(BadInput, match=r'^The rotors of gtmab have 2 different thrust curves'):
        _ = vehicle.thrust_curve


def test_what_the_rotors_cannot_carry_cannot_fly_level():
    """40 g are 0.392 N, and two rotors of 0.153 N lift 0.306 N."""
    with pytest.raises(BadInput) as caught:
        level_force(build(('trim.heaviness', given(40, 'g'))))
    assert str(caught.value) == (
        'The rotors of gtmab cannot lift the 40.0 g by which it is heavier than air and hold its '
        'heading; reduce trim.heaviness, or use stronger rotors.'
    )
    # With 30 g, 0.294 N, it can; the forward rotors pull down as well, and get what is left.
    assert 0.0 < level_force(build(('trim.heaviness', given(30, 'g')))) < 0.3
