"""A good scene file, which tests read as it is or spoil in one place."""

GOOD = """\
title = "good"

[material]
modulus = 0.75
poisson = 0.5
branches = [{ modulus = 6.75, time = 1.0 }, { modulus = 1, time = 10 }]

[indenter]
shape = "sphere"
radius = 1.0

[adhesion]
work = 5.0e-4
zone = 0.013

[loading]
start = "jump-in"
penetration = 0.0

[[loading.steps]]
kind = "ramp"
to = 0.032
rate = 0.002

[[loading.steps]]
kind = "hold"
duration = 1
"""

DOWN_AND_UP = """
title = "Down and up"
[material]
modulus = 0.75
poisson = 0.4
branches = [{ modulus = 2.0, time = 0.3 }]
[indenter]
shape = "sphere"
radius = 1.0
[adhesion]
work = 5.026548e-4
zone = 0.03
[loading]
start = "jump-in"
penetration = 0.012
[[loading.steps]]
kind = "ramp"
to = 0.015
rate = 0.05
[[loading.steps]]
kind = "ramp"
to = -0.5
rate = 0.5
"""
