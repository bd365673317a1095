"""Answers adhesionless scenes of an exam in plain NumPy, by the closed forms of Lee and Radok and of Ting."""

import json
import pathlib
import sys

import numpy as np


def integral(t):
    """Of the relaxation modulus, up to t."""
    return E0 * t + (E1 - E0) * tau * (1 - np.exp(-t / tau))


folder = pathlib.Path(sys.argv[1])
(folder / "code.toml").write_text(
    'code = "closed forms"\ndeclines = ["adhesive", "spectrum", "force-control"]\n'
)
u, weight = np.polynomial.legendre.leggauss(40)  # on [-1, 1]
u, weight, x = (u[:, None] + 1) / 2, weight[:, None] / 2, np.linspace(0, 1, 400)
for name in ("adhesionless-cycle", "elastic-press"):
    scene = json.loads((folder / name / "scene.json").read_text())
    E0, E1 = scene["derived"]["relaxed_plane_modulus"], scene["derived"]["glassy_plane_modulus"]
    tau, R = scene["material"]["branches"][0]["time"] if E1 > E0 else 1.0, scene["indenter"]["radius"]
    to, V, W = (scene["loading"]["steps"][i][key] for i, key in ((0, "to"), (0, "rate"), (1, "rate")))
    low, high = to / V, to / V + to / W
    for _ in range(60):  # contact is lost where all that was pressed in has been taken back
        t = (low + high) / 2
        low, high = (t, high) if V * integral(t) > (V + W) * integral(t - to / V) else (low, t)
    t = np.concatenate((to / V * x**2, low - (low - to / V) * (1 - x[1:]) ** 2))
    late, low, high = np.maximum(t - to / V, 0), 0 * t, np.minimum(t, to / V)
    for _ in range(60):  # s: when the point now at the edge was first covered
        s = (low + high) / 2
        low, high = np.where(V * integral(t - s) > (V + W) * integral(late), (s, high), (low, s))
    s, D = np.where(t < to / V, t, low), V * np.minimum(t, to / V) - W * late
    E = E0 + (E1 - E0) * np.exp(-(t - s * u**2) / tau)
    F, a = 4 * V * (weight * E * np.sqrt(R * V * s) * s * u**2).sum(0), np.sqrt(R * V * s)
    rows = (",".join(map(str, row)) for row in zip(t, D, F, a, strict=True))
    head = "# code: closed forms\ntime,penetration,force,contact_radius\n"
    (folder / name / "trace.csv").write_text(head + "\n".join(rows) + "\n")
