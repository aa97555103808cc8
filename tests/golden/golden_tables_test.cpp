#include <nlohmann/json.hpp>

#include "golden_files.h"

// Tables: what today's reader finds in the golden files of the stages.

namespace runcert::RUNCERT_FILE {
namespace {

using golden::text_of;

TEST(GoldenTables, Observations) {
    const Observations table = read_observations(text_of("v1.0/1-observations.ecsv"), "f");
    EXPECT_EQ(table.header.stage, "import");
    EXPECT_EQ(table.header.source_revision, "0123456789ab");
    EXPECT_EQ(table.header.programs,
              (std::vector<CalledProgram>{{"gpsbabel", "1.8.0", std::string(64, 'd')},
                                          {"rnx2rtkp", "", std::string(64, 'e')}}));
    ASSERT_EQ(table.header.inputs.size(), 2U);
    EXPECT_EQ(table.header.inputs[1].original, "rover.pos");
    EXPECT_EQ(table.header.parameters.at("format"), "auto");
    EXPECT_EQ(table.facts.receiver, "primary");
    EXPECT_EQ(to_iso(*table.facts.first_epoch), "2022-03-18T08:51:22.300");
    EXPECT_EQ(table.facts.nominal_interval_s, 0.1);
    EXPECT_EQ(table.format, "rtklib-pos");
    EXPECT_EQ(table.frame, "geodetic");
    EXPECT_EQ(table.time_scale, "gps");
    EXPECT_EQ(table.accuracy_source, "recording");
    EXPECT_EQ(table.notes.at(1), "Time is GPST: \"as written\".");
    ASSERT_EQ(table.rows.size(), 5U);
    const Observation& row = table.rows[1];
    EXPECT_EQ(row.epoch, 2);
    EXPECT_EQ(row.time.nanoseconds, 100'000'000);
    EXPECT_EQ(row.latitude_deg, 35.134728483);
    EXPECT_EQ(row.longitude_deg, 136.97757227512);
    EXPECT_EQ(row.height_m, 104.7291);
    EXPECT_EQ(row.correlation_north_up, 0.0625);
    EXPECT_EQ(row.sigma_recorded_velocity_up_m_s, 0.1);
    EXPECT_EQ(row.fix, FixType::fixed);
    EXPECT_EQ(row.satellites, 16);
    EXPECT_EQ(row.ratio, 999.9);
    EXPECT_EQ(row.source_byte, 1163);
    EXPECT_FALSE(row.plane_east_m);
    EXPECT_EQ(table.rows[2].fix, FixType::float_ambiguities);
    EXPECT_EQ(table.rows[4].fix, FixType::none);
    EXPECT_FALSE(table.rows[4].latitude_deg);
    EXPECT_FALSE(row.recorded_speed_m_s || row.sigma_recorded_speed_m_s);
    EXPECT_FALSE(table.rows[3].recorded_velocity_east_m_s);
    EXPECT_EQ(table.rows[3].recorded_speed_m_s, 20.3125);
    EXPECT_EQ(table.rows[3].sigma_recorded_speed_m_s, 0.125);
}

TEST(GoldenTables, RecordsThatCouldNotBeRead) {
    const Observations table = read_observations(text_of("v1.0/1-observations.ecsv"), "f");
    EXPECT_EQ(table.variant, "with velocities");
    EXPECT_EQ(table.device, "logger, firmware 1.2");
    EXPECT_EQ(table.instrument, (Instrument{.make = "a maker",
                                            .model = "logger",
                                            .serial = "0017",
                                            .firmware = "1.20",
                                            .antenna = "patch, number 3"}));
    EXPECT_EQ(table.records.total, 7);
    EXPECT_EQ(table.records.bad, 2);
    ASSERT_EQ(table.records.bad_records.size(), 2U);
    const BadRecord& line = table.records.bad_records[0];
    EXPECT_EQ(line.line, std::optional<std::int64_t>(27));
    EXPECT_EQ(line.column, std::optional<std::int64_t>(14));
    EXPECT_EQ(line.byte, 1812);
    EXPECT_EQ(line.epoch, 2);
    EXPECT_EQ(line.what, "the height \"n/a\" is not a number");
    EXPECT_FALSE(table.records.bad_records[1].line);
    EXPECT_EQ(table.records.bad_records[1].file, std::optional<std::int32_t>(2));
}

TEST(GoldenTables, TheFactsOfARecordingStandInEveryTable) {
    const RecordingFacts facts[] = {
        read_observations(text_of("v1.0/1-observations.ecsv"), "f").facts,
        read_enu(text_of("v1.0/2-enu.ecsv"), "f").facts,
        read_screened(text_of("v1.0/3-screened.ecsv"), "f").facts,
        read_trajectory(text_of("v1.0/4-trajectory.ecsv"), "f").facts};
    for (const RecordingFacts& each : facts) {
        EXPECT_EQ(each.position_resolution_m, 0.0001);
        EXPECT_EQ(each.time_resolution_s, 0.001);
    }
}

TEST(GoldenTables, WhoseClockMadeTheTimeStampsStandsInEveryTable) {
    for (const RecordingFacts& facts :
         {read_observations(text_of("v1.0/1-observations.ecsv"), "f").facts,
          read_enu(text_of("v1.0/2-enu.ecsv"), "f").facts,
          read_screened(text_of("v1.0/3-screened.ecsv"), "f").facts,
          read_trajectory(text_of("v1.0/4-trajectory.ecsv"), "f").facts})
        EXPECT_EQ(facts.time_source, "satellites");
    const Observations table = read_observations(text_of("v1.0/1-observations.ecsv"), "f");
    EXPECT_EQ(table.time_origin, "GPS time of the receiver's measurements, as RTKLIB solved it");
    EXPECT_EQ(table.solution_source, SolutionSource::recording);
}

TEST(GoldenTables, TheFileOfEachRow) {
    const Observations observations = read_observations(text_of("v1.0/1-observations.ecsv"), "f");
    EXPECT_EQ(*observations.rows.at(1).source_file, 1);
    EXPECT_EQ(*observations.rows.at(2).source_file, 2);
    EXPECT_EQ(*read_enu(text_of("v1.0/2-enu.ecsv"), "f").rows.at(2).source_file, 2);
    const ScreenedTable screened = read_screened(text_of("v1.0/3-screened.ecsv"), "f");
    EXPECT_FALSE(screened.rows.at(0).source_file);
    EXPECT_EQ(*screened.rows.at(5).source_file, 2);
}

TEST(GoldenTables, Enu) {
    const EnuTable table = read_enu(text_of("v1.0/2-enu.ecsv"), "f");
    ASSERT_TRUE(table.origin);
    EXPECT_EQ(table.origin->position.latitude.degrees(), 35.134709483);
    EXPECT_EQ(table.origin->position.height_m, 104.728);
    EXPECT_EQ(table.origin->source, "attempt");
    ASSERT_EQ(table.origin->places.size(), 1U);
    EXPECT_EQ(table.origin->places[0].from.nanoseconds, 8'000'500'000'000);
    EXPECT_EQ(table.origin->places[0].position.longitude.degrees(), 138.5);
    EXPECT_EQ(table.origin->places[0].north_m, 13875.5);
    EXPECT_EQ(table.rows.at(3).north_m, 6.324);
    EXPECT_FALSE(table.rows.at(3).correlation_north_up);
    EXPECT_FALSE(table.rows.at(4).east_m);
}

TEST(GoldenSurface, VerticesAndTriangles) {
    const SurfaceTable table = read_surface(text_of("v1.0/1-surface.ecsv"), "f");
    EXPECT_EQ(table.format, "csv");
    EXPECT_TRUE(table.georeferenced);
    EXPECT_EQ(table.undulation_m, 37.5);
    EXPECT_EQ(table.vertical_sd_m, 0.0625);
    EXPECT_EQ(table.made_from.at(0).positions, 1234);
    EXPECT_EQ(table.found.turned, 1);
    ASSERT_EQ(table.rows.size(), 6U);
    EXPECT_EQ(table.rows[0].element, SurfaceElement::vertex);
    EXPECT_EQ(table.rows[0].latitude_deg, 35.134709483);
    EXPECT_EQ(table.rows[3].up_m, 3.75);
    EXPECT_FALSE(table.rows[3].source_line);
    EXPECT_EQ(table.rows[5].element, SurfaceElement::triangle);
    EXPECT_EQ(table.rows[5].corner_3, 4);
}

TEST(GoldenScreened, HeightsAboveTheSurface) {
    const SurfaceComparison surface =
        read_screened(text_of("v1.0/3-screened.ecsv"), "f").basis.surface.value();
    EXPECT_EQ(surface.compared, 15);
    EXPECT_EQ(surface.outside, 2);
    EXPECT_EQ(surface.antenna_height_m, 2.25);
    EXPECT_EQ(surface.offset_m, -0.8125);
    EXPECT_TRUE(surface.offset_removed);
    EXPECT_EQ(surface.detectable_m, 0.5165);
    EXPECT_EQ(surface.rejected, 1);
}

TEST(GoldenScreened, Epochs) {
    const ScreenedTable table = read_screened(text_of("v1.0/3-screened.ecsv"), "f");
    EXPECT_EQ(table.variance_factor, 1.2345);
    EXPECT_EQ(table.header.parameters.at("false_alarm_rate"), 1e-6);
    EXPECT_EQ(table.rows.at(0).break_before, ArcBreak::start);
    EXPECT_TRUE(table.rows.at(1).usable);
    EXPECT_EQ(table.rows.at(1).statistic, 2.0625);
    EXPECT_EQ(table.rows.at(1).threshold, 30.66485);
    EXPECT_EQ(table.rows.at(2).reason, Reason::float_ambiguities);
    EXPECT_EQ(table.rows.at(4).reason, Reason::no_position);
    EXPECT_FALSE(table.rows.at(4).arc);
}

TEST(GoldenScreened, Decisions) {
    const ScreenedTable table = read_screened(text_of("v1.0/3-screened.ecsv"), "f");
    ASSERT_EQ(table.rows.size(), 17U);
    const struct {
        std::size_t row;
        Reason reason;
        std::optional<ArcBreak> break_before;
        Hypothesis hypothesis;
        TestedAxes axes;
    } expected[] = {
        {1, Reason::none, std::nullopt, Hypothesis::outlier, TestedAxes::vertical},
        {3, Reason::outlier, std::nullopt, Hypothesis::outlier, TestedAxes::horizontal},
        {5, Reason::none, ArcBreak::step, Hypothesis::step, TestedAxes::vertical},
        {6, Reason::none, ArcBreak::step, Hypothesis::step, TestedAxes::horizontal},
        {7, Reason::burst, std::nullopt, Hypothesis::burst, TestedAxes::horizontal},
        {8, Reason::model, std::nullopt, Hypothesis::model, TestedAxes::horizontal},
        {9, Reason::none, ArcBreak::ramp, Hypothesis::ramp, TestedAxes::horizontal},
        {11, Reason::none, ArcBreak::time_shift, Hypothesis::time_shift, TestedAxes::horizontal},
        {12, Reason::velocity, std::nullopt, Hypothesis::velocity, TestedAxes::horizontal},
        {13, Reason::physical_limit, std::nullopt, Hypothesis::acceleration,
         TestedAxes::horizontal},
        {14, Reason::physical_limit, std::nullopt, Hypothesis::jerk, TestedAxes::horizontal},
        {15, Reason::physical_limit, std::nullopt, Hypothesis::vertical_rate, TestedAxes::vertical},
        {16, Reason::baseline, std::nullopt, Hypothesis::baseline, TestedAxes::horizontal}};
    for (const auto& each : expected) {
        const ScreenedEpoch& row = table.rows[each.row];
        EXPECT_EQ(row.reason, each.reason) << each.row;
        EXPECT_EQ(row.break_before, each.break_before) << each.row;
        EXPECT_EQ(row.hypothesis, each.hypothesis) << each.row;
        EXPECT_EQ(row.tested_axes, each.axes) << each.row;
    }
    EXPECT_FALSE(table.rows[0].hypothesis || table.rows[0].tested_axes);
}

TEST(GoldenScreened, EstimatedErrors) {
    const auto rows = read_screened(text_of("v1.0/3-screened.ecsv"), "f").rows;
    const EstimatedError& outlier = rows.at(3).estimated;
    EXPECT_EQ(outlier.east_m, 0.25);
    EXPECT_EQ(outlier.north_m, -0.125);
    EXPECT_EQ(outlier.sigma_east_m, 0.0175);
    EXPECT_EQ(outlier.sigma_north_m, 0.02);
    EXPECT_EQ(outlier.correlation_east_north, -0.375);
    EXPECT_FALSE(outlier.up_m || outlier.sigma_up_m || outlier.rate_east_m_s || outlier.time_s);
    EXPECT_EQ(rows.at(5).estimated.up_m, -0.5);
    EXPECT_EQ(rows.at(5).estimated.sigma_up_m, 0.03125);
    EXPECT_FALSE(rows.at(5).estimated.east_m);
    EXPECT_EQ(rows.at(9).estimated.rate_east_m_s, 0.375);
    EXPECT_EQ(rows.at(9).estimated.rate_north_m_s, -0.1875);
    EXPECT_EQ(rows.at(10).estimated.rate_up_m_s, -0.9375);
    EXPECT_EQ(rows.at(11).estimated.time_s, 0.012500125);
}

TEST(GoldenScreened, MinimalDetectableBiases) {
    const auto rows = read_screened(text_of("v1.0/3-screened.ecsv"), "f").rows;
    const MinimalDetectableBias& detectable = rows.at(0).detectable;
    EXPECT_EQ(detectable.outlier_m, 0.045);
    EXPECT_EQ(detectable.step_m, 0.0625);
    EXPECT_EQ(detectable.ramp_m_s, 0.75);
    EXPECT_EQ(detectable.time_s, 0.00125);
    EXPECT_EQ(detectable.outlier_up_m, 0.125);
    EXPECT_EQ(detectable.step_up_m, 0.1875);
    EXPECT_FALSE(rows.at(2).detectable.outlier_m || rows.at(2).detectable.step_up_m);
    EXPECT_EQ(rows.at(0).local_variance_factor, 1.0);
    EXPECT_EQ(rows.at(1).local_variance_factor, 1.375);
    EXPECT_FALSE(rows.at(2).local_variance_factor);
}

TEST(GoldenScreened, WhatTheTestsRestedOn) {
    const ScreenedTable table = read_screened(text_of("v1.0/3-screened.ecsv"), "f");
    const ScreeningBasis& basis = table.basis;
    EXPECT_EQ(basis.family_false_alarm_rate, 0.001);
    EXPECT_EQ(basis.tests, 4'000'000);
    EXPECT_EQ(basis.test_size, 2.5e-10);
    EXPECT_EQ(basis.power, 0.8);
    EXPECT_EQ(basis.burst_epochs_max, 12);
    EXPECT_EQ(basis.passes, 3);
    ASSERT_EQ(basis.models.size(), 2U);
    EXPECT_EQ(basis.models[0].axes, TestedAxes::horizontal);
    EXPECT_EQ(basis.models[0].error_sigma_m, 0.0125);
    EXPECT_EQ(basis.models[0].error_tau_s, 2.5);
    EXPECT_EQ(basis.models[1].axes, TestedAxes::vertical);
    EXPECT_EQ(basis.models[1].noise, NoiseBasis::too_few_epochs);
    EXPECT_EQ(basis.models[1].jerk_density, 0.6);
    EXPECT_EQ(basis.models[1].measurement_scale, 1.5);
    EXPECT_EQ(basis.models[1].white_scale, 1.75);
    ASSERT_EQ(basis.fix_types.size(), 2U);
    EXPECT_EQ(basis.fix_types[1].fix, FixType::float_ambiguities);
    EXPECT_EQ(basis.fix_types[1].axes, TestedAxes::vertical);
    EXPECT_EQ(basis.fix_types[1].epochs, 1);
    EXPECT_EQ(basis.fix_types[1].variance_factor, 4.5);
    EXPECT_EQ(basis.fix_types[1].judgement, AccuracyJudgement::optimistic);
}

TEST(GoldenScreened, WhatOtherChecksFound) {
    const ScreenedTable table = read_screened(text_of("v1.0/3-screened.ecsv"), "f");
    const ScreeningBasis& basis = table.basis;
    EXPECT_EQ(basis.velocity->compared, 12);
    EXPECT_EQ(basis.velocity->delay_s, 0.2125);
    EXPECT_EQ(basis.velocity->sigma_delay_s, 0.00375);
    EXPECT_EQ(basis.velocity->scale_m_s, 0.0475);
    EXPECT_EQ(basis.velocity->rejected, 1);
    EXPECT_EQ(basis.velocity->contradicted_share, 0.0625);
    EXPECT_TRUE(basis.velocity->unfit);
    ASSERT_EQ(basis.velocity->delays.size(), 1U);
    EXPECT_EQ(basis.velocity->delays[0].first_epoch, 3);
    EXPECT_EQ(basis.velocity->delays[0].last_epoch, 9);
    EXPECT_EQ(basis.velocity->delays[0].delay_s, 43.5);
    EXPECT_EQ(basis.velocity->delays[0].sigma_s, 0.25);
    EXPECT_EQ(basis.velocity->delays[0].difference_m_s, 0.3125);
    EXPECT_EQ(basis.velocity->delays[0].difference_within_m_s, 6.25);
    EXPECT_TRUE(basis.velocity->delays[0].beyond);
    ASSERT_EQ(basis.displacements.size(), 2U);
    EXPECT_EQ(basis.displacements[0].kind, WitnessKind::phases);
    EXPECT_EQ(basis.displacements[0].rejected, 2);
    EXPECT_EQ(basis.displacements[0].spreads.at(0).sd_upper_m, 0.015625);
    EXPECT_EQ(basis.displacements[1].kind, WitnessKind::receiver);
    EXPECT_EQ(basis.displacements[1].receiver, "secondary");
    EXPECT_TRUE(basis.displacements[1].spreads.empty());
    EXPECT_EQ(basis.time.sessions, 2);
    EXPECT_EQ(basis.time.longest_gap_s, 75.100000001);
    EXPECT_EQ(basis.time.rate_deviation, -2.5e-8);
    EXPECT_EQ(basis.time.jitter_s, 0.000015625);
    ASSERT_EQ(basis.time.faults.size(), 2U);
    EXPECT_EQ(basis.time.faults[1].epoch, 2);
    EXPECT_EQ(basis.time.faults[1].kind, TimeFaultKind::whole_second_shift);
    EXPECT_EQ(basis.time.faults[1].size_s, -1.0);
    EXPECT_EQ(basis.limits.jerk_max_m_s3, 200.0);
    EXPECT_EQ(basis.limits.acceleration_m_s2, 8.75);
    EXPECT_EQ(basis.limits.vertical_rate_m_s, 0.375);
    EXPECT_EQ(basis.limits.rejected, 3);
    EXPECT_EQ(basis.baseline->receiver, "secondary");
    EXPECT_EQ(basis.baseline->length_m, 1.25);
    EXPECT_EQ(basis.baseline->sd_m, 0.0125);
}

TEST(GoldenScreened, SignsOfTheDeviceAndManoeuvres) {
    const ScreenedTable table = read_screened(text_of("v1.0/3-screened.ecsv"), "f");
    ASSERT_TRUE(table.basis.device);
    EXPECT_EQ(table.basis.device->moving, 15);
    EXPECT_EQ(table.basis.device->held, 2);
    EXPECT_EQ(table.basis.device->interpolated, 3);
    EXPECT_EQ(table.basis.device->by_chance, 0.25);
    ASSERT_EQ(table.rows.size(), 17U);
    EXPECT_FALSE(table.rows[0].manoeuvre_m_s2 || table.rows[0].manoeuvre_up_m_s2);
    EXPECT_EQ(table.rows[1].manoeuvre_m_s2, 6.125);
    EXPECT_FALSE(table.rows[1].manoeuvre_up_m_s2);
    EXPECT_FALSE(table.rows[5].manoeuvre_m_s2);
    EXPECT_EQ(table.rows[5].manoeuvre_up_m_s2, 0.875);
    EXPECT_EQ(table.rows[11].manoeuvre_m_s2, 2.25);
    EXPECT_EQ(table.rows[11].manoeuvre_up_m_s2, 0.375);
}

TEST(GoldenTrajectory, Epochs) {
    const TrajectoryTable table = read_trajectory(text_of("v1.0/4-trajectory.ecsv"), "f");
    EXPECT_EQ(table.estimation.degrees_of_freedom, 15);
    EXPECT_EQ(table.estimation.variance_factor, 0.9876);
    EXPECT_EQ(table.estimation.largest_position_difference_m, 2.5e-11);
    EXPECT_EQ(table.rows.at(2).speed_m_s, 21.158421);
    EXPECT_EQ(table.rows.at(2).speed_v2_m_s, 21.17);
    EXPECT_FALSE(table.rows.at(3).speed_v1_m_s);
    EXPECT_TRUE(table.rows.at(3).usable);
    EXPECT_FALSE(table.rows.at(4).speed_m_s);
    EXPECT_EQ(table.rows.at(2).arc, 1);
}

TEST(GoldenTrajectory, RobustEstimateAndNoise) {
    const TrajectoryTable table = read_trajectory(text_of("v1.0/4-trajectory.ecsv"), "f");
    EXPECT_EQ(table.rows.at(1).robust_east_m, -0.181875);
    EXPECT_EQ(table.rows.at(1).robust_north_m, 2.10775);
    EXPECT_EQ(table.rows.at(2).robust_weight, 0.125);
    EXPECT_FALSE(table.rows.at(3).robust_weight);
    EXPECT_FALSE(table.rows.at(4).robust_east_m);
    EXPECT_EQ(table.estimation.batch_stretches, 2);
    EXPECT_EQ(table.estimation.robust_downweighted, 1);
    ASSERT_TRUE(table.estimation.vertical);
    const NoiseSummary& noise = table.estimation.horizontal.noise;
    EXPECT_EQ(noise.status, NoiseBasis::fitted);
    EXPECT_EQ(noise.jerk_density.value, 0.6125);
    EXPECT_EQ(noise.jerk_density.relative_uncertainty, 0.0875);
    EXPECT_EQ(noise.acceleration_time_s->value, 4.5);
    EXPECT_TRUE(noise.error_tau_s->at_bound);
    EXPECT_EQ(noise.error_tau_s->relative_uncertainty, 1.75);
    ASSERT_EQ(noise.posterior.size(), 2U);
    EXPECT_EQ(noise.posterior[0].acceleration_time_s, 4.5);
    EXPECT_FALSE(noise.posterior[1].acceleration_time_s);
    EXPECT_EQ(noise.posterior[1].weight, 0.25);
    EXPECT_EQ(table.estimation.horizontal.health.largest_asymmetry, 1.25e-16);
    EXPECT_EQ(table.estimation.horizontal.health.spans_outside, 1);
    EXPECT_EQ(table.estimation.vertical->noise.status, NoiseBasis::constant_positions);
    EXPECT_FALSE(table.estimation.vertical->health.consistent);
}

TEST(GoldenTrajectory, RobustSolutionsThatAreMissing) {
    const TrajectoryTable table = read_trajectory(text_of("v1.0/4-trajectory.ecsv"), "f");
    ASSERT_EQ(table.rows.size(), 5U);
    EXPECT_EQ(table.estimation.robust_unsolved, 2);
}

TEST(GoldenTrajectory, JerkDensityOfEachEpoch) {
    const auto rows = read_trajectory(text_of("v1.0/4-trajectory.ecsv"), "f").rows;
    ASSERT_EQ(rows.size(), 5U);
    EXPECT_EQ(rows[0].jerk_density, 0.6125);
    EXPECT_EQ(rows[0].jerk_density_up, 0.6);
    EXPECT_EQ(rows[2].jerk_density, 1.9375);
    EXPECT_EQ(rows[3].jerk_density, 6.125);
    EXPECT_EQ(rows[3].jerk_density_up, 0.75);
    EXPECT_FALSE(rows[4].jerk_density || rows[4].jerk_density_up);  // outside arcs
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
