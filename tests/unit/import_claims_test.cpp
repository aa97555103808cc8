#include <algorithm>
#include <set>

#include "import_test_support.h"
#include "stages/import/import.h"
#include "store/document_schema.h"

// Who says what the time stamps and the fix types are: the recording, or the attempt.

namespace runcert::RUNCERT_FILE {
namespace {

using namespace import_test;

/// A table of which the recording says these fix types.
Observations with_fixes(const std::vector<FixType>& fixes) {
    Observations observations;
    observations.format = "csv";
    for (const FixType fix : fixes)
        observations.rows.emplace_back().fix = fix;
    return observations;
}

std::vector<FixType> fixes_of(const Observations& observations) {
    std::vector<FixType> fixes;
    for (const Observation& row : observations.rows)
        fixes.push_back(row.fix);
    return fixes;
}

Receiver claiming(const std::string& solution, const std::string& time_source = "") {
    Receiver receiver = csv_receiver();
    receiver.solution = solution;
    receiver.time_source = time_source;
    return receiver;
}

using enum FixType;
using Fixes = std::vector<FixType>;

TEST(TimeOrigin, IsKnownOfEveryFormat) {
    for (const std::string& format : attempt_schema().find("receivers[].format")->values) {
        if (format == "auto") continue;
        Observations head;
        head.format = format;
        note_origins_of_head(pos_receiver(), head);
        EXPECT_FALSE(head.time_origin.empty()) << format;
        // Formats whose clock is whatever wrote them.
        const std::set<std::string> unknown{"csv",     "gpx",         "gpsbabel", "racechrono",
                                            "racebox", "trackaddict", "aim",      "fit"};
        const bool open = unknown.contains(format);
        EXPECT_EQ(head.facts.time_source, open ? "unknown" : "satellites") << format;
    }
}

TEST(TimeOrigin, OfAFormatThatIsNotKnownIsUnknown) {
    Observations head;
    head.format = "another";
    note_origins_of_head(pos_receiver(), head);
    EXPECT_EQ(head.time_origin, "");
    EXPECT_EQ(head.facts.time_source, "unknown");
}

TEST(TimeOrigin, IsTheAttemptsClaimOnlyWhereTheFormatLeavesItOpen) {
    for (const auto& [format, source] :
         {std::pair{"csv", "attempt"}, {"gpx", "attempt"}, {"nmea", "satellites"}}) {
        Observations head;
        head.format = format;
        note_origins_of_head(claiming("", "satellites"), head);
        EXPECT_EQ(head.facts.time_source, source) << format;
    }
}

TEST(KindOfSolution, ThatTheRecordingSaysIsNotChangedByTheAttempt) {
    for (const char* claimed : {"", "fixed"}) {
        Observations said = with_fixes({single, none, float_ambiguities});
        note_origins(claiming(claimed), said);
        EXPECT_EQ(fixes_of(said), (Fixes{single, none, float_ambiguities}));
        EXPECT_EQ(said.solution_source, SolutionSource::recording);
    }
}

TEST(KindOfSolution, ThatNobodySaysStaysUnknown) {
    Observations silent = with_fixes({unknown, unknown});
    note_origins(claiming(""), silent);
    EXPECT_EQ(fixes_of(silent), (Fixes{unknown, unknown}));
    EXPECT_EQ(silent.solution_source, SolutionSource::unknown);
    Observations partly = with_fixes({fixed, unknown});
    note_origins(claiming(""), partly);
    EXPECT_EQ(fixes_of(partly), (Fixes{fixed, unknown}));
    EXPECT_EQ(partly.solution_source, SolutionSource::partly);
}

TEST(KindOfSolution, ThatTheAttemptClaimsIsItsClaimAlsoWhereItIsOfSomeRowsOnly) {
    for (const std::string& word : attempt_schema().find("receivers[].solution")->values) {
        FixType kind = unknown;
        ASSERT_TRUE(from_text(word, kind)) << word;
        Observations silent = with_fixes({unknown, unknown});
        note_origins(claiming(word), silent);
        EXPECT_EQ(fixes_of(silent), (Fixes{kind, kind}));
        EXPECT_EQ(silent.solution_source, SolutionSource::attempt);
        Observations partly = with_fixes({single, unknown, none});
        note_origins(claiming(word), partly);
        EXPECT_EQ(fixes_of(partly), (Fixes{single, kind, none}));
        EXPECT_EQ(partly.solution_source, SolutionSource::attempt);
    }
}

TEST(KindOfSolution, OfARecordingWithoutRowsIsTheRecordings) {
    Observations empty = with_fixes({});
    note_origins(claiming("fixed"), empty);
    EXPECT_EQ(empty.solution_source, SolutionSource::recording);
}

/// Recordings in files that follow one another, as main.cpp reads them.
Observations joined(const Receiver& receiver, const std::vector<std::string>& texts) {
    std::vector<RecordingBytes> files;
    for (const std::string& text : texts)
        files.push_back({.name = fmt::format("{}.csv", files.size()), .bytes = text});
    return import_recordings(receiver, files, [](const Receiver& one, const RecordingBytes& file) {
        Observations read = import_recording(one, file);
        note_origins(one, read);
        return read;
    });
}

TEST(KindOfSolution, OfSeveralFilesIsAClaimWhereItIsOneOfAnyOfThem) {
    Receiver receiver = csv_receiver();
    receiver.start_gps = parse_gps_iso("2022-03-18T08:51:22.300");
    receiver.columns["fix"] = "Q";
    const std::string head = "time,lat,lon,h,Q\n";
    const std::string says = head + "0.0,35.5,-137.25,40.5,single\n0.1,35.6,-137.35,41,single\n";
    const std::string silent =
        head + "0.2,35.5,-137.25,40.5,unknown\n0.3,35.6,-137.35,41,unknown\n";
    EXPECT_EQ(joined(receiver, {says, silent}).solution_source, SolutionSource::partly);
    receiver.solution = "fixed";
    for (const auto& files : {std::vector{says, silent}, {silent, says}}) {
        const Observations all = joined(receiver, files);
        EXPECT_EQ(all.solution_source, SolutionSource::attempt);
        EXPECT_EQ(std::ranges::count(all.rows, fixed, &Observation::fix), 2);
        EXPECT_EQ(std::ranges::count(all.rows, single, &Observation::fix), 2);
    }
    EXPECT_EQ(joined(receiver, {says}).solution_source, SolutionSource::recording);
    EXPECT_EQ(joined(receiver, {says, silent}).time_origin, joined(receiver, {says}).time_origin);
    receiver.time_source = "satellites";
    EXPECT_EQ(joined(receiver, {says, silent}).facts.time_source, "attempt");
}

TEST(Origins, OutlastTheTable) {
    Observations written =
        import_text(claiming("float", "satellites"),
                    "time,lat,lon,h\n0.0,35.5,-137.25,40.5\n0.1,35.6,-137.35,41\n");
    note_origins(claiming("float", "satellites"), written);
    const Observations read = read_observations(write_observations(written), "f");
    EXPECT_EQ(read.facts.time_source, "attempt");
    EXPECT_EQ(read.solution_source, SolutionSource::attempt);
    EXPECT_EQ(read.time_origin, written.time_origin);
    EXPECT_EQ(fixes_of(read), (Fixes{float_ambiguities, float_ambiguities}));
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
