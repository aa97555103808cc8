#pragma once

#include <string>
#include <vector>

#include "reports/audit/record.h"
#include "reports/words/figures.h"

// The sections of a walk; `walk_through` puts them together.

namespace runcert {

/// What a stage's section holds, where its product is there.
std::vector<Block> import_blocks(const RunRecord& record, const ReceiverRecord& one, bool all);
std::vector<Block> enu_blocks(const RunRecord& record, const ReceiverRecord& one, bool all);
std::vector<Block> screen_blocks(const RunRecord& record, const ReceiverRecord& one, bool all);
std::vector<Block> smooth_blocks(const RunRecord& record, const ReceiverRecord& one, bool all);
std::vector<Block> window_blocks(const RunRecord& record, const ReceiverRecord& one, bool all);
std::vector<Block> check_blocks(const RunRecord& record, bool all);

/// Where a product comes from and what became of it, as a table of its inputs and the facts of its
/// own file. `contents` says what is in it ("601 epochs").
std::vector<Block> product_blocks(const RunRecord& record, const Header& header,
                                  const std::string& file, const std::string& contents, bool all);

/// The parameters of a stage that are not the default, each with it; with `all` every one.
std::vector<Block> parameter_blocks(const Attempt& attempt, const Header& header, bool all);

/// Appends further blocks.
void append(std::vector<Block>& blocks, std::vector<Block> more);

/// A list with its title.
Block titled_list(std::string title, std::vector<std::string> items);

/// How the speeds of a rule are shown: in its unit, rounded as the measured one is, and where a
/// stage's file has them in m/s, with that beside.
class RuleSpeeds {
  public:
    /// `measured`: whose uncertainty gives the decimals; nothing where no speed was measured.
    RuleSpeeds(const RunRecord& record, const std::string& profile,
               const std::optional<SpeedsToShow>& measured = std::nullopt);

    const SpeedUnit& unit() const { return unit_; }
    /// "216.00 km/h".
    std::string speed(double speed_m_s, SafeSide side = SafeSide::down) const;
    /// "216.00 km/h (60.001 m/s)".
    std::string speed_in_file(double speed_m_s, SafeSide side = SafeSide::down) const;
    /// "60.001 m/s ± 0.047 m/s" of the measured one; empty where the unit is m/s.
    std::string measured_in_file() const;
    /// "0.17 km/h", rounded up to two significant digits.
    std::string uncertainty(double uncertainty_m_s) const;
    /// "0.17 km/h (0.047 m/s)".
    std::string uncertainty_in_file(double uncertainty_m_s) const;
    /// A difference of two speeds, to two significant digits.
    std::string difference(double difference_m_s) const;

  private:
    SpeedUnit unit_;
    std::optional<ShownFigures> shown_ = {}, in_file_ = {};
};

/// The rule's verdict; null where there is none.
const ProfileVerdict* verdict_of(const RunRecord& record, const std::string& profile);

/// "3.000 s from 57.000 s on (epochs 571 to 601; 2026-03-14T04:05:57.000Z)"
std::string span_text(const WindowSpan& span);

}  // namespace runcert
