"""OpenFOAM itself, where it is installed: a sphere on a coarse mesh, from shape to coefficient."""

from lta_sim.cfd.crew import Threads
from lta_sim.cfd.openfoam.engine import openfoam
from lta_sim.cfd.plan import Flow
from lta_sim.cfd.solve import solve
from lta_sim.cfd.tunnel import COARSE, steady_wind
from lta_sim.cfd.validation import judged, sphere
import pytest

AIR = (1.2, 1.5e-5)
SLOW = 0.2  # m/s, where the steady model is right


@pytest.mark.long
@pytest.mark.skipif(not openfoam(), reason='OpenFOAM is not installed')
def test_a_slow_sphere_brakes_as_spheres_do(tmp_path):
    model = sphere()
    flow = Flow('wind', 'surge', steady_wind(model, 'surge', AIR[1], COARSE, (SLOW,)), (SLOW,))
    crew = Threads(tmp_path, 1, lambda *_: None)
    axes, _, refused, _ = solve(crew, model, [flow], AIR, lambda _: None)
    assert refused == {}
    (point,) = axes['surge']
    found = judged('coarse', point, AIR)
    assert found.coefficient == pytest.approx(found.measured, rel=0.1)
    assert point.force[1:] == [0.0, 0.0]
    assert point.evidence.balance < 0.05
