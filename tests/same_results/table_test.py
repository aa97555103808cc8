"""What `run table` compares with: truths over a window, by definitions, and what it prints."""

import io
import math
import sys
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

import table  # noqa: E402
import truths  # noqa: E402

SCREENED = """# %ECSV 1.0
# ---
# meta:
#   first_epoch_gps: "2023-07-11T06:04:30.500000000"
#   tests:
#     velocity:
#       compared: 11
#       delay_s: 0.2
#     device:
#       moving: 3
# schema: x
time,usable,recorded_velocity_east,recorded_velocity_north,recorded_velocity_up
"""


def run_with(rows):
    folder = Path(tempfile.mkdtemp())
    text = SCREENED + "".join(",".join(str(cell) for cell in row) + "\n" for row in rows)
    (folder / "3-screened.ecsv").write_text(text)
    return folder


class TrackTest(unittest.TestCase):
    def test_cubic_motion_is_followed_between_samples(self):
        def at(t):
            return [t ** 3, 2.0 * t], [3.0 * t * t, 2.0]
        track = truths.Track([(0.5 * k, *at(0.5 * k)) for k in range(10)])
        self.assertAlmostEqual(track.at(1.3)[0], 1.3 ** 3, places=9)
        self.assertAlmostEqual(track.at(1.3)[1], 2.6, places=9)
        self.assertAlmostEqual(truths.plane_speed(track, 1.3, 3.3),
                               math.hypot(3.3 ** 3 - 1.3 ** 3, 4.0) / 2.0, places=9)

    def test_nothing_is_said_across_a_gap_or_outside(self):
        track = truths.Track([(t, [t], [1.0]) for t in (0.0, 0.4, 1.2, 1.6)])
        self.assertIsNotNone(track.at(0.2))
        self.assertIsNone(track.at(0.8))
        self.assertIsNone(track.at(-0.1))
        self.assertIsNone(track.at(1.7))
        self.assertIsNone(track.displacement(0.2, 0.8))

    def test_heights_are_no_part_of_a_horizontal_speed(self):
        at = [6378137.0, 0.0, 0.0]  # on the equator: up is x, east is y
        track = truths.Track([(t, [at[0] + 7.0 * t, 3.0 * t, 4.0 * t], [7.0, 3.0, 4.0])
                              for t in (0.0, 0.5, 1.0)])
        self.assertAlmostEqual(truths.horizontal_speed(track, 0.0, 1.0), 5.0, places=5)

    def test_times_of_the_gps_week(self):
        self.assertEqual(truths.gps_seconds("1980-01-13T00:00:01.250"), 604801.25)


class VelocitiesTest(unittest.TestCase):
    def rows(self):
        # 1 m/s^2 eastwards, written 0.2 s late.
        return [(0.2 * k, "True" if k else "False", 0.2 * k - 0.2, 0.0, -3.0) for k in range(30)]

    def test_the_delay_is_taken_off(self):
        heard = truths.Velocities(run_with(self.rows()))
        self.assertEqual((heard.usable, heard.epochs, heard.delay_s), (29, 30, 0.2))
        self.assertAlmostEqual(heard.speed(1.0, 3.0, "displacement", "horizontal"), 2.0, places=9)
        self.assertAlmostEqual(heard.speed(1.0, 3.0, "mean_n_plus_1", "horizontal"), 2.0, places=9)
        self.assertAlmostEqual(heard.speed(1.0, 3.0, "mean_n", "horizontal"), 2.1, places=9)
        self.assertAlmostEqual(heard.speed(1.0, 3.0, "displacement", "vertical"), 3.0, places=9)

    def test_a_path_is_longer_than_its_displacement(self):
        rows = [(0.2 * k, "True", 1.0 if k < 15 else 0.0, 0.0 if k < 15 else 1.0, 0.0)
                for k in range(30)]
        heard = truths.Velocities(run_with(rows))
        self.assertGreater(heard.speed(1.0, 4.0, "path_length", "horizontal"), 0.95)
        self.assertLess(heard.speed(1.0, 4.0, "displacement", "horizontal"), 0.8)

    def test_nothing_is_said_across_a_gap(self):
        heard = truths.Velocities(run_with([row for row in self.rows()
                                            if not 1.5 < row[0] < 3.5]))
        self.assertIsNone(heard.speed(1.0, 4.0, "displacement", "horizontal"))


class DeviceTest(unittest.TestCase):
    def test_the_figure_of_the_same_window(self):
        file = Path(tempfile.mkdtemp()) / "results.txt"
        file.write_text("63.959 km/h 10:31:13 Run: 33 S2\n61.618 km/h 10:31:16 Run: 33 S10\n"
                        "63.056 km/h 10:45:49 Run: 41 S2\n")
        found = truths.device_result(file, "gps-speed-sailing-2s", "2021-10-20T08:31:11.300Z", 2.0)
        self.assertAlmostEqual(found, 63.959 / 3.6)
        self.assertIsNone(truths.device_result(file, "gps-speed-sailing-2s",
                                               "2021-10-20T09:31:11.300Z", 2.0))
        self.assertIsNone(truths.device_result(file, "nalsa", "2021-10-20T08:31:11.300Z", 2.0))


class TableTest(unittest.TestCase):
    def test_an_interval_holds_all_or_misses(self):
        self.assertEqual(table.judged(10.0, 1.0, [("a", 10.9), ("b", None)]), ("yes", "a 39.24"))
        holds, words = table.judged(10.0, 1.0, [("a", 10.9), ("b", 8.9)])
        self.assertEqual(holds, "NO")
        self.assertIn("b 32.04 MISSED", words)
        self.assertEqual(table.judged(10.0, 1.0, [("a", float("nan"))]), ("", ""))

    def test_a_line_for_what_only_one_of_the_two_has(self):
        row = {"outcome": "beaten", "speed_km_h": "50.000", "U_km_h": "0.500", "usable": 9,
               "epochs": 10, "holds": "yes", "truths": "reference 50.10", "reason": "Fast."}
        stream = io.StringIO()
        table.print_text({("car", "nalsa"): row},
                         {("car", "nalsa"): row, ("walk", "-"): {"outcome": "failed",
                                                                 "reason": "No heights."}},
                         stream)
        lines = stream.getvalue().splitlines()
        self.assertEqual(lines[1].count("50.000 ± 0.500          9/10 yes"), 2, lines[1])
        self.assertIn("failed", lines[2].split("|")[2])
        self.assertIn("car                        nalsa                          after     50.000",
                      stream.getvalue())


if __name__ == "__main__":
    unittest.main()
