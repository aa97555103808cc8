#include "run/handed_in_series.h"

#include <algorithm>

#include "run/attempt_files.h"

namespace runcert {

std::optional<MeasuredSeries> handed_in_series(StageRun& run, std::string_view key,
                                               const std::optional<GpsTime>& first_epoch) {
    const std::vector<AttemptFile> files = series_files(run.attempt());
    const auto file = std::ranges::find(files, key, &AttemptFile::role);
    if (file == files.end()) return std::nullopt;
    return read_series(run.read_text(file->role, file->name), file->original, first_epoch,
                       kind_of_series(file->role));
}

}  // namespace runcert
