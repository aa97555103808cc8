#include "stages/import/record_log.h"

#include <fmt/format.h>

#include <utility>

#include "core/text.h"

namespace runcert {
namespace {

/// Each time there are so many more bad records, reading may stop.
constexpr std::int64_t bad_to_give_up = 50'000;

/// The column that a Failure at "file:line:column" names.
OptionalInteger column_of(const Failure& why, const RecordPlace& place) {
    const std::size_t colon = why.where().rfind(':');
    if (!place.line || colon == std::string::npos) return std::nullopt;
    if (!why.where().substr(0, colon).ends_with(fmt::format(":{}", *place.line)))
        return std::nullopt;
    return parse_integer(std::string_view(why.where()).substr(colon + 1));
}

}  // namespace

void RecordLog::require_mostly_good() const {
    if (2 * records_.bad <= records_.total) return;
    if (records_.total == 1) throw Failure(*first_bad_);
    throw Failure(first_bad_->where(),
                  fmt::format("{} ({} of {} records cannot be read; this is the first)",
                              first_bad_->problem(), records_.bad, records_.total),
                  first_bad_->remedy());
}

void RecordLog::count_bad(const RecordPlace& place, const Failure& why, std::int64_t epoch) {
    ++records_.total;
    ++records_.bad;
    if (!first_bad_) first_bad_ = why;
    // What is nothing but bad records is not read to its end.
    if (records_.bad % bad_to_give_up == 0 && 10 * records_.bad > 9 * records_.total)
        require_mostly_good();
    if (records_.bad_records.size() >= bad_records_listed_at_most) return;
    records_.bad_records.push_back({.line = place.line,
                                    .column = column_of(why, place),
                                    .byte = place.byte,
                                    .epoch = epoch,
                                    .what = why.problem() + ". " + why.remedy()});
}

RecordCount RecordLog::finish(std::vector<std::string>& notes) && {
    require_mostly_good();
    if (records_.bad > 0) {
        const BadRecord& first = records_.bad_records.front();
        notes.push_back(fmt::format(
            "{} of {} records cannot be read; the first, {}{}: {}.", records_.bad, records_.total,
            first.line ? fmt::format("line {}", *first.line) : fmt::format("byte {}", first.byte),
            first.column ? fmt::format(", column {}", *first.column) : "", first.what));
    }
    return std::move(records_);
}

}  // namespace runcert
