"""Filters and smooths a problem with statsmodels' Kalman filter and smoother.

Reads a JSON file: `time` (s); `position`, one [east, north] (m) or null for each epoch;
`covariance`, one 2 x 2 list (m^2) for each epoch; `prior_mean` and `prior_sigma` of the eight
states; `jerk_density`, `acceleration_time` (s or null), `error_tau` (s), `error_density`; `start`
and `end`, two epochs; `left_out`, how many first measurements the innovation sums leave out.
Prints what statsmodels makes of it, as JSON.

The model's matrices are made here from its differential equations, by Van Loan's matrix
exponential (1978) in units of the step, and not by the program under test.
"""

import json
import sys

import numpy as np
from scipy.linalg import expm
from statsmodels.tsa.statespace.kalman_smoother import KalmanSmoother


def step(problem, dt):
    """Transition and process noise of east and north: position, velocity, acceleration, error."""
    unit = np.array([dt**2, dt, 1.0])
    decay = dt / problem["acceleration_time"] if problem["acceleration_time"] else 0.0
    drift = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, -decay]])
    driving = np.diag([0.0, 0.0, 1.0])
    both = expm(np.block([[-drift, driving], [np.zeros((3, 3)), drift.T]]))
    motion = both[3:, 3:].T
    noise = motion @ both[:3, 3:]
    x = dt / problem["error_tau"]
    error_noise = problem["error_density"] ** 2 * problem["error_tau"] / 2 * -np.expm1(-2 * x)
    one = np.zeros((4, 4))
    one[:3, :3] = unit[:, None] * motion / unit[None, :]
    one[3, 3] = np.exp(-x)
    one_noise = np.zeros((4, 4))
    one_noise[:3, :3] = problem["jerk_density"] ** 2 * dt * np.outer(unit, unit) * noise
    one_noise[3, 3] = error_noise
    one_noise = (one_noise + one_noise.T) / 2
    return np.kron(one, np.eye(2)), np.kron(one_noise, np.eye(2))


def smoother_of(problem):
    time = problem["time"]
    epochs = len(time)
    smoother = KalmanSmoother(k_endog=2, k_states=8, k_posdef=8)
    missing = [[np.nan, np.nan]]
    smoother.bind(np.array([p or missing[0] for p in problem["position"]], dtype=float))
    smoother["design"] = np.kron([[1.0, 0.0, 0.0, 1.0]], np.eye(2))
    smoother["selection"] = np.eye(8)
    transition = np.zeros((8, 8, epochs))
    state_cov = np.zeros((8, 8, epochs))
    transition[:, :, -1] = np.eye(8)
    for t in range(epochs - 1):
        dt = round((time[t + 1] - time[t]) * 1e9) * 1e-9
        transition[:, :, t], state_cov[:, :, t] = step(problem, dt)
    smoother["transition"] = transition
    smoother["state_cov"] = state_cov
    smoother["obs_cov"] = np.moveaxis(np.array(problem["covariance"]), 0, 2)
    smoother.initialize_known(
        np.array(problem["prior_mean"]), np.diag(np.square(problem["prior_sigma"]))
    )
    return smoother


def main():
    with open(sys.argv[1], encoding="utf-8") as file:
        problem = json.load(file)
    results = smoother_of(problem).smooth()
    measured = [t for t, p in enumerate(problem["position"]) if p][problem["left_out"] :]
    statistic = 0.0
    log_determinant = 0.0
    for t in measured:
        residual = results.forecasts_error[:, t]
        covariance = results.forecasts_error_cov[:, :, t]
        statistic += residual @ np.linalg.solve(covariance, residual)
        log_determinant += np.linalg.slogdet(covariance)[1]
    start, end = problem["start"], problem["end"]
    # Cov(end, start), by Durbin & Koopman 2012, 4.7.
    between = results.smoothed_state_autocovariance(lag=end - start, t=end)
    print(
        json.dumps(
            {
                "statistic": statistic,
                "log_determinant": log_determinant,
                "log_likelihood": float(
                    np.sum(results.llf_obs[measured]) + len(measured) * np.log(2 * np.pi)
                ),
                "states": results.smoothed_state.T.tolist(),
                "covariances": np.moveaxis(results.smoothed_state_cov, 2, 0).tolist(),
                "between": between.T.tolist(),
            }
        )
    )


main()
