#pragma once

#include <vector>

#include "schemas/screened/screened.h"

namespace runcert {

/// Parameters of the examination of time stamps.
struct TimeCheckOptions {
    double nominal_interval_s = 0.0;  ///< if not positive, the median forward step of the rows
    double gap_factor = 1.5;          ///< a step of more nominal intervals is a gap
    double session_gap_s = 60.0;  ///< a longer gap, or a larger permanent set-back, begins a new
                                  ///< session
};

/// Examines the consistency of the time stamps. Reads rows in the order of the recording, usable or
/// not, whatever their arcs. Marks nothing and joins nothing. The cost is linear in the rows.
///
/// A step is the difference of the stamps of two consecutive rows. A step is regular if
/// 0 < step <= `gap_factor` nominal intervals. Any other is one fault at its later row, counted by
/// its sign: `gaps` (too long), `duplicates` (zero), `backward` (negative). The three sum to the
/// number of faults. A clock that was set back and runs on is thus one fault. The step that brings
/// it past its earlier stamps is judged by how far it goes beyond the latest of them.
/// `longest_gap_s` is the longest time between two stamps that counts in `gaps`.
///
/// The kind of a fault is the first of these that holds:
/// - "duplicate": the stamp of the previous row; size 0.
/// - "whole_second_shift": the clock jumped, not the craft; size in whole seconds. The step is a
///   whole number of seconds off one interval, to within 5 standard deviations of the intervals (at
///   least 1 ms, at most a quarter interval), and the positions continue as after one interval. GPS
///   time has been 18 s ahead of UTC since 2017: a jump of that size is a receiver that changed its
///   time scale when it received the leap seconds.
/// - "session": a gap longer than `session_gap_s`, or a clock set back by more for good, that is,
///   until the recording or the session ends. `sessions` is one more than the number of these. A
///   single stamp that is off by that much, between two rows in time, begins none.
/// - "gap", "backward". Sizes are the step minus the mean interval: the time missing, or how far
///   the clock went back.
///
/// Faults are in the order of the rows. Only the first 1000 are kept, but the counts include all.
///
/// Whether positions continue is decided from the three rows before and the three after. Steps
/// within each three must be regular, with a position and standard deviations at the outer and
/// inner rows. Let v be the mean of the two velocities, tau the mean interval, and d the
/// displacement over the step. |d - v tau| may be up to A = 5 u + a tau^2 / 2. Here u is its
/// standard uncertainty from the stated standard deviations, and a = 10 m/s^2 bounds the craft's
/// acceleration in between. The velocities may differ by 3 a tau and 5 u.
///
/// This can be decided only where the craft is fast. A craft that really moved through the step,
/// changing speed by no more than a and not reversing, goes at least v^2 / a (v T - a T^2 / 4 where
/// T is too short to stop in). Here v is the lower speed minus 5 u, and that distance must exceed
/// |v| tau by 2 A. A clock jump of a parked craft counts as a gap.
///
/// `rate_deviation` is the mean regular step over the nominal interval, minus one: positive for
/// stamps of a fast clock. The nominal interval is the nearest that receivers offer (1/n s, n to
/// 100, and whole seconds to 10), if it is within 2 % and within a quarter of the distance to the
/// next. Otherwise it is `options.nominal_interval_s`. `jitter_s` is the standard deviation of the
/// regular steps, rounding of the stamps included. Both are 0 if too few steps are regular.
///
/// `usual_interval_s` is the interval in common use on receivers that is nearest to the mean
/// regular step, `interval_s`, however far. `departure_s` is how far consecutive regular steps lead
/// away from it to one side, minus 1e-4 of their time. It counts if it exceeds 20 ms, or with at
/// least five more steps to that side than to the other. Stamps that are rounded, or of a receiver
/// whose clock is off at single epochs, return before that.
TimeStampSummary examine_time(const std::vector<EnuEpoch>& rows, const TimeCheckOptions& options);

}  // namespace runcert
