#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "stages/import/recording.h"

namespace runcert {

/// A piece of a recording's text, and where it stands.
struct Cell {
    std::string_view text;
    const RecordingBytes* recording = nullptr;
    std::int64_t line = 0;
    std::size_t column = 1;  ///< byte in the line, counted from 1

    /// "file:line:column".
    std::string place() const;
    [[noreturn]] void fail(const std::string& what, const std::string& remedy) const;
};

/// "file:line:column" of a recording.
std::string place_in(const RecordingBytes& recording, std::int64_t line, std::size_t column);

/// The number of exactly `size` digits, at most nine, at `at`; nothing where they are not there.
std::optional<int> digits_at(std::string_view text, std::size_t at, std::size_t size);

// Each of these takes the whole text for its value, and fails at the cell otherwise; `meaning`
// ("height") says in the message what was looked for.

/// A finite decimal number. A decimal comma, nan and inf are refused in words of their own.
double read_real(const Cell& cell, std::string_view meaning);

/// A whole number from `least` to `most`, which may be printed as "7.0000000".
std::int64_t read_whole(const Cell& cell, std::string_view meaning, std::int64_t least,
                        std::int64_t most);

/// A standard deviation, in metres or metres a second; 0 where the recording writes 0, which means
/// that it is unknown. A negative one, or one above 1e9, fails.
double read_deviation(const Cell& cell, std::string_view meaning);

/// Seconds with at most nine decimals, as an exact count of nanoseconds; milliseconds where `shift`
/// is 3: that many more digits are decimals.
std::int64_t read_nanoseconds(const Cell& cell, std::string_view meaning, int shift = 0);

/// An empty cell is nothing; any other is read.
template <class Value, class... More>
auto unless_empty(const Cell& cell, Value (*read)(const Cell&, std::string_view, More...),
                  std::string_view meaning, More... more) -> std::optional<Value> {
    if (cell.text.empty()) return std::nullopt;
    return read(cell, meaning, more...);
}

}  // namespace runcert
