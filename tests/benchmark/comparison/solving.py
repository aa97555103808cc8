"""rnx2rtkp, for reference: how long positions take to solve from what a receiver observed."""

import os
import shutil
from pathlib import Path

from comparison.measure import CallFailed, measured_call, say, spread


def recording():
    """The folder with a rover's and a base station's RINEX, or None."""
    data = os.environ.get("RUNCERT_DATA")
    folder = Path(data) / "rinex_pair" if data else None
    return folder if folder and folder.is_dir() else None


def reason_not_to():
    if not shutil.which("rnx2rtkp"):
        return "rnx2rtkp is missing (apt-get install rtklib)"
    if recording() is None:
        return "RUNCERT_DATA names no folder that holds rinex_pair"
    return None


def solve(repeats, missing):
    """Seconds of some calls, and epochs solved; where it cannot be, None, and why in `missing`."""
    if reason := reason_not_to():
        missing.append(f"solving RINEX is left out: {reason}")
        say(missing[-1])
        return None
    names = ("rover.obs", "master.obs", "rover.nav")
    files = [str(recording() / f"yamatogawa_{name}") for name in names]
    calls = []
    try:
        for _ in range(repeats):
            calls.append(measured_call(["rnx2rtkp", "-p", "2", "-f", "1", "-m", "15", *files], {}))
    except CallFailed as error:
        missing.append(f"solving RINEX is left out: {error}")
        say(missing[-1])
        return None
    lines = calls[0].output.splitlines()
    epochs = sum(1 for line in lines if line and not line.startswith("%"))
    if epochs == 0:
        missing.append("solving RINEX is left out: rnx2rtkp solved no epoch")
        say(missing[-1])
        return None
    return {"epochs": epochs, "seconds": spread([call.wall_s for call in calls])}
