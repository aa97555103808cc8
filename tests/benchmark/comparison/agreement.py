"""Whether two programs gave the same smoothed states."""

import array
import math

DOUBLES = 12  # of a point: means of position and velocity, and their standard deviations
LARGEST = 1e-6  # difference that counts as the same, in standard deviations or relative


def points_of(file):
    """The points of a result file, as one flat array."""
    values = array.array("d")
    size = file.stat().st_size
    if size == 0 or size % (DOUBLES * values.itemsize) != 0:
        raise ValueError(f"{file.name}: {size} bytes are not whole points")
    with open(file, "rb") as stream:
        values.fromfile(stream, size // values.itemsize)
    return values


def largest_differences(ours, theirs, every, sigma_from):
    """The largest difference of means, in our standard deviations, and of standard deviations,
    relative; of these from epoch `sigma_from` on, None: they are not compared. Points are those of
    every `every`th epoch. ValueError where the files have not the same number of points, or a
    difference is no finite number."""
    a, b = points_of(ours), points_of(theirs)
    if len(a) != len(b):
        raise ValueError(
            f"{theirs.name}: {len(b) // DOUBLES} points for {len(a) // DOUBLES} of ours"
        )
    of_means, of_sigmas = 0.0, 0.0
    for at in range(0, len(a), DOUBLES):
        compared = sigma_from is not None and at // DOUBLES * every >= sigma_from
        for i in range(at, at + DOUBLES // 2):
            sigma = a[i + DOUBLES // 2]
            of_means = max(of_means, difference(a[i], b[i], sigma, theirs))
            if compared:
                theirs_sigma = b[i + DOUBLES // 2]
                of_sigmas = max(of_sigmas, difference(sigma, theirs_sigma, sigma, theirs))
    return {
        "means_in_sigmas": of_means,
        "sigmas_relative": of_sigmas if sigma_from is not None else None,
    }


def difference(a, b, unit, file):
    size = abs(a - b) / unit
    if not math.isfinite(size):
        raise ValueError(f"{file.name}: {b} where {a} is expected")
    return size
