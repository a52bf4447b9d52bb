"""The navigator node: from what the light says to heading, altitude and speed."""

from collections import deque

from lta_config.settings import setting
from lta_control.cascade import Setpoint
from lta_control.messages import (
    from_setpoint,
    heard_word,
    to_diodes,
    to_lamp,
    to_measured,
    to_reckoned,
)
from lta_control.mission import course_step, mission_step, MissionSettings
from lta_control.obedience import check_reserve
from lta_control.phases import Mission, Phase
from lta_control.reserve import because, Order, order_of, ReserveSettings, Word
from lta_control.sighting import Reckoned, sighted
from lta_control.strategies import check_route, strategy
from lta_control.strategies.protocol import Sight
from lta_graph.health import Level
from lta_graph.inbox import Step
from lta_graph.ros.node import GraphNode
from lta_graph.ros.parameters import Parameters
from lta_graph.ros.process import run
from lta_graph.ros.sound import fault
from lta_graph.ros.stamps import from_stamp
from lta_model.light.setting import scale_in
from lta_model.scenario import course_in, route_in
from lta_vlc.wish import NO_WISH
from nav_msgs.msg import Odometry
from std_msgs.msg import Float64


class NavigatorParameters(MissionSettings):
    """The mission and its strategy."""

    vehicle: str = setting('gtmab', 'Vehicle name or file.', fixed=True)
    strategy: str = setting('bag', 'Navigation strategy.', fixed=True)
    scenario: str = setting(
        '', 'Scenario whose course or route is flown, if it has one.', fixed=True
    )
    reserve: ReserveSettings = setting(ReserveSettings(), 'What the energy makes of it.')


class Navigator(GraphNode):
    """Answer each light estimate with setpoints."""

    def __init__(self) -> None:
        super().__init__('navigator')
        self._pose = self.output('setpoint/pose')
        self._velocity = self.output('setpoint/velocity')
        self._beacon = self.output('light/beacon')
        self._settings = Parameters(self, NavigatorParameters)
        self._strategy = strategy(self._settings.value.strategy)
        self._course = course_in(self._settings.value.scenario)
        self._route = route_in(self._settings.value.scenario)
        check_route(self._strategy, len(self._route))
        self._scale = 1.0
        if self._strategy.ranges:
            self._scale = scale_in(self._settings.value.scenario, self._settings.value.vehicle)
        self._begun_ns: int | None = None
        self._mission = Mission()
        check_reserve(self._settings.value.reserve, self._strategy)
        self._word: Word | None = None  # of the energy; unknown: stay down
        light = self.table['photodiodes']
        self._block_ns = light.period_ns
        self._history: deque[Odometry] = deque(maxlen=3 * self._block_ns // self.table.control_ns)
        inputs = self.table.read_by('navigator')
        self.listen(inputs, trigger='light/estimate', on_step=self._on_step)

    def _on_step(self, step: Step) -> None:
        self._history.extend(odom for odom in step.messages['odom'] if not fault(odom))
        self._word = heard_word(self._word, step)
        if not self._history and not self.lockstep:
            return  # the first light may come before the first estimate; in lockstep all answer
        estimate = step.last('light/estimate')
        measured = to_measured(self._history[-1]) if self._history else None
        altitude = None if measured is None or self._word is None else measured.altitude
        setpoint = self._steered(step, altitude)
        pose, velocity = from_setpoint(estimate.header.stamp, setpoint)
        self._pose.publish(pose)
        self._velocity.publish(velocity)
        self._beacon.publish(Float64(data=self._wish))

    @property
    def _wish(self) -> float:
        """The frequency to listen for next. [Hz]"""
        return self._route[self._mission.asked][1] if self._route else NO_WISH

    def _steered(self, step: Step, altitude: float | None) -> Setpoint:
        """Return what to hold, and say what for."""
        sight, settings = self._sight(step), self._settings.value
        order = order_of(settings.reserve, self._word, step.stamp_ns)
        if self._course is not None:
            self._begun_ns = step.stamp_ns if self._begun_ns is None else self._begun_ns
            time = (step.stamp_ns - self._begun_ns) * 1e-9
            self._tell('course', order, step.stamp_ns)
            return course_step(self._course, time, sight.heading, altitude, order)
        setpoint, self._mission = mission_step(
            settings, self._strategy, self._mission, sight, altitude, order,
            max(len(self._route), 1), settings.reserve,
        )  # fmt: skip
        self._tell_mission(order, step.stamp_ns)
        return setpoint

    def _tell(self, doing: str, order: Order, now_ns: int) -> None:
        """Say what the drone is doing, and where the energy forbids more, why."""
        if order is Order.FLY:
            self.health.report('mission', Level.OK, doing)
            return
        why = because(self._settings.value.reserve, self._word, now_ns)
        resting = self._mission.phase is Phase.REST and self._course is None
        text = f'no take-off: {why}' if resting else f'{doing}: {why}'
        level = Level.ERROR if order is Order.DOWN else Level.WARN
        self.health.report('mission', level, text)

    def _tell_mission(self, order: Order, now_ns: int) -> None:
        """Say what the drone is doing, and which lamp it is about."""
        mission = self._mission
        if not self._route or order is not Order.FLY:
            self._tell(str(mission.phase), order, now_ns)
            return
        (here, _), (wanted, frequency) = self._route[mission.leg], self._route[mission.asked]
        level, text = Level.OK, f'{mission.phase}: {here}'
        if mission.refused:
            following, beat = self._route[mission.leg + 1]
            level = Level.WARN
            text = f'{following} at {beat:g} Hz is not heard; staying at {here}'
        self.health.report(
            'mission', level, text, lamp=here, listening_for=f'{wanted} at {frequency:g} Hz'
        )

    def _sight(self, step: Step) -> Sight:
        """Return the light with the drone's motion at the middle of its block."""
        middle = step.stamp_ns + self._block_ns // 2
        then = min(
            self._history, key=lambda m: abs(from_stamp(m.header.stamp) - middle), default=None
        )
        axes, amplitudes = to_diodes(step.last('light/peaks'))
        return sighted(
            to_lamp(step.last('light/estimate')),
            axes,
            amplitudes,
            Reckoned(0.0, 0.0, 0.0, 0.0, 0.0) if then is None else to_reckoned(then),
            self._block_ns * 1e-9,
            self._scale,
        )


def main(args: list[str] | None = None) -> None:
    """Run the node until it is told to stop."""
    run(Navigator, args)
