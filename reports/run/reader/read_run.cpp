#include "reports/run/reader/read_run.h"

#include <filesystem>

#include "run/attempt_files.h"

namespace runcert {
namespace {

/// Reads the files of a run.
class RunReader {
  public:
    RunReader(StageRun& run, Reading reading) : run_(run), whole_(reading == Reading::whole) {}

    RunView read() &&;

  private:
    /// Whether the folder itself holds the file; a name that leads elsewhere does not count.
    bool exists(const std::string& file) const {
        return file.find('/') == std::string::npos && file.find('\0') == std::string::npos &&
               std::filesystem::exists(run_.run_dir() / file);
    }
    void note(const std::string& role, const std::string& file, const std::string& original = {}) {
        if (whole_ || exists(file)) run_.note_file(role, file, original);
    }
    void note(const AttemptFile& file) {
        note(file.role, file.name, std::filesystem::path(file.original).filename().string());
    }
    /// A product, empty where it is not there. An audit notes the files that it names, too.
    template <class Reader>
    auto read(const ProductFile& product, const Receiver& receiver, Reader reader) {
        using Read = decltype(reader(std::string_view(), std::string()));
        const std::string file = run_.file_of(product, receiver);
        if (!whole_ && !exists(file)) return Read{};
        Read found = run_.read(product, receiver, reader);
        if (whole_) return found;
        for (const InputFile& input : found.header.inputs) {
            named_by_[input.file].push_back(file);
            note(input.role, input.file);
        }
        return found;
    }
    /// Of a table that is gone through row by row its head; `look` sees every row.
    template <class Open, class Look>
    auto head_of(const ProductFile& product, const Receiver& receiver, Open open, Look look) {
        auto head = read(product, receiver, [&](std::string_view text, const std::string& where) {
            auto table = open(text, where);
            for (typename decltype(table)::Row row; !whole_ && table.rows.next(row);)
                look(row);
            return std::move(table.head);
        });
        return is_there(head.header) ? std::optional(std::move(head)) : std::nullopt;
    }
    /// Both tables of phases: their heads and, for an audit, the slips and their lines.
    void read_phases(const Receiver& receiver, ReceiverResults& one) {
        std::size_t number = 0;
        one.screened_phase = head_of(products::screened_phase, receiver, open_screened_phase,
                                     [&](const ScreenedPhase& row) {
                                         if (row.statistic)
                                             one.slips.push_back({.row = row, .table_row = number});
                                         ++number;
                                     });
        number = 0;
        auto slip = one.slips.begin();
        one.phase = head_of(products::phase, receiver, open_phase, [&](const PhaseRow& row) {
            if (slip == one.slips.end() || slip->table_row != number++) return;
            if (row.source_line) slip->line = *row.source_line;
            if (row.source_byte) slip->byte = *row.source_byte;
            ++slip;
        });
    }
    ReceiverResults read_receiver(const Receiver& receiver);

    StageRun& run_;
    bool whole_;
    std::map<std::string, std::vector<std::string>> named_by_;
};

ReceiverResults RunReader::read_receiver(const Receiver& receiver) {
    ReceiverResults one{.receiver = receiver};
    for (const ProductFile& product : products::all)
        one.files[product.name] = run_.file_of(product, receiver);
    for (const AttemptFile& file : files_of_receiver(receiver))
        note(file);
    for (const AttemptFile& file : solution_files(receiver))
        note(file.role, file.name);
    const auto pass_over = [](const auto&) {};
    one.observations = read(products::observations, receiver, read_observations);
    if (has_imu(receiver)) {
        if (whole_)
            note("imu", one.files.at("imu"));
        else
            one.imu = head_of(products::imu, receiver, open_imu, pass_over);
    }
    one.enu = read(products::enu, receiver, read_enu);
    one.screened = read(products::screened, receiver, read_screened);
    if (has_surface(receiver)) {
        if (whole_)
            note("surface", one.files.at("surface"));
        else
            one.surface = head_of(products::surface, receiver, open_surface, pass_over);
    }
    if (has_phases(receiver)) read_phases(receiver, one);
    one.trajectory = read(products::trajectory, receiver, read_trajectory);
    if (has_imu(receiver)) {
        AttitudeTable attitude = read(products::attitude, receiver, read_attitude);
        if (is_there(attitude.header)) one.attitude = std::move(attitude);
    }
    one.windows = read(products::windows, receiver, read_windows);
    return one;
}

RunView RunReader::read() && {
    RunView view{.attempt = run_.attempt()};
    run_.note_attempt();
    if (whole_) view.profiles = read_claimed_rules(run_.run_dir(), view.attempt);
    for (const std::string& claimed : view.attempt.profiles) {
        const std::string file = profile_copy_name(claimed);
        if (!whole_ && exists(file))
            view.profiles.push_back(read_claimed_profile(run_.run_dir(), claimed, view.attempt));
        note("profile", file);
    }
    for (const AttemptFile& file : series_files(view.attempt))
        note(file);
    for (const Receiver& receiver : run_.attempt().receivers)
        view.receivers.push_back(read_receiver(receiver));
    view.verdict = read(products::verdict, view.attempt.receivers.front(),
                        [&](std::string_view text, const std::string& where) {
                            view.verdict_text = text;
                            return read_verdict(text, where);
                        });
    view.files = run_.inputs();
    view.named_by = std::move(named_by_);
    return view;
}

}  // namespace

RunView read_run_view(StageRun& run, Reading reading) {
    return RunReader(run, reading).read();
}

}  // namespace runcert
