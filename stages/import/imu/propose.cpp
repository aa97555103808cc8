#include "stages/import/imu/propose.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/failure.h"
#include "core/text.h"
#include "stages/import/imu/columns.h"

namespace runcert::imu {
namespace {

/// Gravity in the file's numbers is nearer to 1 below it, nearer to 9.8 above (m/s^2).
constexpr double between_g_and_m_s2 = 3.0;

/// Axes with the one that gravity shows to be down; which is forward it does not show.
ImuAxes axes_of(const Eigen::Vector3d& force) {
    Eigen::Index axis = 0;
    force.cwiseAbs().maxCoeff(&axis);
    const bool is_down = force[axis] < 0.0;  // at rest the force points up
    using enum CraftAxis;
    if (axis == 0) return {.x = is_down ? down : up, .y = forward, .z = is_down ? right : left};
    if (axis == 1) return {.x = forward, .y = is_down ? down : up, .z = is_down ? left : right};
    return {.x = forward, .y = is_down ? right : left, .z = is_down ? down : up};
}

/// Whether a column is named as a latitude: then the readings stand beside positions.
bool has_positions(const csv::SeenTable& table) {
    return table.has_names && std::ranges::any_of(table.head.names, [](const Cell& cell) {
               return letters_of(cell.text).find("lat") != std::string::npos;
           });
}

/// The proposal while it is made.
class Proposing {
  public:
    explicit Proposing(const RecordingBytes& file) : file_(file) {
        Receiver& receiver = proposal_.receiver;
        receiver.id = "proposed";
        receiver.imu.emplace();
        receiver.imu->file = receiver.imu->place = file.name;
    }

    std::optional<Proposal> made() {
        const std::string_view head = file_.bytes.substr(0, recognised_by);
        const bool known = is_rawimu(head) || is_kf_gins(head);
        if (!known && !set_columns()) return std::nullopt;
        try {
            read();
        } catch (const Failure& failure) {
            proposal_.is.problem =
                fmt::format("{}: {}. {}", failure.where(), failure.problem(), failure.remedy());
        }
        return std::move(proposal_);
    }

  private:
    Imu& imu() { return *proposal_.receiver.imu; }
    void say(const std::string& key, std::string value, std::string reason) {
        proposal_.is.proposed.push_back({.key = "imu." + key,
                                         .value = std::move(value),
                                         .unit = {},
                                         .reason = std::move(reason)});
    }
    void add_unsure(std::string sentence) {
        proposal_.is.concerns.push_back(
            {.code = ConcernCode::columns, .says = std::move(sentence)});
    }

    bool set_columns() {
        if (file_.bytes.substr(0, recognised_by).find('\0') != std::string_view::npos) return false;
        const auto table = csv::find_table(file_);
        if (table && has_positions(*table)) return false;
        found_ = table ? find_imu_columns(*table) : std::nullopt;
        if (!found_) return false;
        imu().columns = found_->columns;
        const char* const why = found_->by_names ? "by its name" : "by the numbers in it";
        for (const char* key : {"time", "gyro_x", "gyro_y", "gyro_z", "accelerometer_x",
                                "accelerometer_y", "accelerometer_z"})
            say(fmt::format("columns.{}", key), imu().columns.at(key), why);
        return true;
    }

    void read() {
        if (found_) set_units_of_table();
        RawFile raw = read_raw(proposal_.receiver, file_, false);
        set_rate(raw);
        proposal_.sampling = settle_times(imu(), file_, raw);
        proposal_.raw = std::move(raw);
        const auto quiet = quietest_second(*proposal_.raw, *proposal_.sampling);
        proposal_.quiet = quiet && may_be_at_rest(*quiet)
                              ? *quiet
                              : whole_file(*proposal_.raw, *proposal_.sampling);
        set_axes();
    }

    /// The unit of the time by its name or its steps, then those of the readings by their sizes.
    void set_units_of_table() {
        Imu& it = imu();
        RawFile raw = read_raw(proposal_.receiver, file_, false);
        if (raw.stamps == Stamps::count) {
            const double step = usual_step(raw.samples) * 1e-9;  // in the file's unit
            const std::string by_step = step < 1.0   ? "s"
                                        : step < 1e3 ? "ms"
                                        : step < 1e6 ? "us"
                                                     : "ns";
            it.time_unit = found_->time_unit.empty() ? by_step : found_->time_unit;
            say("time_unit", it.time_unit,
                found_->time_unit.empty() ? "by its steps" : "by the column's name");
        }
        Sampling plain;
        plain.gap_before.resize(raw.samples.size(), false);
        plain.clock.samples = "interval_end";
        plain.clock.interval_s = usual_step(raw.samples) * 1e-9;
        const Stretch whole = whole_file(raw, plain);
        const double size = whole.force_m_s2.norm();
        it.accelerometer_unit = !found_->accelerometer_unit.empty() ? found_->accelerometer_unit
                                : size < between_g_and_m_s2         ? "g"
                                                                    : "m/s2";
        say("accelerometer_unit", it.accelerometer_unit,
            found_->accelerometer_unit.empty() ? "by the size of gravity" : "by the column's name");
        // A craft turns by less than a radian a second for most of the time, and no gyro that is
        // read in degrees stays below one all the time.
        double squares = 0.0;
        for (const RawSample& sample : raw.samples)
            squares += sample.gyro.squaredNorm() / static_cast<double>(raw.samples.size());
        it.gyro_unit = !found_->gyro_unit.empty() ? found_->gyro_unit
                       : squares > 1.0            ? "deg/s"
                                                  : "rad/s";
        say("gyro_unit", it.gyro_unit,
            found_->gyro_unit.empty() ? "by the size of the readings" : "by the column's name");
        if (found_->gyro_unit.empty())
            add_unsure(fmt::format(
                "The unit of the gyros is {} by the size of their readings alone.", it.gyro_unit));
    }

    /// A nominal rate where the stamps need one.
    void set_rate(const RawFile& raw) {
        if (raw.stamps == Stamps::none || raw.samples.size() < 2) return;
        RawFile copy = raw;
        const double share = measured_share(raw.samples);
        const bool held = share < held_share;
        constexpr double even = 0.02;
        try {
            const Sampling stamped = settle_times(imu(), file_, copy);
            if (!held && stamped.clock.jitter_s < even * stamped.clock.interval_s) return;
        } catch (const Failure&) {
            // Stamps so uneven need a rate.
        }
        const std::string rate =
            fmt::format("{:.4g}", 1e9 / usual_step(raw.samples) * (held ? share : 1.0));
        imu().rate_hz = parse_double(rate);
        say("rate_hz", rate,
            held ? "the sensor is read more often than it measures" : "the stamps jitter");
    }

    void set_axes() {
        const Eigen::Vector3d& force = proposal_.quiet->force_m_s2;
        const ImuAxes axes = axes_of(force);
        imu().axes = axes;
        if (proposal_.raw->format == "kf-gins") return;
        const char* const why = "gravity shows which is down";
        say("axes.x", std::string(to_text(axes.x)), why);
        say("axes.y", std::string(to_text(axes.y)), why);
        say("axes.z", std::string(to_text(axes.z)), why);
        add_unsure(
            "Which axis is forward gravity does not show: correct axes: by how the IMU is "
            "mounted.");
    }

    const RecordingBytes& file_;
    std::optional<FoundColumns> found_;
    Proposal proposal_;
};

}  // namespace

std::optional<Proposal> propose(const RecordingBytes& file) {
    return Proposing(file).made();
}

}  // namespace runcert::imu
