"""Laws of hidden cases beside the oracle that knows the equation."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

from lta_challenge import case as generator
from lta_challenge import trial
from lta_challenge.case import CaseGenerator
from lta_challenge.case_score import score_case
from lta_challenge.make import load_challenge_vehicle, read_vehicle_text
from lta_challenge.outside import law_oracle
from lta_challenge.outside.law_oracle import TrueWrench
from lta_challenge.recording import write_bag
from lta_challenge.trial import run_trial
from lta_model.vehicle import load_vehicle
import numpy as np
import pytest


def test_the_true_wrench_is_that_of_the_kind() -> None:
    """A magnet: a moment about z by the sine of the heading, times the scale."""
    nominal = SimpleNamespace(build_model=lambda: SimpleNamespace(body=np.zeros(80)))
    steps = 4
    ready = SimpleNamespace(commands=np.zeros((steps, 12)))
    replay = SimpleNamespace(
        build_replay_rows=lambda _: None, compute_body_inputs=lambda _: ready,
        first=np.array([0]), dt=0.02,
        flight=SimpleNamespace(
            time=np.zeros(1), commands=SimpleNamespace(time=np.zeros(1), values=np.zeros((1, 3)))
        ),
    )  # fmt: skip
    parameters = {'size': 0.001, 'north': 0.5}
    flight = cast('Any', SimpleNamespace(replay=replay))
    true = TrueWrench('magnet', parameters, 2.0, flight, cast('Any', nominal))
    heading = np.linspace(0.0, 1.6, steps + 1)
    states = np.zeros((1, steps + 1, 13))
    states[0, :, 5], states[0, :, 6] = np.sin(0.5 * heading), np.cos(0.5 * heading)
    wrench = true.compute_wrench(states)
    middle = 0.5 * (heading[:-1] + heading[1:])
    # Quaternions are averaged between steps, which shortens them a little
    assert wrench[0, :, 5] == pytest.approx(-0.002 * np.sin(middle - 0.5), abs=1e-4)
    assert not wrench[0, :, :5].any()


def test_a_fault_of_one_oracle_keeps_the_other(monkeypatch: pytest.MonkeyPatch) -> None:
    made = SimpleNamespace(finding=SimpleNamespace(verdict='unexplained'))
    answer = {'row': 'base', 'outside': 'desync', 'strange': {'desync': {}}}

    def fail(*_: object) -> None:
        raise IndexError('a test')

    monkeypatch.setattr(trial, 'study_case', lambda _: ({}, made))
    monkeypatch.setattr(trial, 'fit_oracle', lambda *_: {'sigma': {}, 'gaps': []})
    monkeypatch.setattr(trial, 'fit_law_oracle', fail)
    found = run_trial(Path(), lambda: answer)
    assert found == {'oracle': {'sigma': {}, 'gaps': []}, 'law_oracle_fault': 'a test'}
    monkeypatch.setattr(trial, 'fit_oracle', fail)
    monkeypatch.setattr(trial, 'fit_law_oracle', lambda *_: ())
    assert run_trial(Path(), lambda: answer) == {'oracle': {'law': []}, 'oracle_fault': 'a test'}


def test_the_true_wrench_follows_the_commands() -> None:
    """A motor that loses synchronisation at a jump of its duty: F = -size T lost."""
    nominal = SimpleNamespace(build_model=lambda: SimpleNamespace(body=np.zeros(80)))
    steps = 100
    commands = np.zeros((steps, 12))
    commands[:, 2] = 0.05
    told = np.zeros((2, 3))
    told[1, 2] = 0.5
    replay = SimpleNamespace(
        build_replay_rows=lambda _: None,
        compute_body_inputs=lambda _: SimpleNamespace(commands=commands),
        first=np.array([0]), dt=0.01,
        flight=SimpleNamespace(
            time=np.arange(51) * 0.02 + 7.0,
            commands=SimpleNamespace(time=np.array([7.0, 7.5]), values=told),
        ),
    )  # fmt: skip
    parameters = {'size': 0.6, 'jump': 0.1, 'back': 0.5}
    flight = cast('Any', SimpleNamespace(replay=replay))
    states = np.zeros((1, steps + 1, 13))
    states[..., 6] = 1.0
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(law_oracle, 'measured_states', lambda _, count: states[0, :count])
        true = TrueWrench('desync', parameters, 1.0, flight, cast('Any', nominal))
    surge = true.compute_wrench(states)[0, :, 0]
    assert not surge[:51].any()
    # Lost within 25 ms, and kept while the duty is above its filtered value by the jump
    assert surge[60] == pytest.approx(-0.6 * 0.05, rel=0.1)


@pytest.mark.long
def test_a_hidden_law_is_found_and_forecasts_as_well_as_the_oracle(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A magnet is turned by the room: its moment, phase and unit are in the vehicle file."""
    monkeypatch.setattr(generator, 'choose_outside_kind', lambda _draw, late: 'magnet')
    about = load_challenge_vehicle()
    case = CaseGenerator(about, 3801, 0, 'base', 'outside', (50.0, 60.0)).generate_case()
    (tmp_path / 'vehicle.yaml').write_text(read_vehicle_text(), encoding='utf-8')
    for flight in case.flights:
        write_bag(tmp_path / flight.name, flight.streams, about.vehicle.rotor_names, {})
    found = run_trial(tmp_path, lambda: case.answer)
    scored = score_case(0, case.answer, found)
    assert scored.verdict == 'unexplained'
    assert scored.contradictions == ()
    assert scored.law is True
    assert scored.oracle_ratios['law'] < 1.3 < scored.oracle_ratios['tuned']
    true = case.answer['strange']['magnet']['size']
    said = found['law']['terms'][0]
    assert said.startswith('a yaw moment of ')
    assert abs(float(said.split()[4])) == pytest.approx(true, rel=0.05)
    assert load_vehicle('gtmab').file.law is None
