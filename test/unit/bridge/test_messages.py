"""What discovery tells of publishers, as a bag tells it."""

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from lta_bridge.bag import build_offered_qos
from lta_bridge.messages import parse_statuses, to_offered_qos
from rclpy.duration import Duration, Infinite
from rclpy.qos import (
    DurabilityPolicy,
    HistoryPolicy,
    LivelinessPolicy,
    QoSProfile,
    ReliabilityPolicy,
)

FOREVER = {'sec': 9223372036, 'nsec': 854775807}


def discovered(**changes):
    """Return a profile as Fast DDS tells it of a publisher: without history and depth."""
    return QoSProfile(
        **{
            'history': HistoryPolicy.UNKNOWN,
            'depth': 0,
            'reliability': ReliabilityPolicy.RELIABLE,
            'durability': DurabilityPolicy.VOLATILE,
            'liveliness': LivelinessPolicy.AUTOMATIC,
            'deadline': Infinite,
            'lifespan': Infinite,
            'liveliness_lease_duration': Infinite,
            **changes,
        }
    )


def test_a_publisher_that_keeps_to_the_table_has_its_history_and_depth():
    assert to_offered_qos([discovered()], QoSProfile(depth=7)) == [
        build_offered_qos('reliable', 'volatile', 7)
    ]


def test_one_that_does_not_is_told_as_it_was_found():
    weak = discovered(reliability=ReliabilityPolicy.BEST_EFFORT)
    (found,) = to_offered_qos([weak], QoSProfile(depth=7))
    assert found == {
        **build_offered_qos('best_effort', 'volatile', 0),
        'history': 'unknown',
    }
    assert to_offered_qos([weak], None) == [found]


def test_each_profile_is_told_once_and_limits_are_kept():
    short = discovered(lifespan=Duration(seconds=10, nanoseconds=5))
    found = to_offered_qos([discovered(), short, discovered()], QoSProfile(depth=7))
    assert [each['lifespan'] for each in found] == [FOREVER, {'sec': 10, 'nsec': 5}]
    assert {each['depth'] for each in found} == {7}


def test_where_nobody_is_there_the_table_speaks():
    expected = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    assert to_offered_qos([], expected) == [build_offered_qos('reliable', 'transient_local', 1)]
    assert to_offered_qos([]) == []


def test_faults_are_statuses_that_are_errors():
    levels = [DiagnosticStatus.OK, DiagnosticStatus.WARN, DiagnosticStatus.ERROR]
    array = DiagnosticArray(
        status=[
            DiagnosticStatus(name=f'node: {n}', hardware_id=('lta1', '')[n % 2], level=level)
            for n, level in enumerate([*levels, DiagnosticStatus.STALE])
        ]
    )
    assert list(parse_statuses(array)) == [
        ('lta1', 'node: 0', False, False),
        ('', 'node: 1', False, False),
        ('lta1', 'node: 2', True, False),
        ('', 'node: 3', False, False),
    ]


def test_an_end_is_told_from_a_fault():
    def status(name, level, **values):
        return DiagnosticStatus(
            name=name,
            hardware_id='lta1',
            level=level,
            values=[KeyValue(key=key, value=value) for key, value in values.items()],
        )

    message = DiagnosticArray(
        status=[
            status('simulator: flight', b'\0', over='True'),
            status('simulator: flight', b'\0', over='False'),
            status('player: playback', b'\0', over='True'),
            status('anything', b'\0', over='True'),
            status('controller: inputs', b'\2'),
            status('recorder: latched', b'\1'),
        ]
    )
    assert [(each.failing, each.over) for each in parse_statuses(message)] == [
        (False, True),
        (False, False),
        (False, True),
        (False, False),
        (True, False),
        (False, False),
    ]
