#include <nlohmann/json.hpp>

#include "golden_files.h"

// Attempt, rule, day and simulation: what today's reader finds in their golden files.

namespace runcert::RUNCERT_FILE {
namespace {

using golden::text_of;

TEST(GoldenAttempt, Receivers) {
    const Attempt attempt = read_attempt(text_of("v1.0/attempt.yaml"), "f");
    EXPECT_EQ(attempt.id, "urban-car_2");
    EXPECT_EQ(attempt.place, "\xe5\x90\x8d\xe5\x8f\xa4\xe5\xb1\x8b (Nagoya)");
    EXPECT_EQ(attempt.date, "2022-03-18");
    EXPECT_EQ(attempt.craft.sail_area_m2, 7.75);
    EXPECT_EQ(attempt.receivers.at(0).device_deduction->speed, 0.25);
    EXPECT_EQ(attempt.receivers.at(0).device_deduction->unit, "kn");
    EXPECT_EQ(attempt.receivers.at(0).frame->utm_zone->zone, 53);
    EXPECT_TRUE(attempt.receivers.at(0).frame->utm_zone->northern);
    EXPECT_EQ(attempt.receivers.at(0).columns.size(), 12U);
    EXPECT_EQ(attempt.receivers.at(0).columns.at("sigma_up"), "7");
    EXPECT_EQ(attempt.receivers.at(0).lever_arm->at(2), -1.2);
    EXPECT_EQ(attempt.profiles.at(1), "rules/my-rule.yaml");
    EXPECT_EQ(attempt.overrides.size(), 42U);
}

TEST(GoldenAttempt, AgreementAndCalibration) {
    const Attempt attempt = read_attempt(text_of("v1.0/attempt.yaml"), "f");
    EXPECT_EQ(attempt.decision_rule_agreed->date, "2022-03-01");
    EXPECT_EQ(attempt.decision_rule_agreed->by, "the measurer, for the board and the team");
    const Calibration& calibration = attempt.receivers.at(0).calibration.value();
    EXPECT_EQ(calibration.certificate, "K-4711");
    EXPECT_EQ(calibration.laboratory, "a laboratory");
    EXPECT_EQ(calibration.date, "2022-02-03");
    EXPECT_EQ(calibration.expanded_uncertainty, 0.0625);
    EXPECT_EQ(calibration.unit, "km/h");
    EXPECT_EQ(calibration.quantity, "speed");
    EXPECT_FALSE(attempt.receivers.at(1).calibration);
}

TEST(GoldenAttempt, WhoAndWithWhat) {
    const Attempt attempt = read_attempt(text_of("v1.0/attempt.yaml"), "f");
    EXPECT_EQ(attempt.craft.registration, "AUS 17");
    EXPECT_EQ(attempt.pilot, "\u0646\u0648\u0631 \u5c71\u7530");
    EXPECT_EQ(attempt.organisation, "a club of land sailors");
    EXPECT_EQ(attempt.contact, "secretary@club.example, +81 52 000 0000");
    EXPECT_EQ(attempt.utc_offset, "+09:00");
    EXPECT_EQ(attempt.utc_offset_minutes, 540);
    EXPECT_EQ(attempt.receivers.at(0).instrument, (Instrument{.make = "a maker",
                                                              .model = "R10, second series",
                                                              .serial = "004711",
                                                              .firmware = "1.10",
                                                              .antenna = "geodetic, no. 12"}));
    EXPECT_FALSE(attempt.receivers.at(1).instrument);
}

TEST(GoldenAttempt, RecordingsAndRawObservations) {
    const Attempt attempt = read_attempt(text_of("v1.0/attempt.yaml"), "f");
    EXPECT_EQ(attempt.receivers.at(0).utc_offset_h, 9.0);
    EXPECT_EQ(attempt.receivers.at(0).start_date, "2022-03-18");
    EXPECT_EQ(attempt.receivers.at(0).gpsbabel_type, "garmin_fit");
    const Receiver& raw = attempt.receivers.at(1);
    EXPECT_EQ(raw.recordings, (std::vector<std::string>{"raw/rover.obs", "raw/rover2.obs"}));
    EXPECT_EQ(attempt.receivers.at(0).phase, "day 1/raw.obs");
    EXPECT_EQ(raw.base, "raw/base.obs");
    EXPECT_EQ(raw.navigation, (std::vector<std::string>{"raw/gps.nav", "raw/glonass.nav"}));
    EXPECT_EQ(raw.base_position->latitude.degrees(), 35.25);
    EXPECT_EQ(raw.solution_pass, "backward");
}

TEST(GoldenAttempt, Smoothing) {
    const Attempt attempt = read_attempt(text_of("v1.0/attempt.yaml"), "f");
    EXPECT_EQ(attempt.receivers.at(0).rotation_bound_deg, 7.5);
    EXPECT_FALSE(attempt.receivers.at(1).rotation_bound_deg);
    EXPECT_EQ(parameters_of(attempt, "smooth")->at("motion_model"), "singer");
    EXPECT_EQ(parameters_of(attempt, "smooth")->at("error_time_max_s"), 20);
    EXPECT_EQ(parameters_of(attempt, "window")->at("plane_scale_bound"), 0.0004);
    EXPECT_EQ(parameters_of(attempt, "smooth")->at("jerk_density"), 1.25);
    EXPECT_EQ(parameters_of(attempt, "smooth")->at("noise"), "stated");
    EXPECT_EQ(parameters_of(attempt, "window")->at("seed"), 42);
}

TEST(GoldenAttempt, Screening) {
    const Attempt attempt = read_attempt(text_of("v1.0/attempt.yaml"), "f");
    const nlohmann::ordered_json screen = *parameters_of(attempt, "screen");
    EXPECT_EQ(screen.at("family_false_alarm_rate"), 1e-4);
    EXPECT_EQ(screen.at("power"), 0.95);
    EXPECT_EQ(screen.at("burst_epochs_max"), 12);
    EXPECT_EQ(screen.at("noise"), "stated");
    EXPECT_EQ(screen.at("acceleration_max_m_s2"), 12.5);
    EXPECT_EQ(screen.at("jerk_max_m_s3"), 125);
    EXPECT_EQ(screen.at("vertical_rate_max_m_s"), 2.5);
    EXPECT_EQ(screen.at("velocity_delay_max_s"), 0.5);
    EXPECT_EQ(screen.at("velocity_share_max"), 0.04);
    EXPECT_EQ(screen.at("satellites_min"), 6);
    EXPECT_EQ(screen.at("ratio_min"), 2.5);
    EXPECT_EQ(screen.at("correction_age_max_s"), 12.5);
    EXPECT_EQ(screen.at("session_gap_s"), 120);
}

TEST(GoldenAttempt, OnTheEarth) {
    const Attempt attempt = read_attempt(text_of("v1.0/attempt.yaml"), "f");
    EXPECT_EQ(attempt.record->expanded_uncertainty, 0.25);
    EXPECT_EQ(attempt.record_for("nalsa")->speed, 202.9);
    EXPECT_EQ(attempt.record_for("my-rule")->speed, 50.25);
    EXPECT_EQ(attempt.record_for("my-rule")->expanded_uncertainty, 0.125);
    ASSERT_EQ(attempt.rules.size(), 2U);
    EXPECT_EQ(attempt.rules[0].figure, "margin.value");
    EXPECT_EQ(attempt.rules[0].value, 1.5);
    EXPECT_EQ(attempt.rules[0].reason, "as agreed beforehand");
    EXPECT_EQ(attempt.rules[1].profile, "my-rule");
    EXPECT_EQ(attempt.rules[1].value, 25.0);
    ASSERT_TRUE(attempt.course && attempt.wind && attempt.current && attempt.secondary_method);
    EXPECT_EQ(attempt.course->length_m, 502.25);
    EXPECT_EQ(attempt.course->length_expanded_uncertainty_m, 0.0125);
    EXPECT_EQ(attempt.course->start.left.geodetic->latitude.degrees(), 35.134875);
    EXPECT_EQ(attempt.course->start.right.geodetic->longitude.degrees(), 136.9775);
    EXPECT_EQ(attempt.course->finish.left.geodetic->longitude.degrees(), 136.980375);
    EXPECT_EQ(attempt.course->finish.right.geodetic->latitude.degrees(), 35.1385);
    EXPECT_EQ(parameters_of(attempt, "screen")->at("noise_scale_min"), 0.25);
    EXPECT_EQ(attempt.ground_height_m, 42.5);
    EXPECT_EQ(to_iso(attempt.part->to), "2022-03-18T08:52:18.250");
    EXPECT_EQ(attempt.part->source, "the judges' log");
    EXPECT_EQ(attempt.wind->file, "weather/wind.csv");
    EXPECT_EQ(attempt.wind->source, "mast at the start");
    EXPECT_EQ(attempt.current->expanded_uncertainty_m_s, 0.0625);
    ASSERT_TRUE(attempt.wheel && attempt.gates);
    EXPECT_EQ(attempt.wheel->file, "wheels/rear.csv");
    EXPECT_EQ(attempt.gates->expanded_uncertainty_m, 0.0125);
    EXPECT_EQ(attempt.gates->expanded_uncertainty_s, 0.0005);
    EXPECT_EQ(attempt.wheel->scale, 1.0125);
    EXPECT_EQ(attempt.speed_trap->file, "gun.csv");
    EXPECT_EQ(attempt.wheel->expanded_uncertainty_scale, 0.0025);
    EXPECT_EQ(attempt.secondary_method->method, "light gates");
    EXPECT_EQ(to_iso(attempt.secondary_method->times->start), "2022-03-18T08:51:36.250");
    EXPECT_EQ(to_iso(attempt.secondary_method->times->finish), "2022-03-18T08:51:45.125");
    EXPECT_EQ(attempt.secondary_method->times->expanded_uncertainty_s, 0.0025);
    EXPECT_FALSE(attempt.secondary_method->speed);
}

TEST(GoldenAttempt, InAPlane) {
    const Attempt attempt = read_attempt(text_of("v1.0/attempt.plane.yaml"), "f");
    EXPECT_EQ(attempt.profiles.size(), 7U);
    EXPECT_EQ(attempt.profiles.at(0), "gps-speed-sailing-2s");
    EXPECT_EQ(attempt.profiles.at(6), "gps-speed-sailing-alpha-500");
    EXPECT_EQ(*attempt.course->start.left.plane_m, (std::array<double, 2>{-10.5, 0.25}));
    EXPECT_EQ(*attempt.course->start.right.plane_m, (std::array<double, 2>{10.5, -0.25}));
    EXPECT_EQ(*attempt.course->finish.left.plane_m, (std::array<double, 2>{-12.5, 500.125}));
    EXPECT_EQ(*attempt.course->finish.right.plane_m, (std::array<double, 2>{12.5, 499.875}));
    EXPECT_DOUBLE_EQ(attempt.secondary_method->speed->speed_m_s, 50.5 * 1852.0 / 3600.0);
    EXPECT_DOUBLE_EQ(attempt.secondary_method->speed->expanded_uncertainty_m_s,
                     0.25 * 1852.0 / 3600.0);
    EXPECT_FALSE(attempt.secondary_method->times);
}

TEST(GoldenAttempt, SignaturesAndAmendment) {
    const Attempt attempt = read_attempt(text_of("v1.0/attempt.yaml"), "f");
    EXPECT_EQ(attempt.signatures, (std::vector<RoleSignatures>{{"measurer", 1}, {"observer", 2}}));
    ASSERT_TRUE(attempt.amends);
    EXPECT_EQ(attempt.amends->report_id, "0123456789abcdef");
    EXPECT_EQ(attempt.amends->sha256,
              "0011223344556677889900aabbccddeeff0011223344556677889900aabbccdd");
    EXPECT_EQ(attempt.amends->reason, "the antenna's height was wrong");
}

TEST(GoldenAttempt, ClaimsOfTheReceiver) {
    const Attempt attempt = read_attempt(text_of("v1.0/attempt.yaml"), "f");
    EXPECT_EQ(attempt.attempts_made, 3);
    EXPECT_EQ(attempt.receivers.at(0).solution, "float");
    EXPECT_EQ(attempt.receivers.at(0).time_source, "satellites");
    EXPECT_EQ(attempt.receivers.at(1).solution, "");
    EXPECT_EQ(attempt.receivers.at(1).time_source, "");
    EXPECT_EQ(parameters_of(attempt, "window")->at("clock_rate_bound"), 0.0025);
    EXPECT_EQ(parameters_of(attempt, "window")->at("fault_probability"), 0.003);
    EXPECT_EQ(read_attempt(text_of("v1.0/attempt.plane.yaml"), "f").attempts_made, 1);
}

TEST(GoldenProfile, Margin) {
    const Profile profile = read_profile(text_of("v1.0/profile.yaml"), "f");
    EXPECT_EQ(profile.id, "my-rule");
    EXPECT_EQ(profile.margin, 0.1);
    EXPECT_EQ(profile.rounding->mode, DecimalMode::nearest);
}

TEST(GoldenProfile, Uncertainty) {
    const Profile profile = read_profile(text_of("v1.0/profile.yaml"), "f");
    EXPECT_EQ(profile.uncertainty.tau_min_s, 1.0);
    EXPECT_EQ(profile.uncertainty.tau_max_s, 30.0);
    EXPECT_EQ(profile.uncertainty.selection_bias, SelectionTreatment::subtracted);
    EXPECT_EQ(profile.uncertainty.error_floor_m,
              (std::map<std::string, double>{{"fixed", 0.015},
                                             {"float", 0.25},
                                             {"ppp", 0.125},
                                             {"dgps", 0.75},
                                             {"sbas", 0.625},
                                             {"single", 1.5},
                                             {"dead_reckoning", 2.0},
                                             {"unknown", 0.03125}}));
    EXPECT_EQ(profile.uncertainty.fault_probability, 0.004);
}

TEST(GoldenProfile, OfAStretch) {
    const Profile profile = read_profile(text_of("v1.0/profile.yaml"), "f");
    EXPECT_EQ(profile.window_kind, WindowKind::time);
    EXPECT_EQ(profile.duration_s, 10.0);
    EXPECT_EQ(profile.dimension, Dimension::vertical);
    EXPECT_EQ(profile.speed_source, SpeedSource::position);
    EXPECT_TRUE(profile.exact_duration);
    EXPECT_EQ(profile.ends, WindowEnds::epochs);
    EXPECT_EQ(profile.windows, 1);
    EXPECT_EQ(profile.proximity_m, 25.0);
    EXPECT_EQ(profile.turn_deg, 120.0);
    EXPECT_EQ(profile.alpha, AlphaChoice::any);
    EXPECT_EQ(profile.runs.start_m_s, 4.0);
    EXPECT_EQ(profile.runs.stop_m_s, 0.5);
    EXPECT_EQ(profile.runs.stop_s, 2.5);
    EXPECT_EQ(profile.runs.turn_deg, 60.0);
    EXPECT_EQ(profile.opposite_runs_within_s, 1800.0);
    EXPECT_EQ(profile.margin_above, MarginBase::upper_limit);
    EXPECT_EQ(profile.current, CurrentUse::ignored);
    EXPECT_EQ(profile.result->mode, DecimalMode::truncate);
    EXPECT_EQ(profile.result->unit, "mph");
    EXPECT_EQ(profile.result->decimals, 1);
    EXPECT_EQ(profile.decision_probability, 0.95);
    ASSERT_EQ(profile.clauses.size(), 26U);
    const struct {
        std::size_t clause;
        const char *computation, *unit;
        std::optional<double> limit;
    } expected[] = {{6, "flatness", "m", 1.0},
                    {7, "slope", "%", 2.0},
                    {8, "straightness", "m", 5.0},
                    {9, "turning", "deg", 10.0},
                    {10, "standing_start", "", std::nullopt},
                    {11, "run_up", "m", 300.0},
                    {12, "wind_mean", "kn", 20.0},
                    {13, "wind_gust", "km/h", 50.0},
                    {14, "current", "mph", 1.0},
                    {15, "sampling_rate", "Hz", 5.0},
                    {16, "sample_accuracy", "m/s", 3.0},
                    {17, "opposite_runs", "", std::nullopt},
                    {18, "acceleration", "m/s2", 5.0},
                    {19, "satellites", "satellites", 5.0},
                    {20, "least_speed", "kn", 5.0},
                    {21, "device_deduction", "", std::nullopt},
                    {22, "sail_area", "", std::nullopt},
                    {23, "counted_part", "", std::nullopt},
                    {24, "start_height", "m", 4277.0},
                    {25, "validation_accuracy", "m/s", 3.0}};
    for (const auto& each : expected) {
        EXPECT_EQ(to_text(profile.clauses[each.clause].decided_by), each.computation);
        EXPECT_EQ(profile.clauses[each.clause].unit, each.unit);
        EXPECT_EQ(profile.clauses[each.clause].limit, each.limit);
    }
}

TEST(GoldenProfile, OfAPartAndItsBodysArithmetic) {
    const Profile profile = read_profile(text_of("v1.0/profile.yaml"), "f");
    EXPECT_EQ(profile.within->from.event, WindowEvent::at_height);
    EXPECT_EQ(profile.within->from.height_m, 4250.0);
    ASSERT_EQ(profile.within->to.size(), 2U);
    EXPECT_EQ(profile.within->to[0].speed_m_s, 12.5);
    const Profile jump = read_profile(text_of("v1.0/profile.part.yaml"), "f");
    EXPECT_EQ(jump.within->from.event, WindowEvent::exit);
    EXPECT_EQ(jump.within->from.speed_m_s, 12.5);
    EXPECT_FALSE(jump.within->validation_m);
    EXPECT_EQ(profile.within->to[1].event, WindowEvent::above_ground);
    EXPECT_EQ(profile.within->to[1].height_m, 1707.0);
    EXPECT_EQ(profile.within->validation_m, 1006.0);
    EXPECT_EQ(profile.arithmetic->source, SpeedSource::position);
    EXPECT_EQ(profile.arithmetic->definition, SpeedDefinition::displacement);
    EXPECT_EQ(profile.arithmetic->rounding.mode, DecimalMode::truncate);
    EXPECT_EQ(profile.arithmetic->rounding.decimals, 1);
}

TEST(GoldenProfile, OfACourse) {
    const Profile profile = read_profile(text_of("v1.0/profile.course.yaml"), "f");
    EXPECT_EQ(profile.window_kind, WindowKind::course);
    EXPECT_EQ(profile.distance_m, 500.0);
    EXPECT_EQ(profile.definition, SpeedDefinition::elapsed_time);
    EXPECT_EQ(profile.ends, WindowEnds::any);
    EXPECT_EQ(profile.margin_kind, MarginKind::elapsed_time);
    EXPECT_EQ(profile.margin, 0.0125);
    EXPECT_EQ(profile.current, CurrentUse::subtracted);
    EXPECT_EQ(profile.decision_probability, 0.975);
}

TEST(GoldenProfile, OverAnother) {
    const Profile profile = read_profile(text_of("v1.0/profile.extends.yaml"), "f");
    EXPECT_EQ(profile.id, "my-course");
    EXPECT_EQ(profile.distance_m, 600.0);
    EXPECT_EQ(profile.margin, 0.01);
    EXPECT_EQ(profile.clauses.at(0).text, "From line to line, 600 m.");
    EXPECT_EQ(profile.clauses.at(2).id, "current");
}

TEST(GoldenProfile, WhereItIsKnownFromAndHowLongItHolds) {
    const Profile profile = read_profile(text_of("v1.0/profile.yaml"), "f");
    EXPECT_EQ(profile.looked_at, "2026-11-27");
    EXPECT_EQ(profile.valid_from, "2025-03-01");
    EXPECT_EQ(profile.superseded_by, "my-next-rule");
    EXPECT_EQ(profile.superseded_from, "2027-01-01");
    EXPECT_EQ(profile.clauses.at(0).edition, "2026");
    EXPECT_EQ(profile.clauses.at(0).where, "2.3.1");
    EXPECT_EQ(profile.clauses.at(0).looked_at, "2026-11-20");
    EXPECT_EQ(profile.clauses.at(1).where, "");
    ASSERT_EQ(profile.questions.size(), 1U);
    EXPECT_EQ(profile.questions[0].id, "rounding");
    EXPECT_FALSE(profile.evidence);
}

TEST(GoldenProfile, OfEvidence) {
    const Profile profile = read_profile(text_of("v1.0/profile.evidence.yaml"), "f");
    EXPECT_TRUE(profile.evidence);
    EXPECT_EQ(profile.clauses.at(0).answered_by, (Answerer{.role = "witness", .count = 2}));
}

TEST(GoldenProfile, Signatures) {
    const Profile profile = read_profile(text_of("v1.0/profile.yaml"), "f");
    EXPECT_EQ(profile.signatures,
              (std::vector<RoleSignatures>{{"measurer", 2}, {"timekeeper", 1}}));
}

TEST(GoldenSimulation, Spec) {
    const SimulationDocument simulation = read_simulation(text_of("v1.0/simulation.yaml"), "f");
    EXPECT_EQ(simulation.run.top_speed_m_s, 60.0);
    EXPECT_EQ(duration_ms(simulation.run), 45'000);
    EXPECT_EQ(interval_ms(simulation.run), 100);
    EXPECT_EQ(simulation.attempt.at("id"), "simulated");
}

TEST(GoldenSimulation, CraftWithItsImuAndWheel) {
    const SimulationDocument simulation = read_simulation(text_of("v1.0/simulation.yaml"), "f");
    const SimulatedCraft& craft = simulation.craft.value();
    EXPECT_EQ(craft.course, CraftCourse::oval);
    EXPECT_EQ(craft.start_on_oval_m, 400.0);
    EXPECT_EQ(craft.antenna, (LeverArm{0.5, -0.25, -10.0}));
    EXPECT_EQ(craft.reference_point, (LeverArm{0.125, 0.0, 0.75}));
    EXPECT_EQ(craft.tape_error, (LeverArm{0.0, 0.0, 0.1}));
    EXPECT_EQ(craft.roll.amplitude_deg, 10.0);
    EXPECT_EQ(craft.pitch.frequency_hz, 0.4);
    EXPECT_EQ(simulation.imu->grade.errors->gyro_bias_deg_h, 5.0);
    EXPECT_EQ(simulation.imu->rate_hz, 200);
    EXPECT_EQ(simulation.imu->scale_error, 0.001);
    EXPECT_EQ(simulation.imu->late_s, 0.02);
    EXPECT_EQ(simulation.surface->width_m, 20.0);
    EXPECT_EQ(simulation.surface->spacing_m, 5.0);
    EXPECT_EQ(simulation.surface->vertical_sd_m, 0.05);
    EXPECT_EQ(simulation.surface->below_m, 0.5);
    EXPECT_EQ(simulation.wheel->noise_m_s, 0.05);
    EXPECT_EQ(simulation.wheel->scale, 1.25);
    EXPECT_EQ(simulation.wheel->stated_scale, 1.5);
    EXPECT_EQ(simulation.wheel->expanded_uncertainty_scale, 0.002);
    const SimulationDocument lake = read_simulation(text_of("v1.0/simulation.lake.yaml"), "f");
    EXPECT_EQ(lake.craft->course, CraftCourse::straight);
    EXPECT_EQ(lake.craft->leeway_deg, 2.5);
    EXPECT_EQ(lake.craft->tape_error, (LeverArm{}));
    EXPECT_EQ(lake.craft->pitch.amplitude_deg, 0.0);
    EXPECT_EQ(lake.imu->grade.name, "tactical");
    EXPECT_EQ(lake.imu->rate_hz, 100);
    EXPECT_FALSE(lake.wheel);
}

TEST(GoldenDay, EntriesWithTheirDefaults) {
    const DayFile day = read_day_file(text_of("v1.0/day.yaml"), "f");
    EXPECT_EQ(day.id, "lake-day_1");
    ASSERT_EQ(day.entries.size(), 4U);
    for (const DayEntry& entry : day.entries)
        EXPECT_FALSE(entry.refused) << entry.refused->what();

    EXPECT_EQ(day.entries[0].attempt, "heats/run-1.yaml");
    EXPECT_FALSE(day.entries[0].keys.is_defined());
    EXPECT_EQ(day.entries[0].line, 11);

    const auto attempt_of = [](const DayEntry& entry, const std::string& id) {
        return read_attempt(attempt_text(id, entry.keys, id), "f");
    };
    const Attempt second = attempt_of(day.entries[1], day.entries[1].id);
    EXPECT_EQ(second.id, "run-2");
    EXPECT_EQ(second.craft.name, "0042");
    EXPECT_EQ(second.craft.kind, "car");
    EXPECT_FALSE(second.record);
    ASSERT_EQ(second.receivers.size(), 1U);
    EXPECT_EQ(second.receivers[0].id, "primary");
    EXPECT_EQ(parameters_of(second, "smooth")->at("jerk_density"), 1.0);

    EXPECT_EQ(day.entries[2].id, "");
    const Attempt third = attempt_of(day.entries[2], "third");
    EXPECT_EQ(third.receivers.at(0).recordings,
              (std::vector<std::string>{"first.csv", "second run.csv"}));
    EXPECT_EQ(third.receivers[0].columns.size(), 2U);
    EXPECT_EQ(third.profiles, (std::vector<std::string>{"fisly"}));
    EXPECT_EQ(third.record->speed, 202.9);

    const Attempt heat = attempt_of(day.entries[3], day.entries[3].id);
    EXPECT_EQ(heat.id, "heat-1");
    EXPECT_EQ(heat.place, "\xe5\x90\x8d\xe5\x8f\xa4\xe5\xb1\x8b");
    EXPECT_EQ(heat.receivers.at(0).id, "secondary");
    EXPECT_EQ(heat.receivers[0].lever_arm->at(2), -1.25);
    EXPECT_EQ(heat.receivers.at(1).recordings.at(0), "left/1.csv");
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
