"""Emulated hardware: a Crazyflie and a light board that fly in the simulated world."""

from lta_graph.interrupts import exit_at_once_on_interrupt

exit_at_once_on_interrupt(__name__)
