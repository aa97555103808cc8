#include "witness_study.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "draws.h"
#include "usefulness_study.h"

namespace runcert::RUNCERT_FILE {
namespace {

// Daily: an interval that is too narrow by a third holds 0.81, of 10 clean runs fewer than 9 with
// 0.6. The table by all draws is what `runcert-study witness` prints.
TEST(WitnessStudy, NoWitnessWidensOnAverageAndAllCover) {
    const WitnessStudyOptions options{.runs = draws({.daily = 10, .study = 500}),
                                      .faults = draws({.daily = 4, .study = 200})};
    for (const WitnessCell& cell : {WitnessCell{.part = 0.1}, WitnessCell{.part = 1.0}}) {
        const WitnessCellRuns runs = study_witnesses(cell, options);
        SCOPED_TRACE(witness_table(cell, runs));
        const WitnessLine alone = witness_line(cell, runs, StudyHeard::nothing);
        for (std::size_t i = 0; i < study_heard_names.size(); ++i) {
            const WitnessLine line = witness_line(cell, runs, static_cast<StudyHeard>(i));
            SCOPED_TRACE(study_heard_names[i]);
            EXPECT_LE(line.expanded_m_s, 1.0001 * alone.expanded_m_s);
            EXPECT_GE(line.probability, alone.probability - 1e-6);
            EXPECT_GE(line.held, options.runs > 100 ? 0.95 : 0.9);
            EXPECT_GE(line.coverage, options.runs > 100 ? 0.95 : 0.9);
            EXPECT_LE(line.refused, 0.01 + 1.0 / static_cast<double>(options.runs));
        }
        const auto ratio = [&](StudyHeard heard) {
            return witness_line(cell, runs, heard).expanded_m_s / alone.expanded_m_s;
        };
        EXPECT_LT(ratio(StudyHeard::fine_velocities), cell.part < 1.0 ? 0.8 : 0.95);
        EXPECT_LT(ratio(StudyHeard::phases), 0.25);
        EXPECT_LT(ratio(StudyHeard::receiver), 0.75);
        // Where positions alone and a witness differ most.
        EXPECT_GT(alone.tail_m_s,
                  5.0 * witness_line(cell, runs, StudyHeard::fine_velocities).tail_m_s);
        // What nobody observed says nothing of rare errors.
        EXPECT_NEAR(witness_line(cell, runs, StudyHeard::wheel).tail_m_s, alone.tail_m_s,
                    0.01 * alone.tail_m_s);
    }
}

TEST(WitnessStudy, AChosenWindowIsCovered) {
    for (const int rivals : {20, 60}) {
        const WitnessCell cell{.part = 1.0, .rivals = rivals};
        const WitnessCellRuns runs =
            study_witnesses(cell, {.runs = draws({.daily = 4, .study = 200}),
                                   .faults = draws({.daily = 4, .study = 100}),
                                   .only = StudyHeard::fine_velocities});
        SCOPED_TRACE(witness_table(cell, runs));
        for (const StudyHeard heard : {StudyHeard::nothing, StudyHeard::fine_velocities})
            EXPECT_GE(witness_line(cell, runs, heard).coverage,
                      runs.clean.size() > 100 ? 0.94 : 0.7);
    }
}

TEST(Usefulness, OfEachRowAndWitness) {
    const Usefulness found =
        study_usefulness({.part = 0.1}, draws({.daily = 6, .study = 100}), 1, 0);
    SCOPED_TRACE(usefulness_table({.part = 0.1}, found));
    // White noise is stated as the optimal estimator has it.
    EXPECT_NEAR(found.rows_m_s.at("w"), found.optimum.white_m_s, 0.2 * found.optimum.white_m_s);
    const auto expanded_km_h = [&](StudyHeard heard) {
        return 3.6 * found.expanded_m_s[static_cast<std::size_t>(heard)];
    };
    EXPECT_LE(expanded_km_h(StudyHeard::nothing), 0.25);
    EXPECT_LE(expanded_km_h(StudyHeard::fine_velocities), 0.175);
    EXPECT_LE(expanded_km_h(StudyHeard::phases), 0.045);
    EXPECT_LE(expanded_km_h(StudyHeard::receiver), 0.165);
    for (std::size_t i = 0; i < found.rms_m_s.size(); ++i)
        EXPECT_LE(2.0 * found.rms_m_s[i], found.expanded_m_s[i]) << study_heard_names[i];
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
