#pragma once

#include <string>
#include <vector>

#include "reports/audit/record.h"
#include "reports/results/results.h"

// The sections of a walk; `walk_through` puts them together.

namespace runcert {

/// What a stage's section holds, where its product is there.
std::vector<Block> import_blocks(const RunRecord& record, const ReceiverResults& one, Level level);
std::vector<Block> enu_blocks(const RunRecord& record, const ReceiverResults& one, Level level);
std::vector<Block> screen_blocks(const RunRecord& record, const ReceiverResults& one, Level level);
std::vector<Block> smooth_blocks(const RunRecord& record, const ReceiverResults& one, Level level);
std::vector<Block> window_stage_blocks(const RunRecord& record, const ReceiverResults& one,
                                       Level level);
std::vector<Block> check_blocks(const RunRecord& record, Level level);

/// Where a product comes from and what became of it, as a table of its inputs and the facts of its
/// own file. `contents` says what is in it ("601 epochs").
std::vector<Block> product_blocks(const RunRecord& record, const Header& header,
                                  const std::string& file, const std::string& contents,
                                  Level level);

}  // namespace runcert
