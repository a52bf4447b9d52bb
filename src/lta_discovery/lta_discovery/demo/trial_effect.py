"""Choose what `lta effects try` hides: a parameter of an effect at a clearly visible size."""

from typing import Final, final

from lta_config.errors import BadInput
from lta_discovery.demo.hidden_effect import (
    DemoEffect,
    find_present_value,
    HIDDEN_VEHICLE,
    list_candidates,
)
from lta_discovery.model.candidates import DESIGN
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.planning.equivalence_classes import find_kind_classes
from lta_discovery.progress import DiscoverProgress
from lta_model.effects import get_effect
from lta_model.vehicle import load_vehicle
from lta_report.report import Report
from lta_report.request import argument, option, ReportRequest, StudyRun

TRIAL_SIGMA: Final = 40.0  # sigma in the flights of `make campaign classes`, which are longer
FAINT: Final = 3.0  # sigma; discovery names nothing below it
LARGEST_EFFECT: Final = 8.0  # typical sizes
SMALLEST_EFFECT: Final = 1.0  # typical sizes; even where less would be visible
# Limits beyond which a vehicle cannot fly, or is no longer the same kind of vehicle
FLYABLE_LIMITS: Final[dict[str, tuple[float, float]]] = {
    'steady_wind': (-0.35, 0.35),
    'wind_gradient': (-0.05, 0.05),
    'gas_purity': (-0.03, 0.0015),
    'ballast': (-0.0006, 0.01),
    'payload': (0.0, 0.01),
    'cg_height': (-0.04, 0.03),
    'cg_offset': (-0.02, 0.02),
    'net_lift': (-0.1, 0.004),
    'helium_leak': (0.0, 4e-4),
    'added_mass': (-0.1, 0.25),
    'added_inertia': (-0.003, 0.006),
    'quadratic_drag': (-0.06, 0.25),
    'rotational_drag': (-0.0004, 0.006),
    'munk_moment': (-0.5, 1.0),
    'motor_lag': (-0.05, 0.25),
    'thrust_scale': (-0.35, 0.3),
    'rotor_fault': (0.0, 0.4),
    'imu_bias': (-0.8, 0.8),
    'tracker_misalignment': (-0.4, 0.4),
    'motor_deadband': (0.0, 0.2),
}


@final
class TrialRequest(ReportRequest, command='effects try', folder='effects-try'):
    """
    Hide an effect in simulated flights that excite it, and discover it.

    Three flights with changing height, heading and speed and shaken motors. Of an effect with
    several parameters, one that such flights show well is hidden, at a size that they show. Page,
    files and terminal are those of "lta discover". Says why if an effect cannot be tried.

    Example: lta effects try motor_deadband
    """

    name: str = argument('Effect, or one of its parameters, such as cg_offset.x.')
    seed: int = option('Random seed.', default=1, low=0, high=2**20)

    def run(self, run: StudyRun) -> Report:
        """Return the report of the discovery."""
        from lta_discovery.demo.demo import discover_hidden_effect

        hidden = choose_trial_effect(self.name)
        with DiscoverProgress(run.console) as progress:
            return discover_hidden_effect(hidden, self.seed, run.folder, progress.show_stage)


def choose_trial_effect(name: str) -> DemoEffect:
    """
    Return what to hide of an effect 'cg_offset' or of its parameter 'cg_offset.x'.

    Raise `BadInput` if there is no such effect or parameter, or discovery does not look for it;
    says why.
    """
    word = name.partition('.')[0]
    effect = get_effect(word)
    if word in DESIGN:
        raise BadInput(
            f"'{word}' describes the design of a vehicle or its surroundings, which discovery "
            'takes from the vehicle file and the scenario, so it cannot be missing; try another '
            'effect, such as motor_deadband.'
        )
    own = [each for each in list_candidates().values() if each.name.partition('.')[0] == word]
    if '.' in name and name not in [each.name for each in own]:
        names = ', '.join(each.name for each in own) or ', '.join(
            each.name for each in effect.parameters
        )
        raise BadInput(
            f"'{name}' is not a parameter that discovery looks for; try {word}, or one of: "
            f'{names}.'
        )
    classes = find_kind_classes('all')
    # Effects from other packages have no derived visibility
    reach = {each.name: classes.reach.get(each.name, [1.0])[0] for each in own}
    seen = [each for each in own if each.name not in classes.unseen and name in (word, each.name)]
    if not seen:
        raise BadInput(
            f"'{name}' cannot be seen in a flight through still air without sun, with any sensor, "
            'so discovery cannot find it there; try another effect, such as motor_deadband.'
        )
    visible = [each for each in seen if reach[each.name] >= TRIAL_SIGMA]
    best = (visible or sorted(seen, key=lambda each: -reach[each.name]))[0]
    size = choose_trial_size(best, reach[best.name])
    if (strength := reach[best.name] * abs(size) / best.typical) < FAINT:
        raise BadInput(
            f"'{name}' is too weak to be found: in such flights {best.name} stands out from the "
            f'tolerances of a vehicle by {strength:.1f} standard deviations, and {FAINT:.0f} are '
            'the least; try another effect, such as motor_deadband.'
        )
    nominal = NominalVehicle.from_vehicle(load_vehicle(HIDDEN_VEHICLE))
    value = find_present_value(best, nominal) + size
    return DemoEffect(best.name, float(f'{value:.3g}'), best.unit)


def choose_trial_size(parameter: FreeParameter, reach: float) -> float:
    """Return a change that is clearly visible and that a vehicle can fly with."""
    size = parameter.typical * min(max(TRIAL_SIGMA / reach, SMALLEST_EFFECT), LARGEST_EFFECT)
    low, high = FLYABLE_LIMITS.get(parameter.name.partition('.')[0], (-size, size))
    low, high = max(low, parameter.low), min(high, parameter.high)
    # The sign for which there is more room
    return min(size, high) if high >= -low else max(-size, low)
