#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "core/failure.h"
#include "stages/import/cell.h"
#include "stages/import/recording.h"

namespace runcert::nmea {

/// The sentences that are read, whatever their talker.
enum class SentenceType : std::uint8_t { gga, gns, rmc, vtg, gst, gsa, zda, txt };

/// The name of a type, and how many fields, the address included, it must have and has in full.
struct SentenceKind {
    std::string_view word;
    std::size_t least, full;
};

/// In the order of SentenceType.
inline constexpr std::array<SentenceKind, 8> sentence_kinds{{{"GGA", 10, 15},
                                                             {"GNS", 10, 13},
                                                             {"RMC", 10, 12},
                                                             {"VTG", 8, 9},
                                                             {"GST", 9, 9},
                                                             {"GSA", 3, 18},
                                                             {"ZDA", 5, 7},
                                                             {"TXT", 0, 0}}};

/// What is wrong with a sentence as such, before its fields are looked at.
enum class Damage : std::uint8_t { none, checksum, cut_off };

/// A sentence, split into its fields: the address, "GPGGA", is the first of them.
struct Sentence {
    /// No sentence that is read has more; what follows is left out.
    static constexpr std::size_t most_fields = 24;

    SentenceType type = SentenceType::txt;
    Damage damage = Damage::none;
    bool has_checksum = false;
    const RecordingBytes* recording = nullptr;
    SourceLine line;
    std::string_view text;  ///< from $ to its end
    std::array<std::string_view, most_fields> fields;
    std::size_t size = 0;  ///< fields that are there

    /// A field; empty where the sentence ends before it.
    std::string_view operator[](std::size_t field) const {
        return field < size ? fields[field] : std::string_view();
    }
    /// The same with its place.
    Cell cell(std::size_t field) const;
};

/// Why a damaged sentence cannot be read.
Failure failure_of(const Sentence& sentence);

/// Counts of what was passed over.
struct PassedOver {
    std::int64_t lines_without_sentence = 0;
    std::int64_t other_sentences = 0;
};

/// Goes through a recording sentence by sentence, over whatever else stands on or between its
/// lines. Layout: NMEA 0183, section 5.3: $, talker and type, fields between commas, *, the
/// exclusive or of the bytes between $ and *, in two hexadecimal digits.
class SentenceReader {
  public:
    explicit SentenceReader(const RecordingBytes& recording)
        : recording_(recording), lines_(recording) {}

    /// The next sentence of a type that is read, or one whose checksum says that it is damaged;
    /// null at the end. Valid until the next call.
    const Sentence* next();

    const PassedOver& passed_over() const { return passed_over_; }

  private:
    bool next_on_line();

    const RecordingBytes& recording_;
    LineReader lines_;
    std::optional<SourceLine> line_;
    std::size_t from_ = 0;  ///< where on the line to go on
    bool sentence_on_line_ = false;
    Sentence sentence_;
    PassedOver passed_over_;
};

}  // namespace runcert::nmea
