# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""What an aero file says beside its coefficients, from points written by hand."""

from lta_config.files import validate_content
from lta_config.schema.vehicle_aero import AeroFile
from lta_windtunnel.aero_fit import (
    collect_warnings,
    describe_side_loads,
    fit_drag_by_axis,
    hull_share,
    mesh_share,
    sum_processor_time,
)
from lta_windtunnel.aero_text import format_aero_file
from lta_windtunnel.solve import build_sweep
from lta_windtunnel.sweep_table import FlowQuality, SweepPoint
from lta_windtunnel.tunnel_model import load_tunnel_model
import pytest
import yaml

AIR = (1.2, 1.5e-5)
SURE = FlowQuality(spread=0.01, window=50.0, cells=90000, seconds=50.0)
SPEEDS = (0.5, 1.0, 2.0)


def point(speed, force, moment=(0.0, 0.0, 0.0), parts=None):
    return SweepPoint(
        speed=speed,
        force=[each * speed**2 for each in force],
        moment=[each * speed**2 for each in moment],
        parts=parts or {'envelope': -force[0]},
        viscous=0.1,
        evidence=SURE,
    )


def surge(*, lift=0.0, turning=0.0, parts=None, coarse=None):
    points = [point(speed, (-0.1, 0.0, lift), (0.0, turning, 0.0), parts) for speed in SPEEDS]
    model = load_tunnel_model('gtmab')
    return build_sweep(
        model, 'gtmab', 'preview', AIR, {'surge': points}, {}, {},
        {'surge': coarse} if coarse else None,
    )  # fmt: skip


def test_lift_and_its_moment_are_told_where_they_are_not_negligible():
    told = describe_side_loads(surge(lift=0.04, turning=0.005))
    assert told == {'surge': 'at 1 m/s force (-0.1, 0, 0.04) N, moment (0, 0.005, 0) N m'}
    assert describe_side_loads(surge(lift=0.004)) == {}  # 4 % of the drag


def test_a_coarser_mesh_tells_what_the_mesh_decides():
    sweep = surge(coarse=point(1.0, (-0.11, 0.0, 0.0)))
    assert mesh_share(sweep, 'surge') == pytest.approx(0.1)
    assert mesh_share(surge(), 'surge') is None
    read = validate_content(AeroFile, yaml.safe_load(format_aero_file(sweep)), 'the text')
    assert read.evidence.axes['surge'].mesh == pytest.approx(0.1)
    assert read.evidence.axes['yaw'].mesh is None


def test_what_a_fidelity_cannot_do_is_a_warning():
    sweep = surge()
    assert 'up to 30 % low at 2 m/s' in collect_warnings(sweep)[-1]
    assert 'above 1 m/s is extrapolated' in collect_warnings(reference(0.3, 0.32))[-1]
    still = sweep.model_copy(update={'fidelity': 'reference', 'axes': {}})
    assert not any('extrapolated' in each for each in collect_warnings(still))


def reference(fast, slow):
    """Return a sweep with a transient drag at 1 m/s and a steady one at 0.2 m/s [N s2/m2]."""
    points = [point(0.2, (-slow, 0.0, 0.0)), point(1.0, (-fast, 0.0, 0.0))]
    return surge().model_copy(update={'fidelity': 'reference', 'axes': {'surge': points}})


def test_a_slow_steady_flow_that_does_not_join_the_transient_is_left_out():
    joined = fit_drag_by_axis(reference(0.3, 0.35))['surge']  # a + b = 0.3, 5 a + b = 0.35
    assert (joined.linear, joined.quadratic) == pytest.approx((0.0125, 0.2875))
    low = reference(0.3, 0.24)
    fit = fit_drag_by_axis(low)['surge']
    assert (fit.linear, fit.quadratic) == pytest.approx((0.0, 0.3))
    said = 'surge: the drag of the steady flow at 0.2 m/s differs by -20 % from the fit'
    assert said in collect_warnings(low)[-1]
    read = validate_content(AeroFile, yaml.safe_load(format_aero_file(low)), 'the text')
    assert read.evidence.axes['surge'].points == 1


def test_what_all_flows_took_is_told():
    assert sum_processor_time(surge(coarse=point(1.0, (-0.11, 0.0, 0.0)))) == pytest.approx(
        4 * 50.0
    )


def test_what_hangs_below_the_hull_has_its_share():
    parts = {'envelope': 0.095, 'gondola': 0.004, 'frame': 0.001}
    assert hull_share(surge(parts=parts), 'surge') == pytest.approx(0.95)
    assert hull_share(surge(), 'yaw') is None


def test_a_drag_far_from_the_estimate_by_hand_is_a_warning():
    model = load_tunnel_model('gtmab')
    low = [point(speed, (-0.03, 0.0, 0.0)) for speed in SPEEDS]
    sweep = build_sweep(model, 'gtmab', 'preview', AIR, {'surge': low}, {}, {})
    assert any('times the analytic estimate' in each for each in collect_warnings(sweep))
    assert not any('times the analytic estimate' in each for each in collect_warnings(surge()))
