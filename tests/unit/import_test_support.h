#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <optional>
#include <string>
#include <string_view>

#include "core/failure.h"
#include "stages/import/import.h"

namespace runcert::import_test {

inline std::string slurp(const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    EXPECT_TRUE(in.good()) << path;
    return {std::istreambuf_iterator<char>(in), {}};
}

/// A file of `tests/unit/data/import`.
inline std::string fixture(const std::string& name) {
    return slurp(RUNCERT_SOURCE_DIR "/tests/unit/data/import/" + name);
}

/// A file of the recorded data, or nothing where they are not there.
inline std::optional<std::string> recorded(const std::string& name) {
    const char* folder = std::getenv("RUNCERT_DATA");
    if (!folder) return std::nullopt;
    return slurp(std::string(folder) + "/" + name);
}

inline Receiver pos_receiver() {
    Receiver receiver;
    receiver.id = "primary";
    receiver.format = "auto";
    receiver.place = "attempt.yaml:5:5";
    return receiver;
}

/// A CSV receiver with columns time, latitude, longitude, height by those names.
inline Receiver csv_receiver() {
    Receiver receiver = pos_receiver();
    receiver.frame = StatedFrame{CoordinateFrame::geodetic};
    receiver.columns = {
        {"time", "time"}, {"latitude", "lat"}, {"longitude", "lon"}, {"height", "h"}};
    receiver.time_format = "seconds";
    receiver.time_scale = "gps";
    receiver.delimiter = "auto";
    return receiver;
}

inline Observations import_text(const Receiver& receiver, std::string_view text,
                                const std::string& name = "f") {
    return import_recording(receiver, {.name = name, .bytes = text});
}

/// The failure of importing `text`, as the user sees it; "read" where there is none.
inline std::string failure_of(const Receiver& receiver, std::string_view text) {
    try {
        (void)import_text(receiver, text);
    } catch (const Failure& failure) {
        EXPECT_FALSE(failure.remedy().empty());
        return failure.what();
    }
    return "read";
}

/// What is wrong with `text`: the failure of importing it, or else the first record that could not
/// be read; "read" where there is neither.
inline std::string complaint_of(const Receiver& receiver, std::string_view text) {
    const std::string failure = failure_of(receiver, text);
    if (failure != "read") return failure;
    const Observations read = import_text(receiver, text);
    if (read.records.bad == 0) return "read";
    const BadRecord& bad = read.records.bad_records.front();
    return fmt::format("f:{}:{}: {}", *bad.line, bad.column.value_or(0), bad.what);
}

inline bool has(const std::string& text, std::string_view part) {
    return text.find(part) != std::string::npos;
}

inline bool has_note(const Observations& observations, std::string_view part) {
    return std::any_of(observations.notes.begin(), observations.notes.end(),
                       [&](const std::string& note) { return has(note, part); });
}

/// All of the notes, a line each.
inline std::string noted(const Observations& observations) {
    std::string all;
    for (const std::string& note : observations.notes)
        all += note + "\n";
    return all;
}

inline std::string replaced(std::string text, std::string_view from, std::string_view to) {
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    if (at != std::string::npos) text.replace(at, from.size(), to);
    return text;
}

}  // namespace runcert::import_test
