"""
Mutants that no test can see, each with its reason: they count for nothing.

By file, line before and line after; what is not certain stands among the survivors instead.
"""

from typing import Final

Line = tuple[str, str, str]

DISCOVERY: Final = 'src/lta_discovery/lta_discovery/'
EQUAL: Final[dict[Line, str]] = {
    (
        f'{DISCOVERY}discrepancies/conditions.py',
        'share = (1 + np.sum(by_chance >= won[best])) / (DRAWS + 1)',
        'share = (1 + np.sum(by_chance >= won[best])) / (DRAWS + 2)',
    ): 'It is compared with 0.01: 2 / 200 and 2 / 201 pass, 3 / 200 and 3 / 201 do not.',
    (
        f'{DISCOVERY}replay/sensing.py',
        'up = np.broadcast_to(np.array([0.0, 0.0, 1.0]), (*states.shape[:-1], 3))',
        'up = np.broadcast_to(np.array([0.0, 0.0, 1.0]), (*states.shape[:- 0], 3))',
    ): 'It is one vector instead of one for each state: numpy broadcasts it later as well.',
    (
        f'{DISCOVERY}flights/sentence_merger.py',
        'if len(names) == 1 and (len(sentences) == 1 or rests[0].startswith(IS)):',
        'if len(names) == 1 and (len(sentences) == 1 or rests[ -1].startswith(IS)):',
    ): 'Only sentences of one pattern are joined: the last rest starts with IS if the first does.',
    (
        'src/lta_bridge/lta_bridge/crazyflie/log_table.py',
        '15: {0: 0, 1: 0, 2: 0, 3: 0}, # link: echo, source, sink, null',
        '15: {0: 0, 1: 0, 2: -1, 3: 0}, # link: echo, source, sink, null',
    ): 'It is the least size, and no packet has fewer than 0 bytes.',
    (
        'src/lta_control/lta_control/autopilot.py',
        'HEARD = TupleLayout(SensorInputs((0.0, 0.0, 0.0), (0.0, 0.0, 0.0)))',
        'HEARD = TupleLayout(SensorInputs((0.0, 0.0, -1.0), (0.0, 0.0, 0.0)))',
    ): 'A layout depends on the structure and types of its example, not on the values.',
    (
        'src/lta_control/lta_control/mission.py',
        'return mission._replace(asked=mission.leg + 1, turns=0, heard=0)',
        'return mission._replace(asked=mission.leg + 1, turns=0, heard= -1)',
    ): 'The next turn sets the count to 0 before anything reads it: `SWITCHING` turns must pass.',
    (
        'src/lta_energy/lta_energy/mission.py',
        'self._charge_until(self.now + STEP, 0.0, OUT)',
        'self._charge_until(self.now + STEP, 1.0, OUT)',
    ): 'The load is that of one step, in which the supply has failed and feeds none.',
    (
        'src/lta_energy/lta_energy/mission.py',
        'self._seen += (light.sun / due - self._seen) * min(dt / HOUR, 1.0)',
        'self._seen += (light.sun / due - self._seen) * min(dt / HOUR, 2.0)',
    ): 'The light is looked at every 30 s at least, so that the share stays below 1 either way.',
    (
        'src/lta_energy/lta_energy/monitoring/monitor.py',
        'return 0.0 if beyond else abs(surprise.innovation) / surprise.deviation',
        'return -1.0 if beyond else abs(surprise.innovation) / surprise.deviation',
    ): 'The value is only compared with 5: 0 and -1 are both below.',
    (
        'src/lta_model/lta_model/effects/sensors.py',
        'return (values[0] - delay,)',
        'return (values[ -1] - delay,)',
    ): '`values` has one element here, the time of the pose: its first is its last.',
    (
        'src/lta_model/lta_model/light/lamp.py',
        'phase: float = 0.0',
        'phase: float = -1.0',
    ): 'A phase is a part of a cycle: a whole cycle earlier the wave is the same.',
    (
        'src/lta_vlc/lta_vlc/spectral/tone.py',
        'cosine, sine, off = np.zeros(3), np.zeros(3), np.zeros(3)',
        'cosine, sine, off = np.zeros(3), np.zeros( 4), np.zeros(3)',
    ): 'All loops run over three elements: the fourth is neither written nor read.',
}
