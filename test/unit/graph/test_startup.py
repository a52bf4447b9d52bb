"""A node that waits for a quiet graph goes on reporting, so that nobody calls it silent."""

from contextlib import nullcontext
from itertools import pairwise
from types import SimpleNamespace

from lta_graph.ros import node, startup
from lta_graph.ros.listener import SILENCE
from lta_graph.ros.node import GraphNode


class QuietNode(GraphNode):
    """A node without ROS, in a graph that does not change."""

    def __init__(self, clock):
        self.clock, self.reports, self._reported = clock, [], 0.0
        self.running, self.table = True, SimpleNamespace(topics=['imu'])

    def count_publishers(self, _):
        return 1

    def count_subscribers(self, _):
        return 2

    def count_readers(self):
        return {}

    def publish_health(self):
        self._reported = self.clock[0]
        self.reports.append(self._reported)


def test_a_node_reports_while_it_waits(monkeypatch):
    now = [100.0]
    for module in (node, startup):
        monkeypatch.setattr(module, 'time', SimpleNamespace(monotonic=lambda: now[0]))
    links = SimpleNamespace(find_unready_topics=lambda _readers, _awaited: [])
    monkeypatch.setattr(startup, 'ReaderLinks', lambda _node, _table: nullcontext(links))
    waiting = QuietNode(now)
    for pause in startup.wait_until_settled(waiting, (), 20.0):
        now[0] += pause.duration
    assert now[0] - 100.0 >= startup.SETTLED
    times = [100.0, *waiting.reports, now[0]]
    assert max(b - a for a, b in pairwise(times)) < 0.5 * SILENCE
