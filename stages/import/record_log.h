#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/failure.h"
#include "schemas/observations/observations.h"
#include "stages/import/recording.h"

namespace runcert {

/// Counts the records of a recording, and lists those that cannot be read.
class RecordLog {
  public:
    void count_good() { ++records_.total; }

    /// Counts a record that could not be read, of the epoch of that number, and lists it among the
    /// first. Failure, the first one's, where by far most of very many could not be read.
    void count_bad(const RecordPlace& place, const Failure& why, std::int64_t epoch);

    const RecordCount& records() const { return records_; }

    /// Failure where more than half of the records could not be read: the first one's, with their
    /// number.
    void require_mostly_good() const;

    /// The records, at the end; with a note where some could not be read. Failure as of
    /// `require_mostly_good`.
    RecordCount finish(std::vector<std::string>& notes) &&;

  private:
    RecordCount records_;
    std::optional<Failure> first_bad_;
};

}  // namespace runcert
