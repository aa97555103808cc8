#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "days/day_attempts.h"
#include "store/process.h"
#include "store_test_support.h"

namespace runcert::test {

namespace fs = std::filesystem;

/// A test with a folder `day` to fill.
class DayTest : public testing::Test {
  protected:
    DayTest() { fs::create_directory(day()); }

    fs::path day() const { return folder_.path() / "day"; }
    fs::path out() const { return folder_.path() / "out"; }

    void put(const fs::path& file, std::string_view text = "recording\n") const {
        fs::create_directories((day() / file).parent_path());
        spill(day() / file, text);
    }
    void put_attempt(const fs::path& file, const std::string& id) const {
        put(file, "schema: attempt/1.0\nid: " + id +
                      "\ncraft: {name: b, class: board}\nreceivers: [{id: primary, recording: "
                      "r.pos}]\nprofiles: [nalsa]\n");
    }
    /// A day file whose defaults are all that an attempt needs, with those entries.
    void put_day(const std::string& entries) const {
        put("day.yaml",
            "schema: day/1.0\n"
            "defaults: {craft: {name: A, class: board}, profiles: [nalsa]}\n"
            "attempts:\n" +
                entries);
    }
    Day read() const { return read_day({day()}, out()); }

  private:
    TemporaryFolder folder_;
};

inline std::vector<std::string> ids_of(const Day& day) {
    std::vector<std::string> ids;
    for (const GivenAttempt& attempt : day.attempts)
        ids.push_back((attempt.refused ? "!" : "") + attempt.id);
    return ids;
}

/// Whether one of a day's notes holds that text.
inline bool notes_say(const Day& day, std::string_view text) {
    for (const std::string& note : day.notes)
        if (note.find(text) != std::string::npos) return true;
    return false;
}

inline std::string said_of(const GivenAttempt& attempt) {
    return attempt.refused ? attempt.refused->what() : "";
}

using Ids = std::vector<std::string>;

}  // namespace runcert::test
