#pragma once

#include <cstddef>
#include <pugixml.hpp>
#include <string_view>
#include <vector>

#include "stages/import/cell.h"
#include "stages/import/row_collector.h"

namespace runcert::gpx {

/// A track point's text in a recording: from its start tag to its end tag.
struct Piece {
    std::string_view text;
    RecordPlace place;
    std::size_t column = 1;  ///< where it begins in its line, counted from 1
};

/// What was seen over all points, for the notes.
struct PointCounts {
    std::size_t without_time = 0;
    std::size_t without_zone = 0;  ///< times that do not say in which zone
};

/// Reads track points one after the other.
class PointReader {
  public:
    /// A longer piece is no track point.
    static constexpr std::size_t longest_piece = std::size_t{256} * 1024;

    explicit PointReader(const RecordingBytes& recording) : recording_(recording) {}

    /// The row of a point. Failure at the part that cannot be read. The row's written cells hold
    /// until the next call.
    TimedRow read(const Piece& piece);

    const PointCounts& counts() const { return counts_; }

  private:
    /// The texts of a point's elements; null where it has none.
    struct Texts {
        const char* height = nullptr;
        const char* geoid_height = nullptr;
        const char* time = nullptr;
        const char* fix = nullptr;
        const char* satellites = nullptr;
        const char* speed = nullptr;
        const char* course = nullptr;
    };

    Cell cell(const Piece& piece, const char* text) const;
    pugi::xml_node parse(const Piece& piece);
    Texts find_texts(pugi::xml_node point) const;
    void read_time(const Piece& piece, const char* text, TimedRow& row);
    double read_height(const Piece& piece, const Texts& texts);
    void read_position(const Piece& piece, pugi::xml_node point, const Texts& texts, TimedRow& row);
    void read_velocity(const Piece& piece, const Texts& texts, Observation& row);

    const RecordingBytes& recording_;
    std::vector<char> buffer_;
    pugi::xml_document document_;
    PointCounts counts_;
};

}  // namespace runcert::gpx
