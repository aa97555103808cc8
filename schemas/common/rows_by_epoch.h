#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

namespace runcert {

/// Finds the row of an epoch. Epochs are numbered as they were recorded, and rows stand in the
/// order of time: another one where a session was recorded late. The rows must outlive this.
template <class Row>
class RowsByEpoch {
  public:
    explicit RowsByEpoch(const std::vector<Row>& rows) {
        rows_.reserve(rows.size());
        for (const Row& row : rows)
            rows_.emplace(row.epoch, &row);
    }

    /// Null if no row has this epoch.
    const Row* find(std::int64_t epoch) const {
        const auto found = rows_.find(epoch);
        return found == rows_.end() ? nullptr : found->second;
    }

  private:
    std::unordered_map<std::int64_t, const Row*> rows_;
};

}  // namespace runcert
