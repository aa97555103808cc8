#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "schemas/difference/declared.h"
#include "store/ecsv.h"

namespace runcert {

/// Where the rows of two tables that have the same time are, in the order of both.
struct RowPair {
    std::size_t a = 0;
    std::size_t b = 0;
};
std::vector<RowPair> join_by_time(const std::vector<std::int64_t>& a,
                                  const std::vector<std::int64_t>& b);

/// Where the column of that name is; nothing where there is none, and of `column_of` a Failure.
std::optional<std::size_t> find_column(const EcsvReader& table, std::string_view name);
std::size_t column_of(const EcsvReader& table, std::string_view name);

/// Two tables (ECSV), whose names in messages are given, row by row where they have the same time:
/// on the GPS time scale where both say when their first epoch was, equal times in their order.
class JoinedTables {
  public:
    /// The texts must outlive it. Failure where one is no table, or has no time.
    JoinedTables(std::string_view a, std::string_view b, const std::string& where_a,
                 const std::string& where_b);

    const EcsvReader& a() const { return a_.table; }
    const EcsvReader& b() const { return b_.table; }
    std::int64_t rows_a() const { return std::ssize(a_.times_ns); }
    std::int64_t rows_b() const { return std::ssize(b_.times_ns); }
    std::int64_t joined() const { return std::ssize(pairs_); }

    /// Steps both to the next row that they have in common; false where there is none.
    bool next();
    JoinedRow row() const;
    /// The line of the first row that was passed over, once `next` was false of those behind too.
    const std::optional<std::int64_t>& only_a_line() const { return a_.passed_line; }
    const std::optional<std::int64_t>& only_b_line() const { return b_.passed_line; }

  private:
    struct Side {
        Side(std::string_view text, const std::string& where);

        std::int64_t line() const { return static_cast<std::int64_t>(table.line()); }
        /// Steps to a row, counted from 0, or, without one, to the first of what is left.
        void step_to(std::optional<std::size_t> row);

        EcsvReader table;
        std::optional<std::int64_t> first_epoch_ns = {};
        std::vector<std::int64_t> times_ns = {};  ///< from the first epoch
        std::size_t next = 0;
        std::optional<std::int64_t> passed_line = {};
    };

    Side a_, b_;
    std::vector<RowPair> pairs_;
    std::size_t next_pair_ = 0;
};

}  // namespace runcert
