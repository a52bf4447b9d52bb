# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""OpenFOAM itself, where it is installed: a sphere on a coarse mesh, from shape to coefficient."""

from campaigns.sphere import build_sphere_model, compare_sphere_drag
from lta_windtunnel.flow_plan import TunnelFlow
from lta_windtunnel.openfoam.case import has_openfoam
from lta_windtunnel.solve import solve_sweep, ThreadedFlowSolver
from lta_windtunnel.tunnel import build_steady_wind_case, COARSE_MESH
import pytest

AIR = (1.2, 1.5e-5)
SLOW = 0.2  # m/s, where the steady model is right


@pytest.mark.long
@pytest.mark.skipif(not has_openfoam(), reason='OpenFOAM is not installed')
def test_a_slow_sphere_brakes_as_spheres_do(tmp_path):
    model = build_sphere_model()
    flow = TunnelFlow(
        'wind',
        'surge',
        build_steady_wind_case(model, 'surge', AIR[1], COARSE_MESH, (SLOW,)),
        (SLOW,),
    )
    crew = ThreadedFlowSolver(tmp_path, 1, lambda *_: None)
    axes, _, refused, _ = solve_sweep(crew, model, [flow], AIR, lambda _: None)
    assert refused == {}
    (point,) = axes['surge']
    found = compare_sphere_drag('coarse', point, AIR)
    assert found.coefficient == pytest.approx(found.measured, rel=0.1)
    assert point.force[1:] == [0.0, 0.0]
    assert point.evidence.balance < 0.05
