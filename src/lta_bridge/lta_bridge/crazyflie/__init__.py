"""
The bridge to a Crazyflie: what is read of it, how it is told, and when its motors may turn.

Every module is a core but `cflib_link`, the one place that imports cflib; `links` knows the links
by name.
"""
