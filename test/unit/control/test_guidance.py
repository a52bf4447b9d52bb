# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Guidance after each light block: mission or course, by what is known of motion and energy."""

from lta_config.course import Course
from lta_control.guidance import Guidance, GuidanceInputs, ReserveReport, ReserveResponseSettings
from lta_control.mission import FlightPermission, MissionSettings, Phase
from lta_control.motion import CascadeMeasurement, Setpoint
from lta_control.strategies import find_navigation_strategy
from lta_control.strategies.protocol import LightMeasurement

SECOND = 1_000_000_000
SETTINGS, RESERVE = MissionSettings(), ReserveResponseSettings()
BAG = find_navigation_strategy('bag')
SEEN = LightMeasurement(seen=True, bearing=0.4, heading=1.0, amplitudes=(0.0,) * 8, interval=0.1)
MEASURED = CascadeMeasurement(0.42, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0)


def choose(guidance, stamp_ns=0, measured=MEASURED, report=ReserveReport(0, False, False)):  # noqa: B008 - immutable
    return guidance.choose_setpoint(
        GuidanceInputs(SETTINGS, RESERVE, BAG, stamp_ns, SEEN, measured, report)
    )


def test_it_takes_off_only_with_a_known_motion_and_energy():
    guidance = Guidance(None, ())
    assert guidance.permission is FlightPermission.DOWN
    for unknown in ({'measured': None}, {'report': None}, {'stamp_ns': 2 * SECOND}):
        assert choose(guidance, **unknown) == Setpoint(0.0, 1.0, 0.0)
        assert guidance.mission.phase is Phase.REST
    assert choose(guidance) == Setpoint(0.5, 1.0, 0.0)
    assert guidance.mission.phase is Phase.CLIMB
    assert guidance.permission is FlightPermission.FLY


def test_a_course_begins_with_the_first_block():
    row = {'at': '2 s', 'altitude': '1 m', 'heading': '0.5 rad', 'speed': '0.4 m/s'}
    guidance = Guidance(Course.model_validate({'between': 'step', 'rows': [row]}), ())
    for second, setpoint in ((100, (0.0, 0.5, 0.0)), (102, (1.0, 0.5, 0.4))):
        report = ReserveReport(second * SECOND, False, False)
        assert choose(guidance, second * SECOND, report=report) == setpoint
    assert guidance.mission.phase is Phase.REST


def test_it_listens_to_the_lamp_of_its_leg_after_the_first_block():
    """Before it, the demodulator listens to its own frequency, as in the graph."""
    route = (('gate', 120.0), ('dock', 180.0))
    guidance = Guidance(None, route)
    assert guidance.beacon == 0.0
    choose(guidance, 100 * SECOND, report=ReserveReport(100 * SECOND, False, False))
    assert guidance.beacon == 120.0
    guidance.mission = guidance.mission._replace(target=1)
    choose(guidance, 101 * SECOND, report=ReserveReport(101 * SECOND, False, False))
    assert guidance.beacon == route[guidance.mission.target][1]
    alone = Guidance(None, ())
    choose(alone, 100 * SECOND, report=ReserveReport(100 * SECOND, False, False))
    assert alone.beacon == 0.0
