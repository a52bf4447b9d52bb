"""
The virtual wind tunnel: a vehicle's drag and rotor wrenches, computed from its shape.

Shape -> mesh -> sweep -> fit -> `<vehicle>.aero.yaml`. `analytic` has the estimates by hand.
OpenFOAM solves the flow; `engine` runs its programs as separate processes.
"""
