#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <string_view>

namespace runcert {

/// Brings texts of attempts that go side by side into the order of the attempts: what is said of
/// the first one that has not ended passes, what is said of later ones is held back.
class ReportOrder {
  public:
    /// A text of an attempt; returns what may be said now.
    std::string say(std::size_t index, std::string_view text);
    /// Nothing more is said of an attempt; returns what may be said now: what was held back for it.
    std::string end(std::size_t index);
    /// All that is held back, in order; afterwards nothing is.
    std::string rest();

  private:
    struct Held {
        std::string text = {};
        bool ended = false;
    };
    std::map<std::size_t, Held> held_;
    std::size_t next_ = 0;  ///< the first attempt that has not ended
};

}  // namespace runcert
