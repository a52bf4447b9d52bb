"""Define the rows (kinds of flights) and kinds (hidden effects) of a challenge."""

from dataclasses import dataclass
from typing import Final, final, Literal

from lta_config.errors import unknown_name_error
from lta_discovery.selection.equivalence_classes import Kind as Data

Kind = Literal['clean', 'single', 'pair', 'outside', 'mixed']
# Probabilities of the kinds if none is requested
KINDS: Final[dict[Kind, float]] = {
    'clean': 0.3,
    'single': 0.25,
    'pair': 0.15,
    'outside': 0.15,
    'mixed': 0.15,
}
ALL: Final = ('ground_truth/odom', 'imu', 'range', 'pressure', 'battery')


@final
@dataclass(frozen=True, slots=True)
class ChallengeRow:
    """The kind of flights in a row."""

    about: str  # description
    code: int  # part of the random seed; must never change
    worse: float = 1.0  # factor on tolerances and noise
    topics: tuple[str, ...] = ALL  # recorded topics besides the commands
    courses: tuple[str, ...] = ('laps', 'climbs', 'steps', 'wandering')  # keys of `course.COURSES`
    structured: bool = False  # whether all flights, clean ones included, have a model error
    pushed: bool = False  # whether the vehicle is commanded by a wrench
    # Kind of data that defines which effects count as one
    # (`lta_discovery.selection.equivalence_classes`)
    data: Data = 'all'
    # Whether the flights come from the independent simulator (`lta_challenge.other`)
    independent: bool = False
    # Whether vehicle files and logs are as a laboratory's first ones (`rough_case`)
    rough: bool = False


POSE: Final = ('ground_truth/odom',)
ROWS: Final[dict[str, ChallengeRow]] = {
    'base': ChallengeRow('all sensors (pose, IMU, range, pressure, battery)', 0),
    'worse': ChallengeRow('vehicle tolerances and sensor noise 1.5 times as large', 1, worse=1.5),
    'structured': ChallengeRow(
        'model errors of thrust, pitch moment and yaw moment in every flight', 2, structured=True
    ),
    'pose': ChallengeRow('only pose and commands are recorded', 3, topics=POSE, data='pose'),
    'hover': ChallengeRow('only hovering flights', 4, courses=('hover',), data='hover'),
    'wrench': ChallengeRow(
        'flown by force and moment commands; only pose and commands are recorded',
        5,
        topics=POSE,
        pushed=True,
        data='wrench',
    ),
    'other': ChallengeRow(
        'an independent simulator without equations of the model; swings of 20 degrees; '
        'timestamps as in laboratories',
        6,
        courses=(),
        independent=True,
    ),
    'rough': ChallengeRow(
        'vehicle files wrong by a factor of 0.3 to 3 in one or two numbers; hand releases, starts '
        'on the floor, gaps, spikes in the commands, short flights, lift off by tens of mN',
        7,
        rough=True,
    ),
}


def find_challenge_row(name: str) -> ChallengeRow:
    """Return a row; an unknown name is a `BadInput` that lists the known ones."""
    if name not in ROWS:
        raise unknown_name_error('row', name, list(ROWS))
    return ROWS[name]


def parse_case_kind(name: str) -> Kind:
    """Return a kind; an unknown name is a `BadInput` that lists the known ones."""
    for kind in KINDS:
        if kind == name:
            return kind
    raise unknown_name_error('kind', name, list(KINDS))
