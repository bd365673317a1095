"""Answers adhesionless scenes of an exam in plain NumPy, as Lee and Radok and as Ting."""

import json
import pathlib
import sys

import numpy as np

folder, x = pathlib.Path(sys.argv[1]), np.linspace(0, 1, 400)
tags = '["adhesive", "spectrum", "force-control"]'
(folder / "code.toml").write_text(f'code = "closed forms"\ndeclines = {tags}\n')
u, weight = (column[:, None] / 2 for column in np.polynomial.legendre.leggauss(40))
for name in ("adhesionless-cycle", "elastic-press"):
    scene = json.loads((folder / name / "scene.json").read_text())
    E0, E1 = (scene["derived"][f"{state}_plane_modulus"] for state in ("relaxed", "glassy"))
    tau = scene["material"]["branches"][0]["time"] if E1 > E0 else 1
    (to, V), (_, W) = ((step["to"], step["rate"]) for step in scene["loading"]["steps"])
    turn, t = to / V, np.linspace(0, to / V + to / W, 200_001)
    integral = E0 * t - (E1 - E0) * tau * np.expm1(-t / tau)  # of the relaxation modulus
    taken_back = (1 + W / V) * np.interp(t - turn, t, integral)
    s = t - np.interp(taken_back, integral, t)  # when the edge, advancing, was where it is now
    end = np.interp(0, -s[t > turn], t[t > turn])
    rows = np.concatenate((turn * x**2, end - (end - turn) * (1 - x[1:]) ** 2))
    t, s = rows, np.interp(rows, t, s).clip(0)
    D, R = V * np.minimum(t, turn) - W * (t - turn).clip(0), scene["indenter"]["radius"]
    E = E0 + (E1 - E0) * np.exp(-(t - s * (u + 0.5) ** 2) / tau)
    a = np.sqrt(R * V * s)
    F = 4 * V * s * a * (weight * E * (u + 0.5) ** 2).sum(0)
    head, table = "# code: closed forms\ntime,penetration,force,contact_radius", np.c_[t, D, F, a]
    np.savetxt(folder / name / "trace.csv", table, "%.17g", ",", header=head, comments="")
