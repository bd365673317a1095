"""Every declared field, given what it cannot be, in Python and in a table: one line with its key."""

from __future__ import annotations

import math
from dataclasses import MISSING, fields
from pathlib import Path

import pytest
from support.wrong_values import WRONG, refusal

import contact_scene
from contact_scene import SceneError
from contact_scene.checked import REQUIRED, Declaration, Tabulated, fields_of, from_table, to_table
from contact_scene.material import MODELS
from contact_scene.temperature_shift import SHIFTS


def reached(*kinds):
    """Classes that a scene, or another of some classes, is made of."""
    found = dict.fromkeys(kinds)
    for kind in kinds:
        for field in fields_of(kind).values():
            found |= dict.fromkeys(reached(*field.kinds, *(field.entries.kinds if field.entries else ())))
    return tuple(found)


KINDS = reached(contact_scene.Scene, *MODELS, *SHIFTS, contact_scene.ShiftTable)
SPECIAL = {
    "Adhesion": {"work": 1.0, "zone": 0.01},
    "StandardLinearSolid": {"relaxed": 1.0, "glassy": 2.0, "time": 1.0},
    "PowerLawRelaxation": {"exponent": 0.5, "modulus": 1.0, "time": 1.0, "range": (0.1, 1.0)},
    "Arrhenius": {"activation_energy": 1.0, "reference_temperature": 300.0},
    "Machine": {"stiffness": 1.0},
    "RateTable": {"speeds": (1.0, 2.0), "works": (1.0, 2.0)},
}
"""Values of classes whose fields are bound to each other."""


def good(field: Declaration):
    """A value that a field takes."""
    if field.rule is not None:
        return min(max(2.0, field.rule.low), field.rule.high)
    if field.words:
        return field.words[0]
    if field.entries is not None:
        return () if field.entries.kinds else (0.0, 1.0, 2.0)
    return made(field.kinds[0]) if field.kinds else "x"


def values(kind):
    """Values of the fields that a class must have."""
    optional = {one.name for one in fields(kind) if one.default is not MISSING}
    return SPECIAL.get(kind.__name__) or {
        name: good(field) for name, field in fields_of(kind).items() if name not in optional
    }


def made(kind):
    """An object of a class."""
    return kind(**values(kind))


def takes(kind, name: str, value) -> bool:
    """Whether a field may be this after all: nothing, a text, a list without entries or one of numbers, or a
    table without keys."""
    field = fields_of(kind)[name]
    if isinstance(value, dict) and field.kinds:
        return all(one.default is not REQUIRED for one in fields_of(field.kinds[0]).values())
    if value is None:
        return field.optional
    if isinstance(value, str):
        return str in field.classes
    if field.entries is not None and not isinstance(value, (float, bool, int, dict)):
        try:
            entries = list(value)
        except TypeError:
            return False
        return not entries or (field.entries.rule is not None and isinstance(entries[0], float))
    return False


CASES = [(kind, name) for kind in KINDS for name in fields_of(kind)]
ids = [f"{kind.__name__}-{name}" for kind, name in CASES]


@pytest.mark.parametrize(("kind", "name"), CASES, ids=ids)
def test_what_a_field_cannot_be_is_one_line(kind, name):
    column = dict(zip(list(fields_of(kind)), getattr(kind, "columns", ()), strict=False)).get(name)
    table = to_table(made(kind))
    for wrong in WRONG.values():
        if not takes(kind, name, wrong):
            assert refusal(kind, **values(kind) | {name: wrong}).key.startswith((name, column or name))
            refusal(from_table, [kind], table | {name: wrong}, Path())


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.__name__)
def test_a_table_gives_its_object_back_takes_no_other_key_and_misses_none(kind):
    table = to_table(made(kind))
    if kind is contact_scene.Scene:
        table["indenter"] = made(contact_scene.Sphere)
    assert from_table([kind], table, Path()) == made(kind)
    with pytest.raises(SceneError, match="unknown key"):
        from_table([kind], table | {"modulos": 1.0}, Path())
    for name in () if issubclass(kind, Tabulated) else values(kind):
        with pytest.raises(SceneError, match=rf"^{name}: is missing; allowed: ."):
            from_table([kind], {key: value for key, value in table.items() if key != name}, Path())


SIGNED = {
    *("Approach.force", "Approach.away", "Force.value", "Force.until_penetration", "ForceRamp.to"),
    *("Hold.until_force", "Loading.penetration", "Oscillate.amplitude", "Oscillate.drift", "Ramp.to"),
    *("Ramp.until_force", "ShiftTable.temperatures", "ShiftTable.log10_factors", "Sweep.amplitude"),
    *("Table.times", "Table.values", "TabulatedProfile.heights", "WLF.reference_temperature"),
}
FROM_ZERO = {
    *("Adhesion.work", "Adhesion.zone", "Approach.dwell", "Branch.modulus", "Force.duration"),
    *("Hold.duration", "PowerLawRelaxation.relaxed", "TabulatedProfile.radii"),
}
WITHIN = {  # limits that are allowed
    "Arrhenius.reference_temperature": (150.0, 1e60),
    "Cone.half_angle": (1e-6, math.nextafter(90.0, 0.0)),
    "Machine.stiffness": (1e-60, math.inf),
    "Material.poisson": (0.0, 0.5),
    "PowerLaw.coefficient": (1e-300, 1e300),
    "PowerLaw.exponent": (1.0, 100.0),
    "PowerLawRelaxation.error": (1e-12, 0.1),
    "PowerLawRelaxation.exponent": (math.ulp(0.0), math.nextafter(1.0, 0.0)),
    "PowerRate.exponent": (0.05, 5.0),
}


NUMBERS = {
    f"{kind.__name__}.{name}": within
    for kind, name in CASES
    if (within := (fields_of(kind)[name].entries or fields_of(kind)[name]).rule) is not None
}


@pytest.mark.parametrize("name", NUMBERS)
def test_a_number_is_taken_up_to_its_limits_and_not_beyond(name):
    """What is not listed above is positive; no number but one with limits of its own is larger than 1e60."""
    within = NUMBERS[name]
    low, high = WITHIN.get(name, (-1e60 if name in SIGNED else 0.0 if name in FROM_ZERO else 1e-60, 1e60))
    assert (within(low, name), within(high, name)) == (low, high)
    for wrong in (
        math.nextafter(low, -math.inf),
        -2e60,
        *([] if high == math.inf else [high + math.ulp(high)]),
    ):
        with pytest.raises(SceneError):
            within(wrong, name)


def test_every_field_says_what_it_is():
    assert [(kind, name) for kind, name in CASES if not fields_of(kind)[name].key.text] == []
