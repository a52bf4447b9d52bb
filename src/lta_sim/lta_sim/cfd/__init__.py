"""
The wind tunnel: a vehicle's drag, and what its rotors do to it, from its shape.

Shape -> mesh -> sweep -> fit -> `<vehicle>.aero.yaml`. What is known of a flow by hand is in
`analytic`; the flow itself is OpenFOAM's, whose programs `engine` runs and nobody imports.
"""
