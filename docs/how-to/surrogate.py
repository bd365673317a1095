"""Fits a fast stand-in to the runs of a sweep: ``python surrogate.py out/surrogate``."""

import sys

import numpy as np
import xarray
from scipy.interpolate import RBFInterpolator

data = xarray.open_dataset(f"{sys.argv[1]}/sweep.nc").dropna("run", subset=["pull_off_force"])
names = ["speed", "preload", "work", "zone", "relaxing"]
x = np.log(np.stack([data[name] for name in names], axis=1))  # (runs, 5), as scikit-learn wants it
x = (x - x.mean(axis=0)) / x.std(axis=0)
y = np.log(data.pull_off_force.values)  # (runs,)
held = len(y) // 10  # runs that the fit does not see
model = RBFInterpolator(x[held:], y[held:], neighbors=60)  # or a regressor with fit(x, y) and predict(x)
errors = np.abs(np.expm1(model(x[:held]) - y[:held]))
print(f"{held} of {len(y)} runs held out: mean error {errors.mean():.2%}, largest {errors.max():.2%}")
