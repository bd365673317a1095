"""The page of a scene in words: what is asked, the formulas, the units and the columns of the answer."""

from __future__ import annotations

from dataclasses import asdict

from contact_scene import Scene, Step
from validation.cases import Case
from validation.exam.tags import tags

COLUMNS = {
    "time": "time, 0 at the start state; never falls, two rows of equal time are a jump",
    "penetration": "D, positive downwards: the lowest point of the indenter is at D below the free surface",
    "force": "F, compression positive, tension negative",
    "contact_radius": "a, a radius; 0 once contact is lost",
    "stored_energy": "elastic energy of the half-space, in all branches of the material",
    "external_work": "integral of F dD from the start, jumps included; 0 in the first row",
    "dissipated_energy": "viscous loss from the start: external work + work of adhesion * change of contact "
    "area - change of stored energy",
}
HOW_TO_ANSWER = """\
Write `trace.csv` into the folder of the scene (or of the same name anywhere below the folder that is judged):

```
# code: my code
# version: 1.0
# author: who
# resolution: 128
# seconds: 3.2
time,penetration,force,contact_radius
0.0,0.0,0.0,0.0
```

Only `code` is needed above the columns, `time` and one more column below. `seconds` is the run time, for the
figure of error against run time; `resolution` tells several answers of one code apart, the files of which are
`trace-64.csv`, `trace-128.csv`, ... Where contact is lost, write the last row in contact and, at the same
time, a row with contact radius 0. Columns:

""" + "\n".join(f"- `{name}`: {text}" for name, text in COLUMNS.items())
FORMULAS = """\
The half-space is linear viscoelastic with relaxation modulus `E(t) = modulus + sum_k branches[k].modulus *
exp(-t/branches[k].time)` (Young's modulus; times are relaxation times) and constant Poisson's ratio `nu`;
where a modulus of the surface is needed it is `E* = E/(1 - nu^2)`. Contact is frictionless, axisymmetric, a
full disc of radius `a(t)`, within small slopes: the surface under the indenter is displaced downwards by
`D - f(r)`."""
ADHESION = """\
Adhesion acts within a process zone of length `da` (`zone`) at the contact edge: at every instant the edge is
where

    (1/(2 da)) * integral from a - da to a of sigma(r) g(r + da) dr = work,

`sigma` the tension inside the contact, `g` the gap outside. The zone is part of the model, not of the
discretisation. Where the integral is larger the edge recedes, where it is smaller it advances; of several
roots that one holds at which it rises with `a`. Contact is lost where there is none."""
LAWS = {
    "work_closing": """\
An edge advances only where the integral falls to `work_closing`; between that and `work` it is pinned. The
contact of the start state has been made by closing. An area that closes gives `work_closing` back, and
`dissipated_energy` counts it so; what is lost at the edge is no part of it.""",
    "rate": """\
`work` is what an edge at rest takes up. An edge that recedes at speed `v` takes up `w(v)` of `rate`: `work *
(1 + (v/speed)^exponent)`, or a table `speeds`, `works`, straight from rest to its first row, straight in the
logarithms between its rows, constant beyond. `dissipated_energy` counts it as spent at the edge.""",
    "stress": """\
The zone has no fixed length: it is the one over which the mean tension of the sharp edge is `4/pi` times
`stress`.""",
}
NO_ADHESION = "The pressure is nowhere negative, and contact is lost where it would be."
SPRING = """\
The indenter hangs on a spring of `stiffness = {stiffness!r}`. What is said of the penetration below holds of
the stage `X = D + F/stiffness` instead, `external_work` is that of the stage, contact is lost where there
is no equilibrium at that stage, and what the spring stores, `F^2/(2 stiffness)`, is no part of
`dissipated_energy`."""
SHAPES = {
    "sphere": "A paraboloid `f(r) = r^2/(2 R)`, `R = {radius!r}`.",
    "cone": "A cone `f(r) = r cot(alpha)`, half angle `alpha = {half_angle!r}` degrees.",
    "flat-punch": "A flat-ended cylinder of radius `{radius!r}`; contact never goes beyond it.",
    "power-law": "`f(r) = c r^n`, `c = {coefficient!r}`, `n = {exponent!r}`.",
    "profile": "A profile through the points `radii`, `heights` of `scene.json`: cubic Hermite curve with "
    "three-point slopes, each limited to three times the smaller neighbouring secant, straight "
    "beyond the last point.",
}
"""Profiles ``f(r)``, the height above the lowest point, by the shape of the indenter."""
STEPS = {
    "ramp": "the penetration goes linearly to `{to!r}` at speed `{rate!r}`; the run ends where contact is "
    "lost",
    "hold": "the penetration stays for `{duration!r}`",
    "force": "the force jumps to `{value!r}` and stays for `{duration!r}`; the penetration is free",
    "force-ramp": "the force goes linearly to `{to!r}` at `{rate!r}` per time; the penetration is free",
    "oscillate": "`D = D_start + {amplitude!r} sin({angular_frequency!r} t) - {drift!r} t` for "
    "`{duration!r}`, `t` from the start of the step",
    "sweep": "`D = D_start + {amplitude!r} sin({chirp!r} t^2/2)` for `{duration!r}`, `t` from its start",
    "table": "the {quantity} goes through `times`, `values` of `scene.json`; interpolation {interpolation} "
    "(linear: straight lines; cubic: monotone cubic pieces, PCHIP)",
    "approach": "the penetration grows at speed `{rate!r}`, to `{to!r}` at most, until the force is "
    "`{force!r}`, stays for `{dwell!r}`, and goes at speed `{retract!r}` to `{away!r}`",
}
"""Load steps by their kind."""


def page(case: Case) -> str:
    """The page as Markdown."""
    scene, adhesion = case.scene, case.scene.adhesion
    parts = [
        f"# {scene.title or case.name}",
        case.statement,
        f"Tags: {', '.join(tags(scene))}. All numbers are in one consistent system of units, and so is the "
        "answer.",
        *("## Material", FORMULAS, _material(scene)),
        *("## Indenter", SHAPES[scene.indenter.shape].format(**vars(scene.indenter))),
    ]
    if adhesion is not None and scene.is_adhesive:
        values = ", ".join(f"`{name} = {value!r}`" for name, value in asdict(adhesion).items() if value)
        laws = [text for name, text in LAWS.items() if getattr(adhesion, name) is not None]
        parts += ["## Adhesion", ADHESION, *laws, values + "."]
    else:
        parts += ["## No adhesion", NO_ADHESION]
    if scene.machine is not None and scene.loading.compliance > 0.0:
        parts += ["## Machine", SPRING.format(stiffness=scene.machine.stiffness)]
    state = "glassy" if scene.loading.start == "jump-in" else "fully relaxed"
    depth = scene.loading.penetration
    steps = "\n".join(f"{i}. {_step(step)}" for i, step in enumerate(scene.loading.steps, 1))
    parts += [
        "## Loading",
        f"At `t = 0` the contact is in {state} equilibrium at penetration `{depth!r}`. Then:",
        steps or "1. nothing: the start state alone is asked for",
        *("## The answer", HOW_TO_ANSWER),
    ]
    return "\n\n".join(filter(None, parts)) + "\n"


def _material(scene: Scene) -> str:
    material = scene.material
    branches = "".join(f"\n- modulus {b.modulus!r}, time {b.time!r}" for b in material.branches)
    relaxes = f" Branches:\n{branches}" if branches else " It has no branches: it is elastic."
    glassy = f"glassy modulus E(0) = {material.glassy_modulus!r}"
    return f"`modulus = {material.modulus!r}` (relaxed), `poisson = {material.poisson!r}`; {glassy}.{relaxes}"


def _step(step: Step) -> str:
    end = None if step.kind == "approach" else step.trigger
    level = "" if end is None else f"; the step ends as soon as the {end.quantity} is `{end.level!r}`"
    return STEPS[step.kind].format(**vars(step)) + level
