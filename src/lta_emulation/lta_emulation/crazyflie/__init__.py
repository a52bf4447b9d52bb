"""
A Crazyflie that speaks CRTP over UDP, for tests and for whoever has none.

It agrees with firmware 2026.08 (protocol 12) in what a bridge can see: the handshake, the tables
of variables and parameters, log blocks, setpoints, the supervisor and its time-outs. It is no
firmware: the body that it flies is the simulator's, and its controller is LTA's.
"""
