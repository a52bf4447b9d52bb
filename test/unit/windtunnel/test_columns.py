# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Columns of B, by symmetry and by what superposes, from sweeps written by hand."""

from lta_config.files import validate_content
from lta_config.schema.vehicle_aero import AeroFile
from lta_windtunnel.aero_text import format_aero_file, format_quantity
from lta_windtunnel.solve import build_sweep, estimate_drag
from lta_windtunnel.sweep_table import Blow, FlowQuality
from lta_windtunnel.thrust_allocation import (
    compute_jet_coupling,
    find_rotor_column,
    linearity_ratio,
    sum_columns,
)
from lta_windtunnel.tunnel_model import load_tunnel_model
import pytest
import yaml

AIR = (1.2, 1.5e-5)
FULL = 0.1592
SURE = FlowQuality(spread=0.0, window=50.0, cells=70000, seconds=50.0)


def blown(shares, force, moment):
    return Blow(
        shares=shares,
        force=[FULL * each for each in force],
        moment=[FULL * each for each in moment],
        zones=dict.fromkeys(shares, 56),
        evidence=SURE,
    )


def gtmab(**blows):
    return build_sweep(load_tunnel_model('gtmab'), 'gtmab', 'preview', AIR, {}, blows, {})


UP = blown({'up_left': 1.0}, (0, 0.013, 0.961), (0.188, 0, 0))


def test_a_column_is_a_wrench_per_newton():
    found = find_rotor_column(gtmab(up_left=UP), 'up_left')
    assert found.wrench == pytest.approx([0, 0.013, 0.961, 0.188, 0, 0])


def test_the_other_side_is_the_mirror_image():
    found = find_rotor_column(gtmab(up_left=UP), 'up_right')
    assert found.wrench == pytest.approx([0, -0.013, 0.961, -0.188, 0, 0])
    assert found.source == 'as up_left, by symmetry'


def test_a_reversed_column_is_for_negative_thrust():
    back = blown({'up_left': -1.0}, (0, 0.23, -0.252), (-0.072, 0, 0))
    found = find_rotor_column(gtmab(up_left_reversed=back), 'up_left', backward=True)
    assert found.wrench == pytest.approx([0, -0.23, 0.252, 0.072, 0, 0])


def test_a_quarter_turn_brings_a_lateral_rotor_to_the_next():
    front = blown({'front': 1.0}, (0.95, 0.25, -0.06), (0.09, -0.39, 0.05))
    sweep = build_sweep(
        load_tunnel_model('beavis'), 'beavis', 'preview', AIR, {}, {'front': front}, {}
    )
    # The rear one by half a turn; the left one across the diagonal, as it is turned the other way.
    assert find_rotor_column(sweep, 'rear').wrench == pytest.approx(
        [-0.95, -0.25, -0.06, -0.09, 0.39, 0.05]
    )
    assert find_rotor_column(sweep, 'left').wrench == pytest.approx(
        [0.25, 0.95, -0.06, 0.39, -0.09, -0.05]
    )


def test_what_symmetry_cancels_is_nothing():
    assert (
        str(format_quantity([4e-17, -0.0, -0.86061], 'N/N', '')['value']) == '[0.0, 0.0, -0.8606]'
    )


def test_two_jets_apart_are_the_sum_of_both():
    both = blown({'up_left': 1.0, 'up_right': 1.0}, (0, 0, 1.911), (0, 0, 0))
    sweep = gtmab(up_left=UP, all=both)
    assert sum_columns(sweep, both.shares)[2] == pytest.approx(1.922 * FULL)
    assert compute_jet_coupling(sweep) is None


def test_jets_that_collide_are_a_coupling():
    one = blown({'front': 1.0}, (0.98, 0.001, -0.039), (-0.001, -0.401, 0))
    names = ('front', 'left', 'rear', 'right')
    four = blown(dict.fromkeys(names, 1.0), (0, 0, 0.911), (0, 0, 0))
    blows = {'front': one, 'all': four}
    sweep = build_sweep(load_tunnel_model('beavis'), 'beavis', 'preview', AIR, {}, blows, {})
    found = compute_jet_coupling(sweep)
    assert found.rotors == names
    assert found.wrench[2] == pytest.approx(0.911 + 4 * 0.039)


def test_a_wrench_that_grows_as_thrust_is_linear():
    both = blown({'up_left': 1.0, 'up_right': 1.0}, (0, 0, 1.911), (0, 0, 0))
    part = blown({'up_left': 0.25, 'up_right': 0.25}, (0, 0, 0.25 * 1.9), (0, 0, 0))
    assert linearity_ratio(gtmab(both=both, both_quarter=part), 'both') == pytest.approx(
        1.9 / 1.911
    )


def test_a_sweep_becomes_a_file_that_is_read_and_says_what_is_by_hand():
    content = yaml.safe_load(format_aero_file(gtmab(up_left=UP)))
    read = validate_content(AeroFile, content, 'the text')
    assert read.aero.thrust_allocation['up_right'].force.vector[1] == pytest.approx(-0.013)
    assert 'analytic estimate: surge, sway, heave' in read.aero.quadratic_drag.force.source
    assert 'yaw: analytic estimate, no flow was solved' in read.evidence.warnings


def test_what_is_by_hand_brakes():
    for axis, points in estimate_drag(load_tunnel_model('gtmab'), AIR).items():
        wrench = [*points[0].force, *points[0].moment]
        assert min(wrench) < 0.0 == max(wrench), axis


def test_what_symmetry_forbids_is_nought_and_no_noise_of_a_mesh():
    noisy = blown({'up_left': 1.0}, (1e-3, 0.013, 0.961), (0.188, 2e-3, -1e-3))
    found = find_rotor_column(gtmab(up_left=noisy), 'up_left')
    assert found.wrench == pytest.approx([0, 0.013, 0.961, 0.188, 0, 0], abs=1e-15)
    # A forward rotor mirrors onto no place of its own: nothing of it must be nought.
    free = blown({'forward_left': 1.0}, (0.981, 0.011, -0.061), (-0.002, -0.403, -0.1))
    found = find_rotor_column(gtmab(forward_left=free), 'forward_left')
    assert found.wrench == pytest.approx([0.981, 0.011, -0.061, -0.002, -0.403, -0.1])
