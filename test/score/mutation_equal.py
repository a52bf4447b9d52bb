"""
Mutants that no test can see, each with its reason: they count for nothing.

By file, line before and line after; what is not certain stands among the survivors instead.
"""

from typing import Final

Line = tuple[str, str, str]

EQUAL: Final[dict[Line, str]] = {
    (
        'src/lta_control/lta_control/autopilot.py',
        'HEARD = Layout(Heard((0.0, 0.0, 0.0), (0.0, 0.0, 0.0)))',
        'HEARD = Layout(Heard((0.0, 0.0, -1.0), (0.0, 0.0, 0.0)))',
    ): 'A layout is made of places and kinds of the numbers in its example, not of their values.',
    (
        'src/lta_control/lta_control/mission.py',
        'return mission._replace(asked=mission.leg + 1, turns=0, heard=0)',
        'return mission._replace(asked=mission.leg + 1, turns=0, heard= -1)',
    ): 'The next turn sets the count to 0 before anything reads it: `SWITCHING` turns must pass.',
    (
        'src/lta_energy/lta_energy/mission.py',
        'self._seen += (light.sun / due - self._seen) * min(dt / HOUR, 1.0)',
        'self._seen += (light.sun / due - self._seen) * min(dt / HOUR, 2.0)',
    ): 'The light is looked at every 30 s at least, so that the share stays below 1 either way.',
    (
        'src/lta_sim/lta_sim/effects/tracker_delay.py',
        'return (values[0] - delay,)',
        'return (values[ -1] - delay,)',
    ): 'The time of a pose is a single number: the first is the last.',
    (
        'src/lta_vlc/lta_vlc/modulation.py',
        'phase: float = 0.0',
        'phase: float = -1.0',
    ): 'A phase is a part of a cycle: a whole cycle earlier the wave is the same.',
    (
        'src/lta_vlc/lta_vlc/tone.py',
        'cosine, sine, off = np.zeros(3), np.zeros(3), np.zeros(3)',
        'cosine, sine, off = np.zeros(3), np.zeros( 4), np.zeros(3)',
    ): 'The three bins alone are written and read: every loop over them ends at three.',
}
