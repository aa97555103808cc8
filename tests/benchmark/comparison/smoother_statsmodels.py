"""The Kalman filter and smoother of statsmodels, compiled, with nine states.

    smoother_statsmodels.py DATA RESULT EVERY [--as-it-comes]

DATA and RESULT as comparison_data.h says. Prints its time as one line of JSON. Means and
covariances of the states are all that is asked for, and of its smoothers the fastest that has them
is taken; with --as-it-comes all its outputs by the smoother that it takes of itself.
"""

import json
import sys
import time

import numpy as np
from statsmodels.tsa.statespace import kalman_smoother as statespace


def smoother_of(data, dt):
    smoother = statespace.KalmanSmoother(k_endog=3, k_states=9, k_posdef=9)
    smoother.bind(data[:, :3].copy())
    f = np.array([[1, dt, dt**2 / 2], [0, 1, dt], [0, 0, 1]])
    q = np.array(
        [
            [dt**5 / 20, dt**4 / 8, dt**3 / 6],
            [dt**4 / 8, dt**3 / 3, dt**2 / 2],
            [dt**3 / 6, dt**2 / 2, dt],
        ]
    )
    smoother["design"] = np.kron([[1.0, 0.0, 0.0]], np.eye(3))
    smoother["selection"] = np.eye(9)
    smoother["transition"] = np.kron(f, np.eye(3))
    smoother["state_cov"] = np.kron(q, np.eye(3))
    # In the order in which the compiled code has it, so that nothing is copied while it is timed.
    covariances = data[:, [3, 4, 5, 4, 6, 7, 5, 7, 8]].T.reshape(3, 3, -1)
    smoother["obs_cov"] = np.asfortranarray(covariances)
    smoother.initialize_known(
        np.concatenate([data[0, :3], np.zeros(6)]), np.diag(np.repeat([1e4, 9e4, 1e4], 3))
    )
    return smoother


def main():
    data = np.fromfile(sys.argv[1]).reshape(-1, 9)
    every = int(sys.argv[3])
    smoother = smoother_of(data, 0.05)
    if "--as-it-comes" not in sys.argv:
        smoother.smoother_output = (
            statespace.SMOOTHER_STATE | statespace.SMOOTHER_STATE_COV
        )
        smoother.smooth_method = statespace.SMOOTH_ALTERNATIVE
    start = time.perf_counter()
    results = smoother.smooth()
    seconds = time.perf_counter() - start
    variances = np.diagonal(results.smoothed_state_cov[:, :, ::every])[:, :6]
    means = results.smoothed_state[:6, ::every].T
    np.hstack([means, np.sqrt(variances)]).tofile(sys.argv[2])
    print(json.dumps({"epochs": len(data), "seconds": seconds}))


main()
