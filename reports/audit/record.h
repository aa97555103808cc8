#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "schemas/attempt/attempt.h"
#include "schemas/attitude/declared.h"
#include "schemas/common/header.h"
#include "schemas/document/document.h"
#include "schemas/enu/declared.h"
#include "schemas/imu/declared.h"
#include "schemas/observations/observations.h"
#include "schemas/phase/declared.h"
#include "schemas/profile/profile.h"
#include "schemas/screened/screened.h"
#include "schemas/screened_phase/declared.h"
#include "schemas/surface/declared.h"
#include "schemas/trajectory/declared.h"
#include "schemas/verdict/declared.h"
#include "schemas/windows/windows.h"

namespace runcert {

/// A slip of a carrier phase, and where its phase was recorded.
struct SlipRecord {
    ScreenedPhase row;
    std::size_t table_row = 0;  ///< counted from 0, the same in both tables of phases
    std::optional<std::int64_t> line = {}, byte = {};
};

/// What the stages made of one receiver. A product that is not in the folder is empty.
struct ReceiverRecord {
    Receiver receiver;
    std::string recording;  ///< names of the files that were handed in
    std::string observations_file, enu_file, screened_file, trajectory_file, windows_file;
    std::string phase_file, screened_phase_file, imu_file, surface_file, attitude_file;
    std::optional<Observations> observations = {};
    std::optional<EnuTable> enu = {};
    std::optional<ScreenedTable> screened = {};
    std::optional<TrajectoryTable> trajectory = {};
    std::optional<Windows> windows = {};
    std::optional<PhaseTable> phase = {};                   ///< without its rows
    std::optional<ScreenedPhaseTable> screened_phase = {};  ///< without its rows
    std::vector<SlipRecord> slips = {};
    std::optional<ImuTable> imu = {};          ///< without its rows
    std::optional<SurfaceTable> surface = {};  ///< without its rows
    std::optional<AttitudeTable> attitude = {};
};

/// A run folder as an audit finds it; all hashes that its files name of one another hold.
struct RunRecord {
    Attempt attempt;
    std::vector<Profile> profiles = {};  ///< those whose text is there
    std::vector<ReceiverRecord> receivers = {};
    std::string verdict_file;
    std::optional<Verdict> verdict = {};
    /// Of report.json: its subjects as inputs; empty where there is none.
    std::optional<Header> report = {};
    std::string report_id = {};
    std::vector<std::string> signatures = {};     ///< files beside report.json
    std::map<std::string, InputFile> files = {};  ///< those that are there, hashed
    std::map<std::string, std::vector<std::string>> named_by =
        {};  ///< of a file: who names its hash
};

/// The stages, in the order of the chain, by the names of the programs.
const std::vector<std::string>& audited_stages();

struct WalkOptions {
    std::set<std::string> stages = {};  ///< empty: all, and what the run is
    std::string receiver = {};          ///< id of the one shown; empty: all
    bool all = false;                   ///< hashes in full, and lists that are else cut
};

/// What a run is, and what came in, went out and was decided, and why, by stage and receiver.
Document walk_through(const RunRecord& record, const WalkOptions& options);

}  // namespace runcert
