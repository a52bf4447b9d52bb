# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Messages meet the partner with their stamp, or for a while the last one."""

from types import SimpleNamespace

from lta_graph.ros.stamps import MessagePairing, OLDEST_STAND_IN_NS, to_stamp


def stamped(*stamps_ns):
    return [SimpleNamespace(header=SimpleNamespace(stamp=to_stamp(at))) for at in stamps_ns]


def test_messages_meet_the_partner_with_their_stamp():
    pairing, messages, partners = MessagePairing(), stamped(10, 20, 30), stamped(10, 20, 30, 40)
    assert pairing.pair_messages(messages, partners) == [
        (at, message, partner)
        for at, message, partner in zip((10, 20, 30), messages, partners, strict=False)
    ]
    (later,) = stamped(40)
    assert pairing.pair_messages([later], []) == [(40, later, partners[3])]


def test_the_last_partner_stands_in_for_a_while():
    pairing, (first, second) = MessagePairing(), stamped(1_000_000_000, 1_010_000_000)
    assert pairing.pair_messages([first], []) == [(1_000_000_000, first, None)]
    (partner,) = stamped(1_010_000_000)
    assert pairing.pair_messages([second], [partner]) == [(1_010_000_000, second, partner)]
    near, far = stamped(1_010_000_000 + OLDEST_STAND_IN_NS, 1_010_000_001 + OLDEST_STAND_IN_NS)
    assert [found for _, _, found in pairing.pair_messages([near, far], [])] == [partner, None]


def test_partners_without_a_message_are_forgotten():
    pairing, (late,) = MessagePairing(), stamped(50)
    pairing.pair_messages(stamped(20), stamped(10, 20))
    (_, _, found), *_ = pairing.pair_messages(stamped(10), [late])
    assert found.header.stamp.nanosec == 20
