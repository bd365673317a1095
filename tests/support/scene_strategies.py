"""Random scenes, over the whole range of numbers a scene file may hold."""

from __future__ import annotations

from hypothesis import strategies as st

from contact_scene import (
    Adhesion,
    Branch,
    BulkRelaxation,
    Cone,
    FlatPunch,
    Force,
    ForceRamp,
    Hold,
    Loading,
    Material,
    Oscillate,
    PowerLaw,
    Ramp,
    Scene,
    Sphere,
    Sweep,
    Table,
    TabulatedProfile,
)

finite = st.floats(-1e60, 1e60)
positive = st.floats(1e-60, 1e60)
not_negative = st.one_of(st.just(0.0), st.floats(0.0, 1e60))
branches = st.lists(st.builds(Branch, st.floats(0.0, 1e58), positive), max_size=4).map(tuple)
materials = st.one_of(
    st.builds(Material, st.floats(1e-60, 1e59), st.floats(0.0, 0.5), branches),
    st.builds(
        Material,
        st.floats(1e-60, 1e59),
        st.floats(0.0, 0.49),
        branches,
        st.one_of(st.just("elastic"), st.builds(BulkRelaxation, st.none() | positive, branches)),
    ),
)
profiles = st.lists(st.floats(0.0, 1e3), min_size=2, max_size=6).map(
    lambda rises: TabulatedProfile(
        tuple(0.5 * n for n in range(len(rises) + 2)),
        (0.0, 0.1, *(0.1 + sum(rises[: n + 1]) for n in range(len(rises)))),
    )
)
indenters = st.one_of(
    st.builds(Sphere, positive),
    st.builds(Cone, st.floats(1e-6, 89.999)),
    st.builds(FlatPunch, st.just(1e60)),
    st.builds(PowerLaw, st.floats(1.0, 100.0), st.floats(1e-300, 1e300)),
    profiles,
)
tables = st.lists(st.tuples(st.integers(1, 1000), finite), min_size=2, max_size=5).map(
    lambda rows: Table(
        tuple(float(sum(r[0] for r in rows[: n + 1])) for n in range(len(rows))), tuple(r[1] for r in rows)
    )
)
steps = st.one_of(
    st.builds(Ramp, finite, positive),
    st.builds(Hold, not_negative),
    st.builds(Force, finite, not_negative),
    st.builds(ForceRamp, finite, positive),
    st.builds(Oscillate, finite, positive, positive, finite),
    st.builds(Sweep, finite, positive, positive),
    tables,
)
scenes = st.builds(
    Scene,
    materials,
    indenters,
    st.builds(
        Loading, st.sampled_from(["jump-in", "relaxed"]), finite, st.lists(steps, max_size=4).map(tuple)
    ),
    st.none() | st.builds(Adhesion, st.just(0.0) | positive, st.floats(1e-60, 1e59)),
    st.text(st.characters(codec="utf-8"), max_size=20),
)
