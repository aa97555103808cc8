#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <string>

#include "core/geodesy.h"
#include "core/optional_number.h"
#include "schemas/observations/observations.h"
#include "stages/import/cell.h"
#include "stages/import/nmea/sentence.h"
#include "stages/import/row_collector.h"

/// What the fields of each sentence say. Layouts: NMEA 0183 version 4.11, section 6.3, as u-blox'
/// "F9 HPG interface description" (UBX-22008968) and the gpsd project's "NMEA Revealed" give them.
/// All fail at the field that they cannot read.
namespace runcert::nmea {

/// Nanoseconds since midnight of "hhmmss" or "hhmmss.ss" with up to nine decimals, exact. A second
/// 60 is one at 23:59 only.
std::int64_t read_time_of_day(const Cell& cell);

/// A number, and the step of its last decimal: how finely it is written.
struct WrittenNumber {
    OptionalReal value;
    double step = std::numeric_limits<double>::infinity();

    /// The same in another unit.
    WrittenNumber times(double factor) const {
        return value ? WrittenNumber{*value * factor, step * factor} : WrittenNumber();
    }
};

/// The more finely written of two; the first of equals.
inline const WrittenNumber& finer(const WrittenNumber& a, const WrittenNumber& b) {
    return b.step < a.step ? b : a;
}

/// A position and what was said of it, of a GGA, GNS or RMC sentence.
struct Solution {
    bool given = false;  ///< whether the epoch has such a sentence
    std::optional<RecordPlace> place;
    FixType fix = FixType::unknown;
    std::optional<Geodetic> position;  ///< height 0 where there is none
    bool has_height = false;
    bool above_sea_level = false;  ///< no geoid separation: the height is one above it
    OptionalReal separation_m;     ///< of the geoid, in the height where it is not zero
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

/// The talker ("GN") whose sentences are of the receiver that is read, and which types it writes:
/// of these, others' are left out.
struct ChosenTalker {
    std::string_view talker;
    unsigned types = 0;  ///< bit set of SentenceTypes
};

/// Which talkers write the sentences of a recording.
class Talkers {
  public:
    void see(const Sentence& sentence);

    /// The one with most positions, where those of several alternate: they are of several
    /// receivers, or of several solutions. A receiver that calls itself otherwise when it uses
    /// other satellites does so now and then. Nothing where it is one.
    std::optional<ChosenTalker> chosen() const;

  private:
    struct OfType {
        std::map<std::string_view, std::int64_t> count;
        std::string_view last;
        std::int64_t changes = 0;
    };
    std::array<OfType, sentence_kinds.size()> types_;
};

/// What was counted while sentences were joined.
struct Tally {
    unsigned sentences = 0;  ///< bit set of the SentenceTypes that were read
    Talkers talkers;
    std::int64_t of_other_talkers = 0;  ///< left out
    std::int64_t without_checksum = 0;
    std::int64_t without_time = 0;
    std::int64_t repeated = 0;       ///< of a type that its epoch had already
    std::int64_t odd_qualities = 0;  ///< GGA quality above 6
    std::int64_t of_simulator = 0;   ///< sentences whose quality is 8, or whose mode is S
    std::string device;
    Instrument instrument;
};

/// Joins the sentences of a recording into epochs: those of one time, as they follow each other.
/// Sentences that have no time field (VTG, GSA) belong to the time before them. Of several of one
/// type and time the first counts.
class EpochReader {
  public:
    /// `counts` is told of every sentence, unless it is null. Both must outlive this.
    EpochReader(const RecordingBytes& recording, RowCollector* counts,
                const std::optional<ChosenTalker>& chosen = std::nullopt)
        : sentences_(recording), counts_(counts), chosen_(chosen) {}

    /// The next epoch; nothing at the end.
    std::optional<Epoch> next();

    const Tally& tally() const { return tally_; }
    const PassedOver& passed_over() const { return sentences_.passed_over(); }

  private:
    bool is_of_other_talker(const Sentence& sentence) const;
    bool begins_next_epoch(const Sentence& sentence);
    void add_sentence(const Sentence& sentence);
    bool is_repeated(const Sentence& sentence);
    void count_bad(const Sentence& sentence, const Failure& why);
    void count_damaged(const Sentence& sentence);

    SentenceReader sentences_;
    RowCollector* counts_;
    std::optional<ChosenTalker> chosen_;
    const Sentence* held_ = nullptr;   ///< the first of the next epoch
    std::int64_t time_of_day_ns_ = 0;  ///< of the sentence at hand, where it has a time
    std::optional<Epoch> epoch_;
    Tally tally_;
};

/// Failure for a sentence with fewer fields than its type must have, and than it has in full where
/// no checksum shows that it is whole.
void require_whole(const Sentence& sentence);

/// Takes in what a sentence says, one that is whole. A position only where GGA, GNS or RMC says
/// that there is one; position (without height), velocity and date of RMC all or nothing; of VTG
/// nothing where the receiver says that it is not valid; of GSA the count of lists by their modes.
void add_sentence(const Sentence& sentence, Epoch& epoch);

/// Whether an epoch has a sentence that says where the receiver is, or that it does not know.
bool says_position(const Epoch& epoch);

/// Whether every sentence that speaks of it says that there is a solution.
bool has_fix(const Epoch& epoch);

/// Of GGA, GNS and RMC, in this order, the first with a position, else the first that is there: the
/// row's place is its own.
const Solution& solution_of(const Epoch& epoch);

}  // namespace runcert::nmea
