#pragma once

#include <string>
#include <vector>

#include "supposed_errors.h"

namespace runcert {

/// The runs that screening is studied on: 10 and 20 Hz; 10 mm white noise, and 3 mm with 8 mm
/// Gauss-Markov of 2 s beside it. On the run of [DHD22] random motion of 1 m s^-2.5 that returns to
/// it within 10 s, so that it stays what a craft can do.
std::vector<StudyRun> screening_cells();

/// "10 Hz, 10 mm" or "20 Hz, 3 mm + 8 mm".
std::string cell_name(const StudyRun& run);

struct ScreeningStudyOptions {
    std::int64_t recordings = 1000;          ///< for the power, with four places for errors each
    std::int64_t screened = 400;             ///< of these, that are screened with the errors too
    std::int64_t scenario_recordings = 100;  ///< for each line of the identification tables
    std::int64_t clean_runs = 300;
    std::int64_t clean_epochs = 10'000;
    std::uint64_t seed = 1;
    unsigned threads = 0;  ///< 0: as many as there are
};

/// Of so many tries so many.
struct Share {
    std::int64_t of = 0;
    std::int64_t count = 0;

    void add(bool yes) {
        ++of;
        if (yes) ++count;
    }
    Share& operator+=(const Share& other) {
        of += other.of;
        count += other.count;
        return *this;
    }
    double fraction() const { return static_cast<double>(count) / static_cast<double>(of); }
};

/// What became of errors of the smallest detectable size and of twice that.
struct PowerLine {
    Hypothesis kind = Hypothesis::outlier;
    std::size_t epochs = 1;  ///< of a burst
    Share own_test;          ///< at the size: the error's own test rejects
    Share found_alone;       ///< at the size: by the whole of screening, one a recording
    Share found;             ///< the same of four a recording, 12 s from one another
    Share found_twice;       ///< at twice the size
    Share dated_twice;       ///< steps and shifts
    Share named_twice;
    std::int64_t left_out = 0;  ///< good epochs left out at twice the size

    PowerLine& operator+=(const PowerLine& other);
};

/// Puts errors of the sizes that screening states of an epoch into recordings of the cell: the own
/// test with the noise estimated from the clean recording, and the whole of screening, which
/// estimates it from the recording with the errors. Of ramps only one a recording where all is
/// screened, because it takes the stretches on both sides with it.
std::vector<PowerLine> study_power(const StudyRun& cell, const ScreeningStudyOptions& options);

/// How many of the clean runs have no mark at all. Acceleration and braking, forth and back.
Share study_clean(StudyRun cell, const ScreeningStudyOptions& options);

/// A heading and a line for each.
std::string power_table(const StudyRun& cell, const std::vector<PowerLine>& lines);

}  // namespace runcert
