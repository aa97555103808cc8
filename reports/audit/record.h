#pragma once

#include <optional>
#include <string>
#include <vector>

#include "reports/run/run_view.h"
#include "schemas/document/document.h"

namespace runcert {

/// A run folder as an audit finds it; of the profiles those whose text is there.
struct RunRecord : RunView {
    /// Of report.json: its subjects as inputs; empty where there is none.
    std::optional<Header> report = {};
    std::string report_id = {};
    std::vector<std::string> signatures = {};  ///< files beside report.json
};

/// Whether there is no file of any stage, and no report.
bool holds_nothing(const RunRecord& record);

/// The stages, in the order of the chain, by the names of the programs.
const std::vector<std::string>& audited_stages();

struct WalkOptions {
    std::vector<std::string> stages = {};  ///< empty: all, and what the run is
    std::string receiver = {};             ///< id of the one shown; empty: all
    bool all = false;                      ///< hashes in full, and lists that are else cut
};

/// What a run is, and what came in, went out and was decided, and why, by stage and receiver.
Document walk_through(const RunRecord& record, const WalkOptions& options);

}  // namespace runcert
