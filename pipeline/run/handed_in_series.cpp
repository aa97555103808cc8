#include "run/handed_in_series.h"

#include <algorithm>

#include "run/attempt_files.h"

namespace runcert {

std::optional<MeasuredSeries> handed_in_series(StageRun& run, std::string_view key,
                                               const std::optional<GpsTime>& first_epoch) {
    const std::vector<AttemptFile> files = series_files(run.attempt());
    const auto file = std::ranges::find(files, key, &AttemptFile::role);
    if (file == files.end()) return std::nullopt;
    return read_series_of(*file, run.read_text(file->role, file->name), first_epoch);
}

std::map<std::string, MeasuredSeries> all_handed_in_series(
    StageRun& run, const std::optional<GpsTime>& first_epoch) {
    std::map<std::string, MeasuredSeries> all;
    for (const AttemptFile& file : series_files(run.attempt()))
        all.emplace(file.role,
                    read_series_of(file, run.read_text(file.role, file.name), first_epoch));
    return all;
}

}  // namespace runcert
