#include <gtest/gtest.h>

#include <string>

#include "schemas/enu/declared.h"
#include "schemas/observations/observations.h"
#include "schemas/screened/screened.h"
#include "schemas/trajectory/declared.h"
#include "store_test_support.h"

// Whose clock made the time stamps, and who says the fix type.

namespace runcert::RUNCERT_FILE {
namespace {

using test::failure_of;
using test::replaced;

template <class Table>
Table table_of(std::string stage, const std::string& time_source) {
    Table table;
    table.header.stage = std::move(stage);
    table.header.program_version = "1.3.0";
    table.header.source_revision = "0123";
    table.facts.receiver = "primary";
    table.facts.time_source = time_source;
    return table;
}

Observations observations_of(const std::string& time_source = "unknown") {
    Observations table = table_of<Observations>("import", time_source);
    table.format = "csv";
    table.frame = "geodetic";
    table.time_scale = "gps";
    table.accuracy_source = "none";
    return table;
}

/// A table written with that source, and the source that is read from it or from another text.
struct TableKind {
    const char* name;
    std::string (*text)(const std::string& time_source);
    RecordingFacts (*facts)(const std::string& text);
};

constexpr TableKind kinds[] = {
    {"observations",
     [](const std::string& source) { return write_observations(observations_of(source)); },
     [](const std::string& text) { return read_observations(text, "f").facts; }},
    {"enu", [](const std::string& source) { return write_enu(table_of<EnuTable>("enu", source)); },
     [](const std::string& text) { return read_enu(text, "f").facts; }},
    {"screened",
     [](const std::string& source) {
         return write_screened(table_of<ScreenedTable>("screen", source));
     },
     [](const std::string& text) { return read_screened(text, "f").facts; }},
    {"trajectory",
     [](const std::string& source) {
         auto table = table_of<TrajectoryTable>("smooth", source);
         table.estimation.horizontal.noise.status = NoiseBasis::stated;
         return write_trajectory(table);
     },
     [](const std::string& text) { return read_trajectory(text, "f").facts; }},
};

TEST(TimeSource, StandsInEveryTable) {
    for (const TableKind& kind : kinds)
        for (const char* source : {"satellites", "attempt", "unknown"})
            EXPECT_EQ(kind.facts(kind.text(source)).time_source, source) << kind.name;
}

TEST(TimeSource, IsUnknownUntilSomebodySaysIt) {
    EXPECT_EQ(RecordingFacts{}.time_source, "unknown");
    for (const TableKind& kind : kinds) {
        const std::string text =
            replaced(kind.text("satellites"), "#   time_source: satellites\n", "");
        EXPECT_EQ(kind.facts(text).time_source, "unknown") << kind.name;
    }
}

TEST(TimeSource, HasOnlyKnownWords) {
    for (const TableKind& kind : kinds) {
        EXPECT_TRUE(failure_of([&] {
                        kind.text("clock");
                    }).contains("\"clock\" is not one of satellites, attempt, unknown"))
            << kind.name;
        const std::string text = kind.text("attempt");
        const auto said = failure_of(
            [&] { kind.facts(replaced(text, "time_source: attempt", "time_source: device")); });
        EXPECT_TRUE(said.contains("\"device\" is not one of satellites, attempt, unknown"))
            << kind.name << "\n"
            << said.problem;
    }
}

TEST(ObservationOrigins, RoundTrip) {
    Observations table = observations_of();
    table.time_origin = "UTC of the receiver: \"as written\"";
    for (const SolutionSource source : {SolutionSource::recording, SolutionSource::attempt,
                                        SolutionSource::partly, SolutionSource::unknown}) {
        table.solution_source = source;
        const Observations back = read_observations(write_observations(table), "f");
        EXPECT_EQ(back.time_origin, table.time_origin);
        EXPECT_EQ(back.solution_source, source);
    }
    const std::string text = write_observations(table);
    const std::string written = "solution_source: unknown";
    const std::size_t at = text.find(written);
    ASSERT_NE(at, std::string::npos);
    EXPECT_TRUE(failure_of([&] {
                    (void)read_observations(
                        std::string(text).replace(at, written.size(), "solution_source: guessed"),
                        "f");
                }).contains("\"guessed\" is not one of recording, attempt, partly, unknown"));
}

TEST(ObservationOrigins, WhatIsNotSaidIsAbsentOrUnknown) {
    const std::string text = write_observations(observations_of());
    EXPECT_EQ(text.find("time_origin"), std::string::npos);
    EXPECT_EQ(read_observations(text, "f").time_origin, "");
    EXPECT_EQ(read_observations(text, "f").solution_source, SolutionSource::unknown);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
