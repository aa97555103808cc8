#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "core/geodesy.h"
#include "stages/import/nmea/fields.h"
#include "stages/import/nmea/sentence.h"
#include "stages/import/row_collector.h"

namespace runcert::nmea {

/// A position and what was said of it, of a GGA, GNS or RMC sentence.
struct Solution {
    bool given = false;  ///< whether the epoch has such a sentence
    std::optional<RecordPlace> place;
    FixType fix = FixType::unknown;
    std::optional<Geodetic> position;  ///< height 0 where there is none
    bool has_height = false;
    bool above_sea_level = false;  ///< no geoid separation: the height is one above it
    std::array<std::string_view, 2> coordinates;  ///< as written
    decltype(Observation::satellites) satellites;
    OptionalReal age_s;
};

/// A velocity over ground, as far as it is known.
struct GroundVelocity {
    WrittenNumber speed_m_s;
    WrittenNumber course_deg;  ///< clockwise from true north
};

/// GST: how the receiver judges its position's errors. Empty is unknown.
struct ErrorStatistics {
    WrittenNumber semi_major_m, semi_minor_m;  ///< of the error ellipse
    OptionalReal orientation_deg;              ///< of its semi-major axis, from true north
    WrittenNumber sigma_north_m, sigma_east_m;
    OptionalReal sigma_up_m;
};

/// The sentences of one time.
struct Epoch {
    std::int64_t time_of_day_ns = 0;
    std::string_view time_text;
    unsigned sentences = 0;  ///< bit set of the SentenceTypes that it has
    Solution gga, gns, rmc;
    GroundVelocity vtg_velocity, rmc_velocity;
    ErrorStatistics errors;
    OptionalInteger date;                 ///< days since 1980-01-06
    int satellite_lists = 0;              ///< GSA
    int satellite_lists_without_fix = 0;  ///< of them, mode 1
    int satellite_lists_in_plane = 0;     ///< of them, mode 2: height not measured

    bool has(SentenceType type) const { return (sentences >> static_cast<unsigned>(type)) & 1U; }
};

/// What the joining of sentences came across.
struct Tally {
    unsigned sentences = 0;  ///< bit set of the SentenceTypes that were read
    std::int64_t without_checksum = 0;
    std::int64_t without_time = 0;
    std::int64_t repeated = 0;       ///< of a type that its epoch had already
    std::int64_t odd_qualities = 0;  ///< GGA quality above 6
    std::int64_t of_simulator = 0;   ///< sentences whose quality is 8, or whose mode is S
    std::string device;
};

/// Joins the sentences of a recording into epochs: those of one time, as they follow each other.
/// Sentences that have no time field (VTG, GSA) belong to the time before them. Of several of one
/// type and time the first counts.
class EpochReader {
  public:
    /// `counts` is told of every sentence, unless it is null. Both must outlive this.
    EpochReader(const RecordingBytes& recording, RowCollector* counts)
        : sentences_(recording), counts_(counts) {}

    /// The next epoch; nothing at the end.
    std::optional<Epoch> next();

    const Tally& tally() const { return tally_; }
    const PassedOver& passed_over() const { return sentences_.passed_over(); }

  private:
    bool begins_next_epoch(const Sentence& sentence);
    void take_in(const Sentence& sentence);
    void take_in_timed(const Sentence& sentence);
    bool is_repeated(const Sentence& sentence);
    void count_bad(const Sentence& sentence, const Failure& why);
    void count_damaged(const Sentence& sentence);

    SentenceReader sentences_;
    RowCollector* counts_;
    const Sentence* held_ = nullptr;   ///< the first of the next epoch
    std::int64_t time_of_day_ns_ = 0;  ///< of the sentence at hand, where it has a time
    std::optional<Epoch> epoch_;
    Tally tally_;
};

}  // namespace runcert::nmea
