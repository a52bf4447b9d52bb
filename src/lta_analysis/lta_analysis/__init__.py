# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
The door for Python: every command as a function, and recordings as tables.

`flight = lta_analysis.open()`, then `flight['odom']`; `lta_analysis.wind('gtmab')` is `lta wind
gtmab`. A function takes the options of its command by name and returns a `StudyResult`, or what
`help` says.
"""

import ast
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

# The list of all functions. Type checkers and editors read it as it is; at run time it is not
# executed, which would import everything, but read for the places of the requests.
if TYPE_CHECKING:
    from lta_analysis.bags import (
        BagCheckRequest,
        BagExportRequest,
        BagInfoRequest,
        BagPlotRequest,
        BagUpgradeRequest,
    )
    from lta_analysis.comparison.request import FlightComparisonRequest
    from lta_analysis.door import as_function
    from lta_analysis.flights import (
        FlightPageRequest,
        FlyRequest,
        LogImportRequest,
        SimulateRequest,
    )
    from lta_analysis.flights import fly_grid as fly_grid
    from lta_analysis.model_effects import EffectListRequest, EffectSkeletonRequest
    from lta_analysis.vehicles import (
        NewVehicleRequest,
        TrimRequest,
        UrdfRequest,
        VehicleCheckRequest,
        VehicleDifferenceRequest,
        VehicleEditRequest,
        VehicleSheetRequest,
    )
    from lta_data.bag.recorded_flight import open_flight as open  # noqa: F401
    from lta_discovery.calibration.run import CalibrationRequest
    from lta_discovery.discovery.run import DiscoveryRequest
    from lta_discovery.forecast_study import ForecastRequest
    from lta_discovery.lab_tests.request import (
        LabPlanRequest,
        LabReadingRequest,
        SeparatingTestRequest,
    )
    from lta_flight.replay.run import NodeReplayRequest
    from lta_flight.sweep.run import SweepRequest
    from lta_studies.cfd.request import RefitRequest, TunnelRequest
    from lta_studies.energy.breakeven import BreakEvenRequest
    from lta_studies.energy.budget.run import BudgetRequest
    from lta_studies.energy.cells.arrays import CellsRequest
    from lta_studies.light.link.link_budget import LinkRequest
    from lta_studies.light.plan.request import LampPlanRequest
    from lta_studies.light.turn.calibration import DiodeCalibrationRequest
    from lta_studies.mission.run import MissionStudyRequest
    from lta_studies.reproduce.run import ReproductionRequest
    from lta_studies.tune.run import TuningRequest
    from lta_studies.wind.limits import WindRequest

    bag_check = as_function(BagCheckRequest)
    bag_export = as_function(BagExportRequest)
    bag_info = as_function(BagInfoRequest)
    bag_plot = as_function(BagPlotRequest)
    bag_upgrade = as_function(BagUpgradeRequest)
    calibrate = as_function(CalibrationRequest)
    cells = as_function(CellsRequest)
    cfd_refit = as_function(RefitRequest)
    cfd_run = as_function(TunnelRequest)
    compare = as_function(FlightComparisonRequest)
    discover = as_function(DiscoveryRequest)
    effects = as_function(EffectListRequest)
    effects_new = as_function(EffectSkeletonRequest)
    energy_breakeven = as_function(BreakEvenRequest)
    energy_budget = as_function(BudgetRequest)
    fly = as_function(FlyRequest)
    forecast = as_function(ForecastRequest)
    import_log = as_function(LogImportRequest)
    light_calibrate = as_function(DiodeCalibrationRequest)
    light_link = as_function(LinkRequest)
    light_plan = as_function(LampPlanRequest)
    mission = as_function(MissionStudyRequest)
    replay = as_function(NodeReplayRequest)
    report = as_function(FlightPageRequest)
    reproduce = as_function(ReproductionRequest)
    simulate = as_function(SimulateRequest)
    sweep = as_function(SweepRequest)
    tests_between = as_function(SeparatingTestRequest)
    tests_plan = as_function(LabPlanRequest)
    tests_read = as_function(LabReadingRequest)
    tune = as_function(TuningRequest)
    vehicle_check = as_function(VehicleCheckRequest)
    vehicle_diff = as_function(VehicleDifferenceRequest)
    vehicle_new = as_function(NewVehicleRequest)
    vehicle_set = as_function(VehicleEditRequest)
    vehicle_show = as_function(VehicleSheetRequest)
    vehicle_trim = as_function(TrimRequest)
    vehicle_urdf = as_function(UrdfRequest)
    wind = as_function(WindRequest)


def _read_list() -> tuple[dict[str, str], dict[str, str]]:
    """Return module and request of each command's function; and those of other functions."""
    tree = ast.parse(Path(__file__).read_text(encoding='utf-8'))
    (block,) = (node for node in tree.body if isinstance(node, ast.If))
    places, commands = {}, {}
    for node in block.body:
        if isinstance(node, ast.ImportFrom):
            for each in node.names:
                places[each.asname or each.name] = f'{node.module}:{each.name}'
        elif isinstance(node, ast.Assign):
            name, request = ast.unparse(node.targets[0]), ast.unparse(node.value)
            commands[name] = places[request.removeprefix('as_function(').removesuffix(')')]
    others = {name: place for name, place in places.items() if name in {'fly_grid', 'open'}}
    return commands, others


# Module and request of each function; its command has the same name, in words
FUNCTIONS, OTHERS = _read_list()
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
