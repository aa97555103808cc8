"""The programs that are measured beside one another: what each is called, needs and prints."""

import json
import re
import shutil
import subprocess
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

HERE = Path(__file__).resolve().parent
DEBIAN_PYTHON = "/usr/bin/python3"  # the one that finds Debian's numpy, whatever stands in PATH
STAGES = ("import", "enu", "screen", "smooth", "window", "check", "report")


@dataclass(frozen=True)
class Place:
    """Where a program of one size finds its data and puts its results."""

    build: Path
    data: Path
    work: Path
    every: int  # of which epochs the smoothed points are written

    def result(self, key):
        return self.work / f"{key}.points"

    def program(self, name):
        return str(self.build / "tests" / f"runcert-comparison-{name}")


@dataclass(frozen=True)
class Call:
    """What one call of a program took."""

    output: str
    wall_s: float
    processor_s: float
    peak_bytes: int


@dataclass(frozen=True)
class Program:
    key: str
    title: str
    command: Callable[[Place], list[str]]
    # The figures of one call, in seconds, but for "..._bytes".
    figures: Callable[[Place, Call], dict[str, float]]
    kind: str  # smoother, run, tables, reading
    needs_program: str | None = None
    needs_module: str | None = None
    package: str | None = None
    # Of its memory, measured; a size for which the machine has less is left out. None: always run.
    bytes_per_epoch: int | None = None
    most_epochs: int | None = None
    # The first epoch whose standard deviations are compared; None: it has none.
    compared_from: int | None = 0
    statuses: tuple[int, ...] = (0,)
    environment: dict[str, str] = field(default_factory=dict)

    def missing(self):
        """What is missing of the program, or None."""
        if self.needs_program and not shutil.which(self.needs_program):
            return self.needs_program
        if self.needs_module and not has_module(self.needs_module):
            return f"the Python module {self.needs_module}"
        return None


def has_module(name):
    try:
        found = subprocess.run(
            [DEBIAN_PYTHON, "-c", f"import {name}"], capture_output=True, check=False
        )
    except OSError:
        return False
    return found.returncode == 0


# Matrices of nine rows are too small for threads, which would only get in the way.
ONE_THREAD = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "RUNCERT_THREADS": "1"}


def printed(_place, call):
    """The figures that a program prints as one line of JSON."""
    return json.loads(call.output)


def whole_process(_place, call):
    return {"seconds": call.wall_s}


def of_run(place, call):
    """Of certify: from its start to 6-verdict.yaml, which is all but the report; and each stage."""
    times = (place.work / "run" / "run.yaml").read_text(encoding="utf-8")
    stages = dict(re.findall(r"- stage: (\S+)\n +seconds: ([0-9.]+)", times))
    if tuple(stages) != STAGES:
        raise ValueError(f"run.yaml has the stages {', '.join(stages) or 'none'}")
    seconds = {f"stage {stage}": float(s) for stage, s in stages.items()}
    return {"seconds": call.wall_s - seconds["stage report"], **seconds}


def native(key, title, program, *more, **rest):
    """A smoother of this build."""

    def command(place):
        data = ["--data", str(place.data / "positions.bin"), "--result", str(place.result(key))]
        return [place.program(program), *data, "--every", str(place.every), *more]

    return Program(key, title, command, printed, "smoother", environment=ONE_THREAD, **rest)


def interpreted(key, title, interpreter, script, *more, **rest):
    """A smoother that an interpreter runs."""

    def command(place):
        data = [str(place.data / "positions.bin"), str(place.result(key)), str(place.every)]
        return [*interpreter, str(HERE / script), *data, *more]

    return Program(key, title, command, printed, "smoother", environment=ONE_THREAD, **rest)


def python(key, title, script, module, *more, **rest):
    interpreter = [DEBIAN_PYTHON, "-W", "error", "-B"]
    package = f"python3-{module}"
    return interpreted(
        key, title, interpreter, script, *more, needs_module=module, package=package, **rest
    )


def certify(place):
    attempt, run = str(place.data / "attempt.yaml"), str(place.work / "run")
    return [str(place.build / "bin/runcert"), "certify", attempt, "--out", run, "--no-render"]


def import_nmea(place):
    attempt, run = str(place.data / "nmea.yaml"), str(place.work / "nmea")
    return [str(place.build / "bin/runcert-import"), "--attempt", attempt, "--run-dir", run]


def gpsbabel(place):
    """Reading alone: it writes nothing, while runcert-import hashes, checks and writes a table."""
    return ["gpsbabel", "-t", "-i", "nmea", "-f", str(place.data / "recording.nmea")]


def tables(place):
    return [place.program("tables"), str(place.data / "recording.pos")]


NMEA_EPOCHS = 1_000_000  # a recording of more than a day would need its dates
OCTAVE = ["octave-cli", "--no-gui", "--norc", "--no-history", "--quiet"]

PROGRAMS = (
    native("library", "runcert", "library", bytes_per_epoch=700),
    native("eigen", "plain Eigen, -O3", "eigen", bytes_per_epoch=1600),
    native("ceres", "Ceres alone, means", "ceres", bytes_per_epoch=10100, compared_from=None),
    # In the first epochs its smoother loses what the prior takes of sixteen digits.
    python(
        "statsmodels",
        "statsmodels, its fastest",
        "smoother_statsmodels.py",
        "statsmodels",
        bytes_per_epoch=9800,
        compared_from=3,
    ),
    python(
        "statsmodels-all",
        "statsmodels, as it comes",
        "smoother_statsmodels.py",
        "statsmodels",
        "--as-it-comes",
        bytes_per_epoch=12800,
        compared_from=3,
    ),
    python("numpy", "numpy", "smoother_numpy.py", "numpy", bytes_per_epoch=3000),
    interpreted(
        "octave",
        "Octave",
        OCTAVE,
        "smoother.m",
        needs_program="octave-cli",
        package="octave",
        bytes_per_epoch=2400,
    ),
    Program("certify", "runcert certify", certify, of_run, "run", statuses=(0, 1)),
    Program(
        "tables",
        "tables",
        tables,
        printed,
        "tables",
        environment=ONE_THREAD,
        bytes_per_epoch=1000,
    ),
    Program(
        "nmea",
        "runcert-import, NMEA to a table",
        import_nmea,
        whole_process,
        "reading",
        most_epochs=NMEA_EPOCHS,
    ),
    Program(
        "gpsbabel",
        "gpsbabel, NMEA read alone",
        gpsbabel,
        whole_process,
        "reading",
        most_epochs=NMEA_EPOCHS,
        needs_program="gpsbabel",
        package="gpsbabel",
    ),
)
KEYS = tuple(program.key for program in PROGRAMS) + ("rnx2rtkp",)
