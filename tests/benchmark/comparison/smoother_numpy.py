"""Kalman filter and RTS smoother of nine states in numpy.

    smoother_numpy.py DATA RESULT EVERY

DATA and RESULT as comparison_data.h says. Prints its times as one line of JSON. The forward pass
is a loop over epochs, as it must be; the smoother's gains do not depend on one another and are
solved for all epochs in one call.
"""

import json
import sys
import time

import numpy as np


def model(dt):
    f = np.array([[1, dt, dt**2 / 2], [0, 1, dt], [0, 0, 1]])
    q = np.array(
        [
            [dt**5 / 20, dt**4 / 8, dt**3 / 6],
            [dt**4 / 8, dt**3 / 3, dt**2 / 2],
            [dt**3 / 6, dt**2 / 2, dt],
        ]
    )
    return np.kron(f, np.eye(3)), np.kron(q, np.eye(3))


def forward(f, q, z, r):
    epochs = len(z)
    xp, pp = np.empty((epochs, 9)), np.empty((epochs, 9, 9))
    xf, pf = np.empty((epochs, 9)), np.empty((epochs, 9, 9))
    ft = np.ascontiguousarray(f.T)
    inverse = np.linalg.inv
    x = np.concatenate([z[0], np.zeros(6)])
    p = np.diag(np.repeat([1e4, 9e4, 1e4], 3))
    for k in range(epochs):
        if k:
            x = f @ x
            p = f @ p @ ft + q
        xp[k] = x
        pp[k] = p
        ph = p[:, :3]
        gain = ph @ inverse(p[:3, :3] + r[k])
        x = x + gain @ (z[k] - x[:3])
        p = p - gain @ ph.T
        p = (p + p.T) * 0.5
        xf[k] = x
        pf[k] = p
    return xp, pp, xf, pf


def backward(f, xp, pp, x, p):
    """Smooths in place."""
    # gain = P F' Pp^-1 is the transpose of Pp^-1 F P.
    gains = np.linalg.solve(pp[1:], f @ p[:-1]).swapaxes(1, 2)
    for k in range(len(x) - 2, -1, -1):
        gain = gains[k]
        x[k] += gain @ (x[k + 1] - xp[k + 1])
        p[k] += gain @ (p[k + 1] - pp[k + 1]) @ gain.T
    return x, p


def main():
    data = np.fromfile(sys.argv[1]).reshape(-1, 9)
    z = data[:, :3].copy()
    r = data[:, [3, 4, 5, 4, 6, 7, 5, 7, 8]].reshape(-1, 3, 3)
    every = int(sys.argv[3])
    f, q = model(0.05)
    start = time.perf_counter()
    xp, pp, x, p = forward(f, q, z, r)
    filtered = time.perf_counter()
    x, p = backward(f, xp, pp, x, p)
    end = time.perf_counter()
    sigma = np.sqrt(np.diagonal(p[::every], axis1=1, axis2=2)[:, :6])
    np.hstack([x[::every, :6], sigma]).tofile(sys.argv[2])
    print(
        json.dumps(
            {"epochs": len(z), "seconds": end - start, "filter_seconds": filtered - start}
        )
    )


main()
