"""Runs the programs in turns and keeps what each call took."""

import contextlib
import os
import shutil
import statistics
import subprocess
import sys
import tempfile
import time

from comparison import agreement
from comparison.programs import NMEA_EPOCHS, Call, Place

REPEATS_UP_TO = 1_000_000  # beyond, once is what can be waited for
POINTS_COMPARED = 10_000


class Trouble(Exception):
    """Something that keeps the benchmark from going on: what, where, what to do."""


class CallFailed(Exception):
    """A program that did not do what it was asked."""


def measured_call(command, environment, statuses=(0,)):
    """Runs a program to its end. Its memory is that of the largest process it started."""
    with tempfile.TemporaryFile() as output, tempfile.TemporaryFile() as errors:
        start = time.perf_counter()
        process = subprocess.Popen(
            command,
            stdin=subprocess.DEVNULL,
            stdout=output,
            stderr=errors,
            env=os.environ | {"LC_ALL": "C"} | environment,
        )
        try:
            _, status, usage = os.wait4(process.pid, 0)
        except KeyboardInterrupt:
            process.terminate()
            process.wait()
            raise
        wall_s = time.perf_counter() - start
        process.returncode = os.waitstatus_to_exitcode(status)
        output.seek(0)
        errors.seek(0)
        if process.returncode not in statuses:
            said = errors.read().decode(errors="replace").strip().splitlines()
            raise CallFailed(
                f"{command[0]} ended with status {process.returncode}: {said[-1] if said else ''}"
            )
        return Call(
            output=output.read().decode(errors="replace"),
            wall_s=wall_s,
            processor_s=usage.ru_utime + usage.ru_stime,
            peak_bytes=usage.ru_maxrss * 1024,
        )


def spread(values):
    """Median and quartiles of some figures, and the figures."""
    lower, median, upper = (
        statistics.quantiles(values, n=4, method="inclusive")
        if len(values) > 1
        else (values[0],) * 3
    )
    return {"median": median, "lower": lower, "upper": upper, "all": list(values)}


def available_bytes():
    with open("/proc/meminfo", encoding="ascii") as file:
        for line in file:
            if line.startswith("MemAvailable:"):
                return int(line.split()[1]) * 1024
    return 0


def why_not(program, epochs):
    """Why a program is not run for so many epochs, or None."""
    if program.most_epochs is not None and epochs > program.most_epochs:
        return f"not for more than {program.most_epochs:,} epochs"
    if program.bytes_per_epoch is None:
        return None
    needed = program.bytes_per_epoch * epochs
    if needed > 0.9 * available_bytes():
        return f"needs some {needed / 2**30:.0f} GiB of memory"
    return None


class Size:
    """All calls for one number of epochs."""

    def __init__(self, options, epochs, programs):
        self.epochs = epochs
        self.repeats = options.repeats if epochs <= REPEATS_UP_TO else options.repeats_long
        folder = options.out / str(epochs)
        self.place = Place(
            build=options.build,
            data=folder / "data",
            work=folder / "work",
            every=max(1, epochs // POINTS_COMPARED),
        )
        self.folder = folder
        self.seed = options.seed
        self.left_out = {}
        self.failed = {}
        self.programs = []
        for program in programs:
            if reason := why_not(program, epochs):
                self.left_out[program.key] = reason
            else:
                self.programs.append(program)
        self.figures = {program.key: [] for program in self.programs}

    def make_data(self):
        self.place.work.mkdir(parents=True, exist_ok=True)
        command = [self.place.program("data"), "--epochs", str(self.epochs)]
        command += ["--seed", str(self.seed), "--out", str(self.place.data)]
        if self.epochs <= NMEA_EPOCHS:
            command.append("--nmea")
        try:
            measured_call(command, {})
        except CallFailed as error:
            raise Trouble(f"{error}. Is there room in {self.folder}?") from error

    def run_once(self, program):
        for made in ("run", "nmea"):
            shutil.rmtree(self.place.work / made, ignore_errors=True)
        (self.place.work / "nmea").mkdir()
        call = measured_call(
            program.command(self.place), program.environment, program.statuses
        )
        try:
            figures = program.figures(self.place, call)
        except (ValueError, OSError) as error:
            raise CallFailed(f"{program.title}: {error}") from error
        figures["process_seconds"] = call.wall_s
        figures["processor_seconds"] = call.processor_s
        figures["peak_bytes"] = call.peak_bytes
        self.figures[program.key].append(figures)

    def run(self):
        """In turns, so that what disturbs the machine for a while disturbs all."""
        for repeat in range(self.repeats):
            for program in self.programs:
                if program.key in self.failed:
                    continue
                say(f"{self.epochs:,} epochs, {repeat + 1} of {self.repeats}: {program.title}")
                try:
                    self.run_once(program)
                except (CallFailed, OSError) as error:
                    self.failed[program.key] = str(error)
                    say(f"failed: {error}")

    def result(self):
        measured = {}
        for program in self.programs:
            calls = self.figures[program.key]
            if program.key in self.failed or not calls:
                continue
            names = [name for name in calls[0] if name != "epochs"]
            measured[program.key] = {
                "title": program.title,
                **{name: spread([call[name] for call in calls]) for name in names},
            }
            if program.kind == "smoother" and "library" in self.figures:
                self.compare(program, measured)
        return {
            "epochs": self.epochs,
            "repeats": self.repeats,
            "programs": measured,
            "left_out": self.left_out,
            "failed": self.failed,
        }

    def compare(self, program, measured):
        if program.key == "library" or "library" not in measured:
            return
        try:
            found = agreement.largest_differences(
                self.place.result("library"),
                self.place.result(program.key),
                every=self.place.every,
                sigma_from=program.compared_from,
            )
        except (ValueError, OSError) as error:
            self.failed[program.key] = str(error)
            del measured[program.key]
            return
        measured[program.key]["agreement"] = found


def say(text):
    """What is being done, on standard error: standard output has the tables."""
    print(text, file=sys.stderr, flush=True)


@contextlib.contextmanager
def size_folder(size, keep):
    """Its data and results, which may be gigabytes, are removed at the end."""
    try:
        yield size
    finally:
        if not keep:
            shutil.rmtree(size.folder, ignore_errors=True)
