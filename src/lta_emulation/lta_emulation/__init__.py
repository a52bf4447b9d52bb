"""Emulated hardware: a Crazyflie and a light board that fly in the simulated world."""
