"""Robots of one launch keep together, whatever order they run in, and none waits for ever."""

from hypothesis import given
from hypothesis import strategies as st
from lta_graph.peers import Peers

S, MS = 10**9, 10**6
START, STEP, LEAD = S, 10 * MS, 100 * MS


def test_who_is_ahead_waits_by_hand():
    peers = Peers(['lta2'], START, LEAD)
    assert peers.behind(START + LEAD) == []  # before anybody has spoken
    assert peers.behind(START + LEAD + STEP) == ['lta2']
    assert not peers.begun('lta2')
    peers.hear('lta2', START + LEAD)
    assert peers.begun('lta2')
    assert peers.behind(START + 2 * LEAD) == []
    assert peers.behind(START + 2 * LEAD + STEP) == ['lta2']
    peers.hear('lta2', START)  # late: time does not go back
    assert peers.behind(START + 2 * LEAD) == []
    peers.end('lta2')
    peers.end('lta2')
    assert peers.behind(START + 100 * LEAD) == []
    assert peers.flying == []


def test_who_has_no_peers_never_waits():
    alone = Peers([], START, LEAD)
    assert alone.behind(START + 10**6 * LEAD) == []
    assert alone.now(START) == START


def test_the_time_goes_on_with_the_last_that_flies():
    peers = Peers(['lta2', 'lta3'], START, LEAD)
    peers.hear('lta2', START + 3 * S)
    peers.hear('lta3', START + 5 * S)
    assert peers.now(START + 4 * S) == START + 4 * S
    peers.end('lta2')
    assert peers.now(START + 4 * S) == START + 5 * S
    peers.end('lta3')
    assert peers.now(START + 4 * S) == START + 4 * S


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
            if name not in over and not peers[name].behind(now[name] + STEP)
        ]  # fmt: skip
        waiting = [pair for pair, stamps in mail.items() if stamps]
        assert able or waiting, 'all wait for one another'
        if waiting and (not able or chance.random() < 0.5):
            to, by = chance.choice(waiting)
            peers[to].hear(by, mail[to, by].pop(0))
            continue
        name = chance.choice(able)
        now[name] += STEP
        for other in set(names) - {name}:
            if (now[name] - START) % LEAD == 0:
                mail[other, name].append(now[name])
            if now[name] == end[name]:
                over.add(name)
                peers[other].end(name)
        flying = [now[each] for each in names if each not in over]
        assert max(flying, default=0) - min(flying, default=0) <= 2 * LEAD - STEP
    assert now == end
