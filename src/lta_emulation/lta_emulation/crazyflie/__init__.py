# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Emulate a Crazyflie with CRTP over UDP, for tests and for use without hardware.

What a bridge can observe matches firmware 2026.08 (protocol 12): the handshake, the tables of
variables and parameters, log blocks, setpoints, the supervisor and its time-outs. It does not run
the firmware itself: the body is the simulator's, and the controller is LTA's.
"""
