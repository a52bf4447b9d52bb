"""Robots of one launch keep together, whatever order they run in, and none waits for ever."""

from hypothesis import given
from hypothesis import strategies as st
from lta_graph.ros.peer_listener import Peers

S, MS = 10**9, 10**6
START, STEP, LEAD = S, 10 * MS, 100 * MS


def test_who_is_ahead_waits_by_hand():
    peers = Peers(['lta2'], START, LEAD)
    assert peers.find_lagging(START + LEAD) == []  # before anybody has spoken
    assert peers.find_lagging(START + LEAD + STEP) == ['lta2']
    assert not peers.has_started('lta2')
    peers.record_pulse('lta2', START + LEAD)
    assert peers.has_started('lta2')
    assert peers.find_lagging(START + 2 * LEAD) == []
    assert peers.find_lagging(START + 2 * LEAD + STEP) == ['lta2']
    peers.record_pulse('lta2', START)  # late: time does not go back
    assert peers.find_lagging(START + 2 * LEAD) == []
    peers.mark_ended('lta2')
    peers.mark_ended('lta2')
    assert peers.find_lagging(START + 100 * LEAD) == []
    assert peers.active_robots == []


def test_who_has_no_peers_never_waits():
    alone = Peers([], START, LEAD)
    assert alone.find_lagging(START + 10**6 * LEAD) == []
    assert alone.common_time(START) == START


def test_the_time_goes_on_with_the_last_that_flies():
    peers = Peers(['lta2', 'lta3'], START, LEAD)
    peers.record_pulse('lta2', START + 3 * S)
    peers.record_pulse('lta3', START + 5 * S)
    assert peers.common_time(START + 4 * S) == START + 4 * S
    peers.mark_ended('lta2')
    assert peers.common_time(START + 4 * S) == START + 5 * S
    peers.mark_ended('lta3')
    assert peers.common_time(START + 4 * S) == START + 4 * S


@given(st.integers(2, 4), st.randoms(use_true_random=False), st.lists(st.integers(1, 60)))
def test_no_order_of_steps_and_pulses_makes_them_drift_or_stand_still(count, chance, ends):
    """Each takes its steps and hears the others' pulses, however late, in any order."""
    names = [f'lta{i}' for i in range(count)]
    peers = {
        name: Peers([other for other in names if other != name], START, LEAD) for name in names
    }
    now = dict.fromkeys(names, START)
    end = {name: START + STEP * (ends[i] if i < len(ends) else 60) for i, name in enumerate(names)}
    mail = {(to, by): [START] for to in names for by in names if to != by}
    over: set[str] = set()
    while len(over) < count:
        able = [
            name for name in names
            if name not in over and not peers[name].find_lagging(now[name] + STEP)
        ]  # fmt: skip
        waiting = [pair for pair, stamps in mail.items() if stamps]
        assert able or waiting, 'all wait for one another'
        if waiting and (not able or chance.random() < 0.5):
            to, by = chance.choice(waiting)
            peers[to].record_pulse(by, mail[to, by].pop(0))
            continue
        name = chance.choice(able)
        now[name] += STEP
        for other in set(names) - {name}:
            if (now[name] - START) % LEAD == 0:
                mail[other, name].append(now[name])
            if now[name] == end[name]:
                over.add(name)
                peers[other].mark_ended(name)
        flying = [now[each] for each in names if each not in over]
        assert max(flying, default=0) - min(flying, default=0) <= 2 * LEAD - STEP
    assert now == end
