# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Missions side by side: each is simulated once, and the headline counts failures."""

from lta_energy.circuit import EnergyTotals
from lta_energy.mission import MissionFlight, MissionLog
from lta_report.request import StudyRun
from lta_report.study import StudyOptions
from lta_report.study_store import StudyStore
from lta_studies.mission import run as running
from lta_studies.mission.flyer import AWARE, NAIVE
from lta_studies.mission.run import load_request, MISSION_STORE, run_missions
import pytest
from rich.console import Console

ONE = StudyOptions(workers=1)


def build_log(seed):
    spent = EnergyTotals(*map(float, range(len(EnergyTotals._fields))))
    flight = MissionFlight(10.0, 60.0 + seed, 2, 5.5, spent, 0.9, 0.8, 0.79, 3.7, 'home')
    return MissionLog(
        [flight], [0.0, 60.0], [1.0, 0.9], [1.0, 0.9], [0.0, 0.01], [0, 2],
        harvested=[0.0, 0.1], consumed=[0.0, 0.2], lost=[0.0, 0.3], spent=spent,
    )  # fmt: skip


@pytest.fixture
def simulated(monkeypatch):
    """Let every mission be over at once; return the list of those that were simulated."""
    done = []

    class Short:
        def __init__(self, seed):
            self.seed = seed

        def run(self, on_progress):
            if self.seed == 3:
                raise KeyboardInterrupt
            on_progress(43200.0)
            return build_log(self.seed)

    def build(_mission, _day, _scenes, schedule, days, seed):
        done.append((schedule, days, seed))
        return Short(seed), None

    monkeypatch.setattr(running, 'build_simulation', build)
    return done


def run(folder, seeds, days=1):
    request = load_request('greenhouse', days, seeds, (AWARE, NAIVE))
    return run_missions(request, StudyRun(Console(quiet=True), folder, options=ONE))


def test_a_stopped_study_goes_on_and_more_seeds_can_be_added(tmp_path, simulated):
    with pytest.raises(KeyboardInterrupt):
        run(tmp_path / 'out', [1, 3])
    results = run(tmp_path / 'out', [1, 2])
    assert [(each.schedule, each.seed) for each in results] == [
        (AWARE, 1), (NAIVE, 1), (AWARE, 2), (NAIVE, 2)
    ]  # fmt: skip
    assert simulated == [
        (AWARE, 1, 1), (NAIVE, 1, 1), (AWARE, 1, 3), (AWARE, 1, 2), (NAIVE, 1, 2)
    ]  # fmt: skip
    assert [each.figures.flown for each in results] == [61.0, 61.0, 62.0, 62.0]


def test_a_log_is_stored_whole(tmp_path):
    log = build_log(1)
    with StudyStore(tmp_path, MISSION_STORE, 'mine') as store:
        store.add('a', log)
    with StudyStore(tmp_path, MISSION_STORE, 'mine') as store:
        assert store.results['a'] == log
        assert isinstance(store.results['a'].flights[0].spent, EnergyTotals)
