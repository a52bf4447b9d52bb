"""One flight of a batch as numbers: what the kernel keeps of it, and the constants of its loop."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, cast, final

from lta_config.compilation.flat import bare
from lta_config.errors import BadInput
from lta_config.topics import TopicTable
from lta_control.autopilot import drone_of
from lta_control.cascade import CascadeGains
from lta_control.laws import LAWS
from lta_control.laws.aboard import CASCADE
from lta_control.per_rotor import NONE, slots
from lta_control.strategies import bearing_angle
from lta_flight.fleet.numbers import Craft, Goal, Power
from lta_flight.fleet.targets import Rhythm, STEP
from lta_flight.policy import Policy
from lta_model.effects import EFFECTS
from lta_model.effects.protocol import MeasurementEffect
from lta_model.electrical.loads import navigating
from lta_model.hull import half_axes
from lta_model.light.panel_light import plane_of
from lta_model.light.setting import set_for
from lta_model.model import Model
from lta_model.scenario import Scenario
from lta_model.sensors.imu import bounds_of, ImuSettings
from lta_model.sensors.pressure import PressureSettings
from lta_model.sensors.range import RangeSettings
from lta_model.vehicle import Vehicle
from lta_sim.counted_light import listening_of
from lta_sim.counted_sensors import Axes, Sensors, Six
from lta_sim.in_scene import model_in
from lta_sim.supply_step import Parts
from lta_vlc.diodes import diodes_of
from lta_vlc.direction import array_of, expected_of

UNHEARD = ('pose', 'pose_time', 'clock')  # channels that decide nothing of a flight


@final
@dataclass(frozen=True, slots=True)
class Made:
    """
    One flight of a batch.

    Attributes
    ----------
    model : Model
        The vehicle.
    numbers : list of float
        Of its `Craft`, in the order of its layout.
    form : str
        What kind of number each is; flights of one form share a text.
    craft : Craft
        The constants.
    name : str
        Of the vehicle.

    """

    model: Model
    numbers: list[float]
    form: str
    craft: Craft
    name: str


def rhythm_of(table: TopicTable) -> Rhythm:
    """Return when what is due; `BadInput` if a period is no whole number of steps."""
    step_ns = round(STEP * 1e9)
    control = table.control_ns
    due = {name: table[name].period_ns for name in ('range', 'pressure', 'photodiodes')}
    if control % step_ns or due['range'] % step_ns or due['photodiodes'] % (2 * control):
        raise BadInput(
            f'A batch flies in steps of {1e3 * STEP:g} ms, and the periods {control} ns of '
            f'control and {due} ns of sensors do not fit it; change topics.yaml.'
        )
    return Rhythm(
        control // step_ns,
        due['range'] // step_ns,
        due['pressure'] // control,
        due['photodiodes'] // control,
    )


def check(vehicle: Vehicle, scenario: Scenario, policy: Policy) -> Model:
    """
    Return the model of a vehicle in a scene that a batch can fly.

    Raises
    ------
    BadInput
        If it needs what a batch does not have.

    """
    if policy.strategy is not bearing_angle.STRATEGY:
        raise BadInput(
            f'A batch knows the strategy bag only, not {policy.strategy.name}; leave --device out.'
        )
    if policy.law is not LAWS[CASCADE]:
        raise BadInput(
            f'A batch knows the control law {CASCADE} only, not {policy.law.name}, which '
            f'{vehicle.file.name} names; leave --device out.'
        )
    if policy.course is not None or scenario.course is not None:
        raise BadInput('A batch flies to the lamp, not along a course; leave --device out.')
    if scenario.start.held.si > 0.0:
        raise BadInput(
            f'A batch lets go of the drone at once, and the scenario {scenario.name} holds it for '
            f'{scenario.start.held.si:g} s; leave --device out.'
        )
    if len(scenario.lamps) > 1:
        raise BadInput(
            f'A batch knows one lamp, and the scenario {scenario.name} has '
            f'{len(scenario.lamps)}; leave --device out.'
        )
    if scenario.outside is not None:
        raise BadInput(
            f'A batch knows no door, which the scenario {scenario.name} has; leave --device out.'
        )
    if scenario.wind_file is not None:
        raise BadInput(
            f'A batch does not know recorded wind, which the scenario {scenario.name} has; leave '
            '--device out.'
        )
    model = model_in(vehicle, scenario)
    for name in model.given:
        effect = EFFECTS[name]
        if isinstance(effect, MeasurementEffect) and effect.channel not in UNHEARD:
            raise BadInput(
                f'A batch has no effect {name} of measurement or command; leave --device out.'
            )
    vehicle.check_step(STEP, model)
    return model


def made_of(
    vehicle: Vehicle,
    scenario: Scenario,
    policy: Policy,
    table: TopicTable,
    duties: Sequence[float] = (),
) -> Made:
    """
    Return a flight of a batch.

    Parameters
    ----------
    vehicle, scenario, policy : Vehicle, Scenario, Policy
        What is flown where and how.
    table : TopicTable
        Periods and block shape.
    duties : sequence of float
        Of each rotor, where the drone does not decide.

    """
    model = check(vehicle, scenario, policy)
    craft = craft_of(vehicle, scenario, policy, table)
    place = model.given.get('moving_mass', {})
    craft = craft._replace(
        mass_place=(place.get('x', 0.0), place.get('y', 0.0), place.get('z', 0.0)),
        duties=slots(duties),
    )
    return made_from(model, craft, vehicle)


def made_from(model: Model, craft: Craft, vehicle: Vehicle) -> Made:
    """Return a flight from its constants."""
    numbers: list[float] = []
    form: list[str] = []
    take(bare(craft), numbers, form)
    return Made(model, numbers, ''.join(form), craft, vehicle.file.name)


def craft_of(vehicle: Vehicle, scenario: Scenario, policy: Policy, table: TopicTable) -> Craft:
    """Return the constants of a flight; the drone knows its file in standard air, as a node."""
    start, light = scenario.start, table.light
    x, y = start.position.vector
    drone = drone_of(
        Vehicle(vehicle.file),
        policy.estimator,
        cast('CascadeGains', policy.gains),  # of the cascade: `check`
        table.control_ns * 1e-9,
        policy.tilt_limit,
    )
    rate, samples = light.sample_rate.si, light.samples
    return Craft(
        drone=drone,
        mission=policy.mission,
        sensors=sensors_of(vehicle, scenario.air.pressure.si),
        listening=listening_of(
            scenario.light_field,
            set_for(scenario.light_field, vehicle),
            half_axes(vehicle.file.hull),
            policy.demodulation,
            rate,
            samples,
        ),
        array=array_of(diodes_of(vehicle.file.sensors.diodes)),
        expected=expected_of(policy.prior),
        goal=goal_of(scenario),
        power=power_of(vehicle, scenario, policy),
        place=(x, y, vehicle.standing_height),
        heading=start.heading.si,
        spread=start.heading_spread.si,
        wind=three(scenario.air.wind.vector),
        lowest=slots(-1.0 if reverses else 0.0 for reverses in vehicle.reversible),
        mass_place=(0.0, 0.0, 0.0),
        duties=NONE,
    )


def take(value: Any, numbers: list[float], form: list[str]) -> None:  # noqa: ANN401 - any nest
    """Collect the numbers of a nest of tuples, and what each is."""
    if isinstance(value, tuple):
        form.append('(')
        for item in value:
            take(item, numbers, form)
        form.append(')')
        return
    numbers.append(float(value))
    form.append('b' if isinstance(value, bool) else 'i' if isinstance(value, int) else 'f')


def sensors_of(vehicle: Vehicle, floor: float) -> Sensors:
    """Return the sensors of a vehicle over a floor of some pressure. [Pa]"""
    bounds, ranger, barometer = bounds_of(ImuSettings()), RangeSettings(), PressureSettings()
    sensors = vehicle.file.sensors
    axes = Axes(
        gain=six(bounds.gain),
        offset=six(bounds.offset),
        noise=six(bounds.noise),
        step=six(bounds.step),
        full_scale=six(bounds.full_scale),
    )
    return Sensors(
        imu=axes,
        imu_place=three(sensors.imu_position.vector),
        range_place=three(sensors.range_position.vector),
        nearest=ranger.minimum,
        farthest=ranger.maximum,
        range_noise=ranger.noise,
        range_offset=ranger.offset,
        floor=floor,
        pressure_noise=barometer.noise,
        pressure_offset=barometer.offset,
        drift=barometer.drift,
        resolution=barometer.resolution,
    )


def goal_of(scenario: Scenario) -> Goal:
    """Return how a flight in a scene ends."""
    length, width, height = scenario.room.size.vector
    x, y, _ = scenario.goal_lamp.position.vector
    goal = scenario.goal
    return Goal(x, y, goal.radius.si, goal.time_limit.si, length / 2, width / 2, height)


def power_of(vehicle: Vehicle, scenario: Scenario, policy: Policy) -> Power:
    """Return the electricity of a vehicle in a scene."""
    field = scenario.light_field
    lamp, ambient = field.lamp, field.ambient
    return Power(
        Parts(vehicle.battery, vehicle.charger, vehicle.panel),
        vehicle.loads,
        navigating(vehicle.file.energy, policy.strategy.name),
        plane_of(
            half_axes(vehicle.file.hull), vehicle.file.panel_place, vehicle.file.panel_normal
        ),
        lamp.wave.duty / lamp.efficacy,
        ambient.steady / ambient.efficacy,
        0.0 if field.daylight is None else 1.0 / field.daylight.efficacy,
        policy.energy.reserve,
        scenario.start.charge.si,
    )


def six(values: Sequence[float]) -> Six:
    """Return six numbers."""
    a, b, c, d, e, f = map(float, values)
    return a, b, c, d, e, f


def three(vector: Sequence[float]) -> tuple[float, float, float]:
    """Return three numbers."""
    x, y, z = map(float, vector)
    return x, y, z
