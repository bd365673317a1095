"""Scenes as a first user writes them, in SI units: `compare` agrees that all three solvers are right."""

from __future__ import annotations

import pytest

from crosscontact.cli import main

GEL = """[material]
modulus = 2e4
poisson = 0.45
branches = [{ modulus = 1e4, time = 0.3 }]
"""
STIFF = """[material]
modulus = 1.8e6
poisson = 0.5
branches = [{ modulus = 2e6, time = 0.1 }, { modulus = 1e6, time = 2.0 }]
"""
SOFT = """[material]
modulus = 1e3
poisson = 0.49
branches = [{ modulus = 2e4, time = 1.0 }]
"""
REST, PULLED = '{ kind = "hold", duration = 2.0 }', '{ kind = "ramp", to = -5e-4, rate = 1e-4 }'
HELD = '{ kind = "ramp", to = 1e-4, rate = 1e-3 }, { kind = "hold", duration = 3.0 }'
BACK = '{ kind = "ramp", to = -1e-5, rate = 1e-3 }'
SCENES = {
    "a ball pressed in and held": (GEL, 'shape = "sphere"\nradius = 5e-3', 1e-5, HELD),
    "a cone comes from above": (GEL, 'shape = "cone"\nhalf_angle = 75', -2e-5, f"{HELD}, {BACK}"),
    "a punch comes from above": (GEL, 'shape = "flat-punch"\nradius = 1e-3', -2e-5, f"{HELD}, {BACK}"),
    "a blunt tip": (GEL, 'shape = "power-law"\nexponent = 4\ncoefficient = 5e7', 0.0, f"{HELD}, {BACK}"),
    "two dead loads": (
        STIFF,
        'shape = "sphere"\nradius = 2e-3',
        1e-6,
        '{ kind = "force", value = 1e-2, duration = 5 }, { kind = "force", value = 1e-3, duration = 5 }',
    ),
    "a dead load that lowers a punch": (
        GEL,
        'shape = "flat-punch"\nradius = 1e-3',
        -1e-5,
        '{ kind = "force", value = 1e-3, duration = 3 }, { kind = "force-ramp", to = 0, rate = 1e-3 }',
    ),
    "a ball on a spring": (
        GEL,
        'shape = "sphere"\nradius = 5e-3',
        0.0,
        f"{HELD}, {BACK}",
        "[machine]\nstiffness = 100\n",
    ),
    "the usual test: until a force, hold, back": (
        GEL,
        'shape = "sphere"\nradius = 5e-3',
        0.0,
        f'{{ kind = "ramp", to = 1e-3, rate = 1e-4, until_force = 1e-3 }}, {REST}, {PULLED}',
        "[adhesion]\nwork = 0.02\nzone = 2e-5\n",
    ),
    "a soft rubber until a force": (
        SOFT,
        'shape = "power-law"\nexponent = 3\ncoefficient = 3e4',
        -1e-5,
        f'{{ kind = "ramp", to = 1e-3, rate = 1e-4, until_force = 3e-5 }}, {REST}, {BACK}',
    ),
}
EXHAUSTIVE = {"a cone comes from above", "a ball on a spring", "a blunt tip", "a soft rubber until a force"}
EXHAUSTIVE |= {"the usual test: until a force, hold, back", "two dead loads"}


@pytest.mark.slow
@pytest.mark.parametrize(
    "name",
    [pytest.param(name, marks=[pytest.mark.exhaustive] * (name in EXHAUSTIVE)) for name in SCENES],
)
def test_compare_agrees_with_right_runs(name, tmp_path, capsys):
    material, indenter, start, steps, *machine = SCENES[name]
    path = tmp_path / "plain.toml"
    loading = f'[loading]\nstart = "relaxed"\npenetration = {start}\nsteps = [{steps}]\n'
    path.write_text("\n".join((material, "[indenter]", indenter, loading, *machine)))
    code = main(["compare", str(path)])
    told = capsys.readouterr().out
    assert "FAIL" not in told
    assert code == 0
