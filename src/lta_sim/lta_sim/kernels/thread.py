"""
One vehicle a thread: its constants are a row, all else is in tuples.

Serves the batch on a GPU and whole flights (`lta_flight.batch`) on both targets.
"""

from typing import final

from lta_sim.kernels.layout import EffectLayout, FIXED, format_tuple, indent_lines, ModelStage

# Constant arrays of a vehicle, in the order of the row `fixed`, and those that are tuples
CONSTANTS = ('parameters', 'body', 'inverse')
OUTER = {name: count for name, count in FIXED.items() if name not in CONSTANTS}

# The model, with the arithmetic of states that are tuples
THREAD_MODEL = '''
$INLINE
def ahead(state, rate, dt):
    """Return the state after dt at a constant rate."""
    return $ahead


$INLINE
def mean(a, b, c, d):
    """Return the mean rate of the classical Runge-Kutta step."""
    return $mean


$INLINE
def normalised(state):
    """Return the state with a quaternion of length one."""
    x, y, z, w = state[3:7]
    n = 1.0 / math.sqrt(x * x + y * y + z * z + w * w)
    return state[0:3] + (x * n, y * n, z * n, w * n) + state[7:]


$INLINE
def rates(state, fixed, command, surroundings):
    """Return d/dt of the state."""
$bare
    return $rate
'''


@final
class ThreadAccess:
    """Access of a thread: constants are in the row `fixed`, all else has its own name."""

    loops = False

    def format_number(self, name: str, place: int, layout: EffectLayout, each: int = 0) -> str:
        """Return the source of one number; `each` is unused, because there are no loops."""
        del each
        return (
            f'fixed[{self._row_offset(name, layout) + place}]'
            if name in CONSTANTS
            else f'{name}[{place}]'
        )

    def format_all_numbers(self, name: str, layout: EffectLayout) -> str:
        """Return the source of all numbers of an array."""
        if name not in CONSTANTS:
            return name
        return format_tuple(self.format_number(name, k, layout) for k in range(FIXED[name]))

    def build_template_parts(
        self, parts: list[ModelStage], layout: EffectLayout
    ) -> dict[str, str]:
        """Return all stages in sequence, those of the thrusts, and the arithmetic of states."""
        size = range(layout.size)
        thrusts = [line for part in parts if part.writes == ('u',) for line in part.lines]
        return {
            'ahead': format_tuple(f'state[{k}] + dt * rate[{k}]' for k in size),
            # Same order of operations as in the scalar kernel, so that results agree
            'mean': format_tuple(
                f'(a[{k}] + 2.0 * (b[{k}] + c[{k}]) + d[{k}]) / 6.0' for k in size
            ),
            'bare': indent_lines(line for stage in parts for line in stage.lines),
            'rate': layout.rate_source,
            'actuation': indent_lines(thrusts),
            # Of a vehicle in row i of arrays
            **{
                name: format_tuple(f'{name}_rows[i, {k}]' for k in range(count))
                for name, count in (('state', layout.size), *OUTER.items())
            },
            'stores': indent_lines((f'state_rows[i, {k}] = state[{k}]' for k in size), 3),
        }

    def _row_offset(self, name: str, layout: EffectLayout) -> int:
        counts = {'parameters': layout.parameters, **FIXED}
        return sum(counts[name_before] for name_before in CONSTANTS[: CONSTANTS.index(name)])
