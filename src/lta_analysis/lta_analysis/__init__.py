"""
The door for Python: every study as a function, and recordings as tables.

`flight = lta_analysis.open()`, then `flight['odom']`; `lta_analysis.wind('gtmab')` is `lta wind
gtmab`. A function takes the options of its command by name and returns a `StudyResult`.
"""

from importlib import import_module
from typing import TYPE_CHECKING

# Type checkers and editors see the functions without the imports at run time
if TYPE_CHECKING:
    from lta_analysis.door import as_function
    from lta_analysis.flights import check as check
    from lta_analysis.flights import fly_grid as fly_grid
    from lta_analysis.flights import import_log as import_log
    from lta_analysis.flights import simulate as simulate
    from lta_data.bag.recorded_flight import open_flight as open  # noqa: F401
    from lta_data.compare.request import FlightComparisonRequest
    from lta_discovery.calibration.run import CalibrationRequest
    from lta_discovery.demo.trial_effect import TrialRequest
    from lta_discovery.discovery.run import DiscoveryRequest
    from lta_discovery.forecast_study import ForecastRequest
    from lta_discovery.lab_tests.request import LabPlanRequest, LabReadingRequest
    from lta_discovery.planning.next_flight import SeparatingFlightRequest
    from lta_flight.replay.run import NodeReplayRequest
    from lta_flight.sweep.run import SweepRequest
    from lta_studies.cfd.request import SphereRequest, TunnelRequest
    from lta_studies.energy.breakeven import BreakEvenRequest
    from lta_studies.energy.budget.run import BudgetRequest
    from lta_studies.energy.cells.request import CellsRequest
    from lta_studies.energy.hover.run import HoverRequest
    from lta_studies.energy.mounting.run import MountingRequest
    from lta_studies.light.bearing.run import BearingTrialRequest
    from lta_studies.light.bearing.study import RingStudyRequest
    from lta_studies.light.evaluation.run import EvaluationRequest
    from lta_studies.light.link.link_budget import LinkRequest
    from lta_studies.light.plan.request import LampPlanRequest
    from lta_studies.light.turntable.request import DiodeCalibrationRequest, TurntableRequest
    from lta_studies.mission.run import MissionStudyRequest
    from lta_studies.platforms.run import PlatformsRequest
    from lta_studies.reproduce.run import ReproductionRequest
    from lta_studies.tune.run import TuningRequest
    from lta_studies.wind.limits import WindStudyRequest

    calibrate = as_function(CalibrationRequest)
    cells = as_function(CellsRequest)
    cfd_run = as_function(TunnelRequest)
    cfd_validate = as_function(SphereRequest)
    compare = as_function(FlightComparisonRequest)
    discover = as_function(DiscoveryRequest)
    effects_try = as_function(TrialRequest)
    energy_breakeven = as_function(BreakEvenRequest)
    energy_budget = as_function(BudgetRequest)
    energy_hover = as_function(HoverRequest)
    energy_mounting = as_function(MountingRequest)
    forecast = as_function(ForecastRequest)
    hardware_light = as_function(TurntableRequest)
    light_bearing = as_function(BearingTrialRequest)
    light_calibrate = as_function(DiodeCalibrationRequest)
    light_evaluate = as_function(EvaluationRequest)
    light_link = as_function(LinkRequest)
    light_plan = as_function(LampPlanRequest)
    light_study = as_function(RingStudyRequest)
    mission = as_function(MissionStudyRequest)
    platforms = as_function(PlatformsRequest)
    replay = as_function(NodeReplayRequest)
    reproduce = as_function(ReproductionRequest)
    sweep = as_function(SweepRequest)
    tests_between = as_function(SeparatingFlightRequest)
    tests_plan = as_function(LabPlanRequest)
    tests_read = as_function(LabReadingRequest)
    tune = as_function(TuningRequest)
    wind = as_function(WindStudyRequest)

# Module and request of each function; its command has the same name, in words
FUNCTIONS = {
    'calibrate': 'lta_discovery.calibration.run:CalibrationRequest',
    'cells': 'lta_studies.energy.cells.request:CellsRequest',
    'cfd_run': 'lta_studies.cfd.request:TunnelRequest',
    'cfd_validate': 'lta_studies.cfd.request:SphereRequest',
    'compare': 'lta_data.compare.request:FlightComparisonRequest',
    'discover': 'lta_discovery.discovery.run:DiscoveryRequest',
    'effects_try': 'lta_discovery.demo.trial_effect:TrialRequest',
    'energy_breakeven': 'lta_studies.energy.breakeven:BreakEvenRequest',
    'energy_budget': 'lta_studies.energy.budget.run:BudgetRequest',
    'energy_hover': 'lta_studies.energy.hover.run:HoverRequest',
    'energy_mounting': 'lta_studies.energy.mounting.run:MountingRequest',
    'forecast': 'lta_discovery.forecast_study:ForecastRequest',
    'hardware_light': 'lta_studies.light.turntable.request:TurntableRequest',
    'light_bearing': 'lta_studies.light.bearing.run:BearingTrialRequest',
    'light_calibrate': 'lta_studies.light.turntable.request:DiodeCalibrationRequest',
    'light_evaluate': 'lta_studies.light.evaluation.run:EvaluationRequest',
    'light_link': 'lta_studies.light.link.link_budget:LinkRequest',
    'light_plan': 'lta_studies.light.plan.request:LampPlanRequest',
    'light_study': 'lta_studies.light.bearing.study:RingStudyRequest',
    'mission': 'lta_studies.mission.run:MissionStudyRequest',
    'platforms': 'lta_studies.platforms.run:PlatformsRequest',
    'replay': 'lta_flight.replay.run:NodeReplayRequest',
    'reproduce': 'lta_studies.reproduce.run:ReproductionRequest',
    'sweep': 'lta_flight.sweep.run:SweepRequest',
    'tests_between': 'lta_discovery.planning.next_flight:SeparatingFlightRequest',
    'tests_plan': 'lta_discovery.lab_tests.request:LabPlanRequest',
    'tests_read': 'lta_discovery.lab_tests.request:LabReadingRequest',
    'tune': 'lta_studies.tune.run:TuningRequest',
    'wind': 'lta_studies.wind.limits:WindStudyRequest',
}
# What returns something else: module and function
OTHERS = {
    'check': 'lta_analysis.flights:check',
    'fly_grid': 'lta_analysis.flights:fly_grid',
    'import_log': 'lta_analysis.flights:import_log',
    'open': 'lta_data.bag.recorded_flight:open_flight',
    'simulate': 'lta_analysis.flights:simulate',
}

__all__ = [*FUNCTIONS, *OTHERS]


def __dir__() -> list[str]:
    """Return the names that a notebook completes."""
    return sorted(__all__)


def __getattr__(name: str) -> object:
    """Return a function of `__all__`, imported at its first use."""
    # Lazy imports keep `import lta_analysis` fast: readers of bags load numpy, flights numba
    module, _, item = (FUNCTIONS | OTHERS).get(name, '').partition(':')
    if name in OTHERS:
        return getattr(import_module(module), item)
    if name in FUNCTIONS:
        from lta_analysis.door import as_function

        return globals().setdefault(name, as_function(getattr(import_module(module), item)))
    # The message of Python for a missing attribute of a module
    raise AttributeError(f"module '{__name__}' has no attribute '{name}'")
