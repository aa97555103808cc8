#pragma once

#include <vector>

#include "schemas/screened/screened.h"

namespace runcert {

struct TimeCheckOptions {
    double nominal_interval_s = 0.0;  ///< not positive: the median step forward of the rows
    double gap_factor = 1.5;          ///< a step of more nominal intervals is a gap
    double session_gap_s = 60.0;      ///< a gap, or a set-back for good, beyond this: a new session
};

/// What the time stamps say about themselves. Reads rows in the order of the recording, usable or
/// not, whatever their arcs; marks nothing and joins nothing. Linear in the rows.
///
/// A step is the difference of the stamps of two rows in a row. Each step that is not regular (0 <
/// step <= `gap_factor` nominal intervals) is one fault at its later row, and is counted by its
/// sign: `gaps` (too long), `duplicates` (zero), `backward` (negative), so that the three add up to
/// the number of faults. A clock that was set back and counts on is thus one fault; the step that
/// brings it past the stamps it had before is judged by what it lies beyond the latest of them.
/// `longest_gap_s` is the longest time between two stamps that counts in `gaps`.
///
/// The kind of a fault is the first of these that holds:
/// - "duplicate": the stamp of the row before; size 0.
/// - "whole_second_shift": the clock jumped, not the craft; size in whole seconds. The step is a
///   whole number of seconds off one interval, to within 5 standard deviations of the intervals (1
///   ms at least, a quarter interval at most), and the positions go on as after one interval. 18 s
///   is what GPS time has been ahead of UTC by since 2017: a receiver that changed its time scale
///   when it received the leap seconds.
/// - "session": a gap longer than `session_gap_s`, or a clock set back by more for good, that is
///   until the recording or the session ends. `sessions` is one more than these. A single stamp
///   that is off by that much, between two rows in time, begins none.
/// - "gap", "backward". Sizes are the step less the mean interval: what is missing, or how far the
///   clock went back.
/// Faults are in the order of the rows; of more than 1000 the first 1000 are kept, the counts being
/// of all.
///
/// That positions go on is decided from the three rows before and the three after, with regular
/// steps among each three and a position and accuracy at the outer and inner ones. Let v be the
/// mean of the two velocities, tau the mean interval, d the displacement over the step. |d - v tau|
/// may be A = 5 u + a tau^2 / 2: u is its standard uncertainty from the stated standard deviations,
/// a = 10 m/s^2 bounds what a craft's acceleration does in between; the velocities may differ by 3
/// a tau and 5 u. It can be told only where the craft is fast: one that really moved through the
/// step, braking and speeding up by no more than a and not turning round, is at least v^2 / a
/// further (v T - a T^2 / 4 where T is too short to stop in), v being here the lower speed less 5
/// u, and that must exceed |v| tau by 2 A. A parked craft's clock jump is a gap.
///
/// `rate_deviation` is the mean regular step over the nominal interval, less one: positive for
/// stamps of a clock that runs fast. Nominal is the nearest of the intervals that receivers offer
/// (1/n s, n to 100, and whole seconds to 10) where it is within 2 %, and within a quarter
/// of what is between it and the next, else `options.nominal_interval_s`. `jitter_s` is the
/// standard deviation of the regular steps, rounding of the stamps included; both are 0 where too
/// few steps are regular.
///
/// `usual_interval_s` is the one of the intervals that receivers are set to which is nearest to the
/// mean regular step, `interval_s`, however far. `departure_s` is by how much regular steps in a
/// row lead away from it to one side, less 1e-4 of their time: by more than 20 ms, or with at least
/// five more steps to that side than to the other. Stamps that are rounded, or of a receiver whose
/// clock is off at single epochs, come back before.
TimeStampSummary examine_time(const std::vector<EnuEpoch>& rows, const TimeCheckOptions& options);

}  // namespace runcert
