"""Cost against epochs, and what is asked of it."""

import math
from dataclasses import dataclass

from comparison.agreement import LARGEST
from comparison.programs import STAGES

EXPONENT_FROM = 28_200  # below, starting the programs is most of the time
EXPONENT_SPAN = 10  # over less, what disturbs one call tilts the line
TABLES_FROM, TABLES_UP_TO = 28_200, 1_000_000
GIB = 2**30


@dataclass(frozen=True)
class Requirement:
    what: str
    found: float | None  # None: not measured
    at_least: float | None = None
    at_most: float | None = None
    unit: str = ""

    def is_met(self):
        if self.found is None:
            return None
        return (self.at_least is None or self.found >= self.at_least) and (
            self.at_most is None or self.found <= self.at_most
        )

    def asked(self):
        if self.at_least is not None and self.at_most is not None:
            return f"{self.at_least:g} to {self.at_most:g}{self.unit}"
        if self.at_most is None:
            return f"at least {self.at_least:g}{self.unit}"
        return f"at most {self.at_most:g}{self.unit}"

    def as_json(self):
        asked, met = self.asked(), self.is_met()
        return {"what": self.what, "found": self.found, "asked": asked, "met": met}


class Measured:
    """Medians of what was measured, by size and program."""

    def __init__(self, sizes):
        self.sizes = {size["epochs"]: size for size in sizes}

    def median(self, epochs, key, figure="seconds"):
        program = self.sizes.get(epochs, {}).get("programs", {}).get(key, {})
        return program[figure]["median"] if figure in program else None

    def ratio(self, above, below):
        """Of two medians, each (epochs, key) or (epochs, key, figure)."""
        a, b = self.median(*above), self.median(*below)
        return None if a is None or not b else a / b

    def curve(self, key, figure):
        """Epochs and medians of every size that has them, in order of epochs."""
        found = [(n, self.median(n, key, figure)) for n in sorted(self.sizes)]
        return [(n, value) for n, value in found if value]


def exponent(curve):
    """The slope of log time on log epochs by least squares; None for fewer than two sizes."""
    points = [(math.log(n), math.log(value)) for n, value in curve]
    if len(points) < 2:
        return None
    mean_x = sum(x for x, _ in points) / len(points)
    mean_y = sum(y for _, y in points) / len(points)
    above = sum((x - mean_x) * (y - mean_y) for x, y in points)
    return above / sum((x - mean_x) ** 2 for x, _ in points)


def exponents(measured):
    """Of each stage, of the run and of each smoother: over all sizes, and between neighbours."""
    curves = {f"stage {stage}": ("certify", f"stage {stage}") for stage in STAGES}
    keys = sorted({key for size in measured.sizes.values() for key in size["programs"]})
    curves |= {key: (key, "seconds") for key in keys if key != "tables"}
    found = {}
    for name, (key, figure) in curves.items():
        curve = [point for point in measured.curve(key, figure) if point[0] >= EXPONENT_FROM]
        if len(curve) < 2:
            continue
        pairs = zip(curve, curve[1:], strict=False)
        found[name] = {
            "from": curve[0][0],
            "to": curve[-1][0],
            "all": exponent(curve),
            "pairs": [
                {"from": a[0], "to": b[0], "exponent": exponent([a, b])} for a, b in pairs
            ],
        }
    return found


def speed(measured, what):
    """Of tables, in MB/s (10^6 bytes), at the largest size that is not too large for memory."""
    sizes = [n for n in sorted(measured.sizes) if TABLES_FROM <= n <= TABLES_UP_TO]
    for epochs in reversed(sizes):
        seconds = measured.median(epochs, "tables", f"{what}_seconds")
        size = measured.median(epochs, "tables", f"{what.split('_')[1]}_bytes")
        if seconds:
            return size / seconds / 1e6
    return None


def of_smoothers(m):
    n = 28_200
    ours = (n, "library")

    def times_ours(key):
        return m.ratio((n, key), ours)

    return [
        Requirement("statsmodels, its fastest / runcert", times_ours("statsmodels"), 15),
        Requirement("statsmodels, as it comes / runcert", times_ours("statsmodels-all"), 15),
        Requirement("Octave / runcert", times_ours("octave"), 25),
        Requirement("runcert / plain Eigen", m.ratio(ours, (n, "eigen")), at_most=0.7),
    ]


def of_runs(m):
    run = (28_200, "certify")
    filter_alone = m.ratio(run, (28_200, "octave", "filter_seconds"))
    both = m.ratio(run, (28_200, "octave"))
    return [
        Requirement("certify, 28,200 epochs", m.median(*run), at_most=1.0, unit=" s"),
        Requirement("certify / Octave's filter", filter_alone, at_most=1),
        Requirement("certify / Octave's filter and smoother", both, at_most=1),
        Requirement("certify, 451 epochs", m.median(451, "certify"), at_most=0.15, unit=" s"),
    ]


def of_long_runs(m):
    million, ten = (1_000_000, "certify"), (10_000_000, "certify")
    peak = m.median(*million, "peak_bytes")
    memory = m.ratio((*ten, "peak_bytes"), (*million, "peak_bytes"))
    return [
        Requirement("certify, 1,000,000 epochs", m.median(*million), at_most=45, unit=" s"),
        Requirement("  its memory", None if peak is None else peak / GIB, at_most=2, unit=" GiB"),
        Requirement("10,000,000 / 1,000,000, time", m.ratio(ten, million), at_most=12),
        Requirement("10,000,000 / 1,000,000, memory", memory, at_most=6),
    ]


def of_exponents(found):
    def slope(stage):
        one = found.get(f"stage {stage}")
        return one["all"] if one and one["to"] >= EXPONENT_SPAN * one["from"] else None

    return [
        Requirement(f"exponent of {stage}", slope(stage), 0.95, 1.05)
        for stage in STAGES
        if stage != "report"  # the verdict is what is asked for
    ]


def of_tables(m):
    return [
        Requirement("reading .pos, one core", speed(m, "read_pos"), 200, unit=" MB/s"),
        Requirement("reading ECSV, one core", speed(m, "read_ecsv"), 200, unit=" MB/s"),
        Requirement("writing ECSV, one core", speed(m, "write_ecsv"), 150, unit=" MB/s"),
    ]


def of_agreement(m):
    """The largest difference of any program at any size; and that all that was begun was done."""
    found = [
        value
        for size in m.sizes.values()
        for program in size["programs"].values()
        for value in program.get("agreement", {}).values()
        if value is not None
    ]
    failed = sum(len(size["failed"]) for size in m.sizes.values())
    return [
        Requirement("smoothers: largest difference", max(found, default=None), at_most=LARGEST),
        Requirement("programs that failed", failed, at_most=0),
    ]


def requirements(measured, found_exponents):
    return (
        of_smoothers(measured)
        + of_runs(measured)
        + of_long_runs(measured)
        + of_exponents(found_exponents)
        + of_tables(measured)
        + of_agreement(measured)
    )
