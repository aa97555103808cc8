#include "stages/import/nmea/sentence.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstring>

#include "core/text.h"

namespace runcert::nmea {
namespace {

constexpr auto npos = std::string_view::npos;

bool is_upper_or_digit(char c) {
    return (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
}

/// Whether a text begins as a sentence does: $, an address, a comma.
bool begins_sentence(std::string_view text) {
    const std::size_t comma = text.substr(0, 12).find(',');
    if (comma == npos || comma < 4 || text[0] != '$') return false;
    for (const char c : text.substr(1, comma - 1))
        if (!is_upper_or_digit(c)) return false;
    return true;
}

/// The type of a sentence that is read, by its text from $ on.
std::optional<SentenceType> type_of(std::string_view text) {
    if (text.size() < 7 || text[6] != ',') return std::nullopt;
    const auto kind = std::ranges::find(sentence_kinds, text.substr(3, 3), &SentenceKind::word);
    if (kind == sentence_kinds.end()) return std::nullopt;
    return static_cast<SentenceType>(kind - sentence_kinds.begin());
}

unsigned exclusive_or(std::string_view bytes) {
    std::uint64_t eight = 0;
    std::size_t i = 0;
    for (; i + sizeof eight <= bytes.size(); i += sizeof eight) {
        std::uint64_t more = 0;
        std::memcpy(&more, bytes.data() + i, sizeof more);
        eight ^= more;
    }
    eight ^= eight >> 32;
    eight ^= eight >> 16;
    eight ^= eight >> 8;
    for (; i < bytes.size(); ++i)
        eight ^= static_cast<unsigned char>(bytes[i]);
    return static_cast<unsigned>(eight & 0xff);
}

/// The checksum written after the *; nothing where its two digits are not there.
std::optional<unsigned> written_checksum(std::string_view after_star) {
    if (after_star.size() < 2) return std::nullopt;
    unsigned value = 0;
    const char* const end = after_star.data() + 2;
    if (std::from_chars(after_star.data(), end, value, 16).ptr != end) return std::nullopt;
    return value;
}

/// `text`: from $ to the next sentence or the end of the line. `may_be_cut`: something else than
/// the end of a line follows, and only a checksum shows that the sentence is whole.
Damage damage_of(std::string_view text, std::size_t star, bool may_be_cut) {
    if (star == npos) return may_be_cut ? Damage::cut_off : Damage::none;
    const auto written = written_checksum(text.substr(star + 1));
    if (!written) return Damage::cut_off;
    return *written == exclusive_or(text.substr(1, star - 1)) ? Damage::none : Damage::checksum;
}

void split_fields(Sentence& sentence, std::string_view body) {
    sentence.size = 0;
    while (sentence.size < Sentence::most_fields) {
        const std::size_t comma = body.find(',');
        sentence.fields[sentence.size++] = body.substr(0, comma);
        if (comma == npos) return;
        body.remove_prefix(comma + 1);
    }
}

}  // namespace

Cell Sentence::cell(std::size_t field) const {
    const std::string_view at = field < size ? fields[field] : text.substr(text.size());
    return {at, recording, line.number, 1 + static_cast<std::size_t>(at.data() - line.text.data())};
}

Failure failure_of(const Sentence& sentence) {
    const std::string where =
        place_in(*sentence.recording, sentence.line.number,
                 1 + static_cast<std::size_t>(sentence.text.data() - sentence.line.text.data()));
    const std::string begin = escape_for_message(sentence.text, 12);
    const std::size_t star = sentence.text.find('*');
    if (sentence.damage == Damage::cut_off)
        return Failure(where, fmt::format("the sentence \"{}\" is cut off", begin),
                       "Hand in the recording as the receiver wrote it");
    return Failure(where,
                   fmt::format("the sentence \"{}\" has the checksum {}, its bytes give {:02X}",
                               begin, escape_for_message(sentence.text.substr(star + 1, 2)),
                               exclusive_or(sentence.text.substr(1, star - 1))),
                   "It was damaged in transmission or storage, or edited; take the recording as "
                   "the receiver wrote it");
}

bool SentenceReader::next_on_line() {
    const std::string_view line = line_->text;
    for (std::size_t at = line.find('$', from_); at != npos;) {
        const std::size_t following = line.find('$', at + 1);
        const std::string_view text = line.substr(at, following - at);
        at = following;
        if (!begins_sentence(text)) continue;
        sentence_on_line_ = true;
        const auto type = type_of(text);
        const std::size_t star = text.find('*');
        const Damage damage = damage_of(text, star, following != npos || !line_->ended);
        // Proprietary sentences are not NMEA's, nor need their checksums be.
        const bool damaged = damage != Damage::none && text[1] != 'P';
        if (!type && !damaged) {
            ++passed_over_.other_sentences;
            continue;
        }
        sentence_.type = type.value_or(SentenceType::txt);
        sentence_.damage = damage;
        sentence_.has_checksum = star != npos;
        sentence_.recording = &recording_;
        sentence_.line = *line_;
        sentence_.text = text;
        split_fields(sentence_, text.substr(1, star == npos ? npos : star - 1));
        from_ = following;
        return true;
    }
    from_ = npos;
    return false;
}

const Sentence* SentenceReader::next() {
    for (;;) {
        if (line_) {
            if (from_ != npos && next_on_line()) return &sentence_;
            const std::string_view text = line_->text;
            if (!sentence_on_line_ && text.find('!') == npos && !trim(text).empty())
                ++passed_over_.lines_without_sentence;
        }
        line_ = lines_.next();
        if (!line_) return nullptr;
        from_ = 0;
        sentence_on_line_ = false;
    }
}

}  // namespace runcert::nmea
