# SPDX-License-Identifier: Apache-2.0
"""The likelihoods of kalman_benchmark.cpp by statsmodels' compiled filter.

kalman_statsmodels.py FILE TASK, TASK one of
  likelihood  statsmodels decides when the covariance has converged
  every       no steady state: a covariance step at every sample
  fit         log-variances, started at the values in the file, by L-BFGS
Reads a model and its measurements from a file of lines "name rows columns numbers…", rows first.
Writes the seconds of processor time of one evaluation, or of the fit; the log-likelihood; and after a fit the number
of evaluations and the variances.
"""

import sys
import time

import numpy as np
from statsmodels.tsa.statespace.kalman_filter import FILTER_CONVENTIONAL, FILTER_UNIVARIATE
from statsmodels.tsa.statespace.mlemodel import MLEModel


def read(path):
    matrices = {}
    with open(path) as lines:
        for line in lines:
            name, rows, columns, *numbers = line.split()
            matrices[name] = np.array(numbers, dtype=float).reshape(int(rows), int(columns))
    return matrices


class Model(MLEModel):
    def __init__(self, m):
        nx = m["F"].shape[0]
        super().__init__(m["y"], k_states=nx, k_posdef=nx)
        self.m = m
        self.evaluations = 0
        self.ssm["transition"] = m["F"]
        self.ssm["design"] = m["C"]
        self.ssm["selection"] = np.eye(nx)
        self.ssm["state_cov"] = m["Q"]
        self.ssm["obs_cov"] = m["R"]
        self.ssm.initialize_known(np.zeros(nx), m["P0"])

    @property
    def start_params(self):
        return self.m["start"].ravel()

    @property
    def param_names(self):
        return [f"log{i}" for i in range(self.m["start"].size)]

    def update(self, params, **kwargs):
        params = super().update(params, **kwargs)
        self.evaluations += 1
        self.ssm["state_cov"] = self.m["Q_of_1"] * np.exp(params[0])
        self.ssm["obs_cov"] = self.m["R_of_1"] * np.exp(params[1])


def median_time(work):
    times = []
    for _ in range(15):
        start = time.process_time()
        work()
        times.append(time.process_time() - start)
    return sorted(times)[7]


def fit(m):
    """The faster of its two ways to differentiate, each as exact as the comparison needs."""
    best = None
    for options in [{"optim_complex_step": True}, {"optim_complex_step": False, "epsilon": 1e-7}]:
        model = Model(m)
        start = time.process_time()
        result = model.fit(disp=False, method="lbfgs", pgtol=1e-7, factr=10, cov_type="none",
                           return_params=True, **options)
        seconds = time.process_time() - start
        value = model.loglike(result)
        if best is None or seconds < best[0]:
            best = (seconds, value, model.evaluations, *np.exp(result))
    return best


def main():
    m = read(sys.argv[1])
    task = sys.argv[2]
    if task == "fit":
        print(*(repr(float(number)) for number in fit(m)))
        return
    model = Model(m)
    if task == "every":
        model.ssm.tolerance = 0
    best = None
    for method in (FILTER_CONVENTIONAL, FILTER_UNIVARIATE):
        model.ssm.filter_method = method
        value = model.ssm.loglike()
        seconds = median_time(model.ssm.loglike)
        if best is None or seconds < best[0]:
            best = (seconds, float(value))
    print(*map(repr, best))


main()
