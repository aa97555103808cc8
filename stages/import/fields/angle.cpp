#include "stages/import/fields/angle.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/failure.h"
#include "core/text.h"

namespace runcert {
namespace {

constexpr std::string_view degree_sign = "\xc2\xb0";
constexpr const char* another_export =
    "Hand in the table as the logger wrote it, or another export";

char small_letter(char c) {
    return static_cast<char>(c | 0x20);
}

/// What stands between degrees, minutes and seconds; "d", "m" and "s" only behind a digit.
std::size_t mark_at(std::string_view text, std::size_t at) {
    if (text.substr(at).starts_with(degree_sign)) return degree_sign.size();
    for (const std::string_view mark :
         {"\xe2\x80\xb2", "\xe2\x80\xb3"})  // the signs of minutes, seconds
        if (text.substr(at).starts_with(mark)) return mark.size();
    return std::string_view(" \t:'\"dms").find(text[at]) != std::string_view::npos ? 1 : 0;
}

/// The numbers of "31 36 00.0" or "31°36.5'": up to three; none where anything else stands there.
std::size_t numbers_of(const Cell& cell, std::array<std::string_view, 3>& parts) {
    std::size_t count = 0;
    for (std::size_t at = 0; at < cell.text.size();) {
        if (const std::size_t mark = mark_at(cell.text, at)) {
            at += mark;
            continue;
        }
        const std::size_t from = at;
        while (at < cell.text.size() && mark_at(cell.text, at) == 0)
            ++at;
        if (count == parts.size()) return 0;
        parts[count++] = cell.text.substr(from, at - from);
    }
    return count;
}

bool is_whole(std::string_view text) {
    return !text.empty() && std::ranges::all_of(text, is_digit);
}

/// Whether several numbers are one angle: all but the last whole, and the last with decimals or a
/// third, or marks between them; "52 5" may be two angles.
bool are_one_angle(const Cell& cell, const std::array<std::string_view, 3>& parts,
                   std::size_t count) {
    if (count < 2) return false;
    std::string_view first = parts[0];
    if (first.starts_with('-') || first.starts_with('+')) first.remove_prefix(1);
    if (!is_whole(first) || (count == 3 && !is_whole(parts[1]))) return false;
    return count == 3 || parts[1].find('.') != std::string_view::npos ||
           cell.text.find_first_of(":'\xc2") != std::string_view::npos;
}

}  // namespace

std::array<Cell, 2> halves_of(const Cell& cell) {
    Cell first = cell, second = cell;
    const std::size_t end = std::min(cell.text.find_first_of(" \t,;/"), cell.text.size());
    const std::size_t begin =
        std::min(cell.text.find_first_not_of(" \t,;/", end), cell.text.size());
    first.text = cell.text.substr(0, end);
    second.text = cell.text.substr(begin);
    second.column += begin;
    return {first, second};
}

int hemisphere_in(std::string_view cell, bool of_latitude) {
    const std::string word = lower_case(cell);
    const auto is = [&](std::string_view whole) {
        return word == whole || (word.size() == 1 && word[0] == whole[0]);
    };
    if (is(of_latitude ? "north" : "east")) return 1;
    return is(of_latitude ? "south" : "west") ? -1 : 0;
}

WrittenAngle::WrittenAngle(const Cell& cell, bool is_latitude, AngleForm form,
                           const Cell* hemisphere)
    : meaning_(is_latitude ? "latitude" : "longitude"),
      cell_(cell),
      hemisphere_(hemisphere),
      form_(form) {
    const std::string_view letters = is_latitude ? "ns" : "ew";
    std::string_view& text = cell_.text;
    if (text.empty()) return;
    // "31d36m05s" ends in its seconds.
    const bool ends_in_seconds = text.back() == 's' && text.find('m') != std::string_view::npos;
    if (letters.find(small_letter(text.back())) != std::string_view::npos && !ends_in_seconds) {
        letter_ = small_letter(text.back());
        text.remove_suffix(1);
    } else if (letters.find(small_letter(text.front())) != std::string_view::npos) {
        letter_ = small_letter(text.front());
        text.remove_prefix(1);
        ++cell_.column;
    }
    if (text.ends_with(degree_sign)) text.remove_suffix(degree_sign.size());
    text = trim(text);
    // Most angles are one number, which nothing but a sign, digits and a point is.
    for (const char c : text)
        if (!is_digit(c) && c != '.' && c != '-') {
            const std::size_t count = numbers_of(cell_, parts_);
            if (are_one_angle(cell_, parts_, count)) count_ = count;
            return;
        }
}

Cell WrittenAngle::part(std::size_t i) const {
    if (count_ == 1) return cell_;
    Cell one = cell_;
    one.text = parts_[i];
    one.column += static_cast<std::size_t>(parts_[i].data() - cell_.text.data());
    return one;
}

CoordinateUnit WrittenAngle::unit() const {
    if (count_ == 3) return CoordinateUnit::arc_second;
    return count_ == 2 || form_ == AngleForm::degrees_and_minutes ? CoordinateUnit::arc_minute
                                                                  : CoordinateUnit::degree;
}

double WrittenAngle::degrees() const {
    if (count_ == 1 && letter_ == '\0' && !hemisphere_ && form_ == AngleForm::degrees)
        if (const auto plain = parse_double(cell_.text)) return *plain;
    const bool has_point = cell_.text.find('.') != std::string_view::npos;  // "1,5" is one
    if (count_ == 1 && has_point && parse_double(halves_of(cell_)[0].text) &&
        parse_double(halves_of(cell_)[1].text))
        cell_.fail(fmt::format("the {} \"{}\" is two numbers, both coordinates in one cell",
                               meaning_, escape_for_message(cell_.text)),
                   "Name this column for latitude and for longitude: it is read in that order");
    double value = read_real(part(0), meaning_);
    const bool negative = part(0).text.starts_with('-');
    const auto refuse_sixty = [&] {
        cell_.fail(fmt::format("the {} \"{}\" has 60 minutes or seconds, or more", meaning_,
                               escape_for_message(cell_.text)),
                   another_export);
    };
    if (count_ == 1 && form_ == AngleForm::degrees_and_minutes) {
        const double whole = std::trunc(value / 100.0), minutes = value - 100.0 * whole;
        if (std::abs(minutes) >= 60.0) refuse_sixty();
        value = whole + minutes / 60.0;
    }
    double part_of_degree = 1.0;
    for (std::size_t i = 1; i < count_; ++i) {
        const double sixtieths = read_real(part(i), meaning_);
        if (sixtieths < 0.0 || sixtieths >= 60.0) refuse_sixty();
        part_of_degree /= 60.0;
        value += (negative ? -sixtieths : sixtieths) * part_of_degree;
    }
    if (letter_ != '\0' && value < 0.0)
        cell_.fail(fmt::format("the {} has a sign, and the letter of a hemisphere", meaning_),
                   another_export);
    if (letter_ == 's' || letter_ == 'w') value = -value;
    if (!hemisphere_) return value;
    const int side = hemisphere_in(hemisphere_->text, meaning_ == "latitude");
    if (side == 0)
        hemisphere_->fail(fmt::format("the hemisphere of the {} is \"{}\"", meaning_,
                                      escape_for_message(hemisphere_->text)),
                          another_export);
    if (value < 0.0 && side > 0)
        cell_.fail(fmt::format("the {} has a minus, and its hemisphere is \"{}\"", meaning_,
                               escape_for_message(hemisphere_->text)),
                   another_export);
    return side * std::abs(value);
}

}  // namespace runcert
