"""Random scenes, over the whole range of numbers a scene file may hold."""

from __future__ import annotations

from dataclasses import replace

from hypothesis import strategies as st

import contact_scene as cs

finite = st.floats(-1e60, 1e60)
positive = st.floats(1e-60, 1e60)
not_negative = st.one_of(st.just(0.0), st.floats(0.0, 1e60))
branches = st.lists(st.builds(cs.Branch, st.floats(0.0, 1e58), positive), max_size=4).map(tuple)
materials = st.one_of(
    st.builds(cs.Material, st.floats(1e-60, 1e59), st.floats(0.0, 0.5), branches),
    st.builds(
        cs.Material,
        st.floats(1e-60, 1e59),
        st.floats(0.0, 0.49),
        branches,
        st.one_of(st.just("elastic"), st.builds(cs.BulkRelaxation, st.none() | positive, branches)),
    ),
)
profiles = st.lists(st.floats(0.0, 1e3), min_size=2, max_size=6).map(
    lambda rises: cs.TabulatedProfile(
        tuple(0.5 * n for n in range(len(rises) + 2)),
        (0.0, 0.1, *(0.1 + sum(rises[: n + 1]) for n in range(len(rises)))),
    )
)
indenters = st.one_of(
    st.builds(cs.Sphere, positive),
    st.builds(cs.Cone, st.floats(1e-6, 89.999)),
    st.builds(cs.FlatPunch, st.just(1e60)),
    st.builds(cs.PowerLaw, st.floats(1.0, 100.0), st.floats(1e-300, 1e300)),
    profiles,
)
tables = st.lists(st.tuples(st.integers(1, 1000), finite), min_size=2, max_size=5).map(
    lambda rows: cs.Table(
        tuple(float(sum(r[0] for r in rows[: n + 1])) for n in range(len(rows))), tuple(r[1] for r in rows)
    )
)
steps = st.one_of(
    st.builds(cs.Ramp, finite, positive),
    st.builds(cs.Hold, not_negative),
    st.builds(cs.Force, finite, not_negative),
    st.builds(cs.ForceRamp, finite, positive),
    st.builds(cs.Oscillate, finite, positive, positive, finite),
    st.builds(cs.Sweep, finite, positive, positive),
    tables,
)


def on_a_body(scene: cs.Scene, thickness: float, base: str | None) -> cs.Scene:
    """The scene on a layer, where a base is drawn and it takes one."""
    if base is None or scene.material.bulk is not None:
        return scene
    least = 0.0 if scene.adhesion is None else 2.0 * scene.adhesion.zone
    return replace(scene, body=cs.Layer(max(thickness, least), base))


half_spaces = st.builds(
    cs.Scene,
    materials,
    indenters,
    st.builds(
        cs.Loading, st.sampled_from(["jump-in", "relaxed"]), finite, st.lists(steps, max_size=4).map(tuple)
    ),
    st.none() | st.builds(cs.Adhesion, st.just(0.0) | positive, st.floats(1e-60, 1e59)),
    st.text(st.characters(codec="utf-8"), max_size=20),
)
scenes = st.builds(on_a_body, half_spaces, positive, st.sampled_from([None, "bonded", "frictionless"]))
