"""The inertia of the air: in LTA's kernel as Lamb has it, in MuJoCo's fluid model missing."""

from pathlib import Path
import sys

import pytest

FOLDER = Path(__file__).resolve().parent


@pytest.fixture
def added_mass(monkeypatch):
    monkeypatch.syspath_prepend(str(FOLDER))
    import added_mass

    yield added_mass
    for name in ('added_mass', 'bench', 'peers.mujoco', 'peers'):
        sys.modules.pop(name, None)


def test_the_kernel_starts_as_lamb_says(added_mass):
    # By hand: eccentricity 0.80075, Lamb's gamma_0 0.95260, so 0.90949 of 0.37636 kg of air.
    assert added_mass.ADDED[2] == pytest.approx(0.34230, abs=5e-6)
    assert added_mass.kernel() == pytest.approx(added_mass.lamb(), rel=1e-12)


def test_mujoco_knows_lambs_mass_and_starts_as_if_there_were_no_air(added_mass):
    mujoco = pytest.importorskip(
        'mujoco', reason='needs mujoco (pip install -r requirements-bench.txt)'
    )
    from peers.mujoco import heave, vehicle

    model = mujoco.MjModel.from_xml_string(vehicle('RK4'))
    # Independent of ours: MuJoCo integrates the potential flow numerically.
    virtual = model.geom_fluid[model.geom('hull').id, 6:12] * added_mass.AIR_DENSITY
    assert virtual == pytest.approx(added_mass.ADDED, rel=1e-5, abs=1e-12)
    assert heave() == pytest.approx(added_mass.FORCE / added_mass.MASS, rel=1e-9)
    assert heave() / added_mass.kernel() - 1.0 == pytest.approx(0.956, abs=0.001)
