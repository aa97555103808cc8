#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "schemas/attempt/attempt.h"
#include "schemas/attitude/declared.h"
#include "schemas/common/header.h"
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

// A run folder as certificate and audit read it.

namespace runcert {

/// Whether a product is in the folder: of one that is not nothing is said, not even who made it.
inline bool is_there(const Header& header) {
    return !header.stage.empty();
}

/// A slip of a carrier phase, and where its phase was recorded.
struct SlipRecord {
    ScreenedPhase row;
    std::size_t table_row = 0;  ///< counted from 0, the same in both tables of phases
    std::optional<std::int64_t> line = {}, byte = {};
};

/// What the stages made of one receiver.
struct ReceiverResults {
    Receiver receiver = {};
    std::map<std::string_view, std::string> files = {};  ///< of its products, by their name
    Observations observations = {};
    EnuTable enu = {};
    ScreenedTable screened = {};
    TrajectoryTable trajectory = {};
    std::optional<AttitudeTable> attitude = {};  ///< by its IMU
    Windows windows = {};
    // Without their rows.
    std::optional<PhaseTable> phase = {};
    std::optional<ScreenedPhaseTable> screened_phase = {};
    std::vector<SlipRecord> slips = {};
    std::optional<ImuTable> imu = {};
    std::optional<SurfaceTable> surface = {};
};

/// What a run is of, what the stages made, and every file that was read, in the chain's order.
struct RunView {
    Attempt attempt = {};
    std::vector<Profile> profiles = {};
    std::vector<ReceiverResults> receivers = {};  ///< in the order of the attempt's
    Verdict verdict = {};
    std::string verdict_text = {};  ///< of its file, whose figures are rounded each by itself
    std::vector<InputFile> files = {};
    /// Of a file, which files name its hash; of what an audit reads.
    std::map<std::string, std::vector<std::string>> named_by = {};
};

/// The file of that name, hashed; null where it is not there.
const InputFile* file_in(const RunView& run, const std::string& name);

}  // namespace runcert
