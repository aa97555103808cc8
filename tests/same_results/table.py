"""Two folders that `run record` made, side by side: a line for each recording and rule."""

import csv
import re
import sys
from pathlib import Path

from truths import Truths, read_yaml

REASON_WIDTH = 48
COLUMNS = ("outcome", "speed_km_h", "U_km_h", "usable", "epochs", "window", "holds", "truths",
           "reason")


def km_h(speed):
    return "" if speed is None else f"{3.6 * speed:.3f}"


def judged(speed, expanded, truths):
    """Whether the interval holds each truth, and all of them."""
    told = [(who, truth, abs(truth - speed) <= expanded) for who, truth in truths
            if truth is not None and truth == truth]
    words = "; ".join(f"{who} {3.6 * truth:.2f}{'' if inside else ' MISSED'}"
                      for who, truth, inside in told)
    if not told:
        return "", ""
    return ("yes" if all(inside for *_, inside in told) else "NO"), words


def of_run(run, truths):
    """By rule: what was found of one run."""
    verdict, windows = read_yaml(run / "6-verdict.yaml"), read_yaml(run / "5-windows.yaml")
    rules = {entry["profile"]: entry for entry in windows["profiles"]}
    recorded = truths.velocities(run)
    for entry in verdict["profiles"]:
        speed, expanded = entry.get("speed_m_s"), entry.get("expanded_uncertainty_m_s")
        row = {"outcome": entry["outcome"], "speed_km_h": km_h(speed), "U_km_h": km_h(expanded),
               "usable": recorded.usable, "epochs": recorded.epochs, "reason": entry["reason"]}
        if speed is not None and "window" in entry:
            window = entry["window"]
            row["window"] = f"{float(window['start_time_s']):.3f} s"
            row["holds"], row["truths"] = judged(
                float(speed), float(expanded),
                truths.of(run, entry["profile"], rules[entry["profile"]], window))
        yield entry["profile"], row


def of_folder(out):
    """{(recording, rule): what was found} of everything that was made there."""
    truths = Truths(out)
    found = {}
    for verdict in sorted((out / "runs").rglob("6-verdict.yaml")):
        run = verdict.parent
        if ".runcert" in run.parts:
            continue
        name = str(run.relative_to(out / "runs")).removeprefix("recordings/")
        for profile, row in of_run(run, truths):
            found[name, profile] = row
    for table in sorted((out / "runs").rglob("day.csv")):
        with open(table, encoding="utf-8", newline="") as stream:
            for row in csv.DictReader(stream):
                if row["state"] == "failed":
                    found[row["attempt"], row["profile"] or "-"] = {
                        "outcome": "failed", "reason": row["problem"]}
    return found


def first_words(reason):
    reason = re.sub(r"^Not met: ", "", reason)
    return reason if len(reason) <= REASON_WIDTH else reason[:REASON_WIDTH - 3] + "..."


def text_half(row):
    if row is None:
        return f"{'-':16} {'':>22} {'':>13} {'':3}"
    speed = f"{row['speed_km_h']} ± {row['U_km_h']}" if row.get("speed_km_h") else ""
    usable = f"{row['usable']}/{row['epochs']}" if "epochs" in row else ""
    return f"{row['outcome']:16} {speed:>22} {usable:>13} {row.get('holds', ''):3}"


def print_text(before, after, stream):
    half = f"{'outcome':16} {'speed, U (km/h)':>22} {'usable':>13} {'in':3}"
    stream.write(f"{'recording':26} {'rule':30} | {half} | {half} | reason before | after\n")
    for key in sorted(before.keys() | after.keys()):
        old, new = before.get(key), after.get(key)
        reasons = [first_words(row["reason"]) if row else "" for row in (old, new)]
        stream.write(f"{key[0]:26} {key[1]:30} | {text_half(old)} | {text_half(new)} | "
                     f"{reasons[0]:{REASON_WIDTH}} | {reasons[1]}\n")
    stream.write("\n\"in\": whether the interval holds everything else that is known of the very "
                 "window\n")
    for key in sorted(before.keys() | after.keys()):
        for when, rows in (("before", before), ("after", after)):
            if rows.get(key, {}).get("truths"):
                row = rows[key]
                stream.write(f"{key[0]:26} {key[1]:30} {when:6} {row['speed_km_h']:>9} ± "
                             f"{row['U_km_h']:>7}: {row['truths']}\n")


def write_csv(before, after, file):
    with open(file, "w", encoding="utf-8", newline="") as stream:
        writer = csv.writer(stream)
        writer.writerow(["recording", "rule", *(f"{column}_{when}" for when in ("before", "after")
                                                for column in COLUMNS)])
        for key in sorted(before.keys() | after.keys()):
            writer.writerow([*key, *((rows.get(key) or {}).get(column, "")
                                     for rows in (before, after) for column in COLUMNS)])


def print_table(options):
    """0 where every interval that was certified after holds what else is known of its window."""
    before, after = of_folder(options.before), of_folder(options.after)
    print_text(before, after, sys.stdout)
    if options.csv:
        write_csv(before, after, Path(options.csv))
    missed = [key for key, row in after.items()
              if row.get("holds") == "NO" and row["outcome"] != "not_certifiable"]
    for recording, rule in missed:
        print(f"{recording}, {rule}: the certified interval misses something known", file=sys.stderr)
    return 1 if missed else 0
