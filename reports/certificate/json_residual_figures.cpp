#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "reports/certificate/curve.h"
#include "reports/certificate/json_figures.h"

namespace runcert {

using Json = nlohmann::ordered_json;

namespace {

constexpr std::size_t bins_of_a_figure = 250;
constexpr std::size_t rejections_shown = 400;
constexpr double largest_ratio_shown = 5.0;

/// Gathers values over some epochs, and adds their middle with the band that they take.
class Binned {
  public:
    Binned(const CurveStyle& style, std::size_t epochs_of_a_bin)
        : curve_(style), size_(epochs_of_a_bin) {}

    void add(double time, double value, std::optional<std::int64_t> arc) {
        if (count_ > 0 && arc != arc_) flush();
        if (arc != arc_) curve_.interrupt();
        arc_ = arc;
        if (count_ == 0) begin_ = time;
        end_ = time;
        range_.widen(value);
        if (++count_ == size_) flush();
    }
    const Curve& finished() {
        if (count_ > 0) flush();
        return curve_;
    }

  private:
    void flush() {
        curve_.add(0.5 * (begin_ + end_), 0.5 * (*range_.least + *range_.most), *range_.least,
                   *range_.most);
        range_ = {};
        count_ = 0;
    }

    Curve curve_;
    std::size_t size_;
    std::size_t count_ = 0;
    double begin_ = 0.0, end_ = 0.0;
    Range range_;
    std::optional<std::int64_t> arc_;
};

struct Residual {
    double time = 0.0;
    std::optional<std::int64_t> arc;
    double east_m = 0.0, north_m = 0.0;
    double bound_m = 0.0;  ///< twice the standard deviation of a coordinate, as used
};

std::vector<Residual> residuals_of(const ReceiverResults& results) {
    const double factor = std::sqrt(results.trajectory.estimation.variance_factor_applied);
    std::vector<Residual> residuals;
    const auto& rows = results.trajectory.rows;
    const auto& screened = results.screened.rows;
    for (std::size_t i = 0; i < std::min(rows.size(), screened.size()); ++i) {
        const ScreenedEpoch& measured = screened[i];
        const TrajectoryEpoch& row = rows[i];
        if (!measured.usable || !row.arc || !row.east_m || !measured.east_m) continue;
        const double stated = std::sqrt(0.5 * (std::pow(measured.sigma_east_m.value_or(0.0), 2) +
                                               std::pow(measured.sigma_north_m.value_or(0.0), 2)));
        residuals.push_back({.time = row.time.seconds(),
                             .arc = row.arc,
                             .east_m = *measured.east_m - *row.east_m,
                             .north_m = *measured.north_m - *row.north_m,
                             .bound_m = 2.0 * factor * stated});
    }
    return residuals;
}

/// The two lines of the bounds.
void add_bounds(Json& figure, const std::vector<Residual>& residuals) {
    const std::size_t every = 1 + residuals.size() / bins_of_a_figure;
    for (const double sign : {1.0, -1.0}) {
        Curve bound({sign > 0 ? "+ 2 standard deviations" : "- 2 standard deviations", "dashed",
                     "black", 3, 5});
        for (std::size_t i = 0; i < residuals.size(); i += every) {
            if (i > 0 && residuals[i].arc != residuals[i - every].arc) bound.interrupt();
            bound.add(residuals[i].time, sign * residuals[i].bound_m);
        }
        figure["curves"].push_back(bound.json());
    }
}

}  // namespace

Json residual_figure(const ReceiverResults& results) {
    const std::vector<Residual> residuals = residuals_of(results);
    if (residuals.empty()) return nullptr;
    const std::size_t bin = 1 + residuals.size() / bins_of_a_figure;
    Json figure = empty_figure(
        "residuals", "Residuals: measured less smoothed positions",
        std::string("Of the epochs used. Dashed: twice the standard deviation of a coordinate, as "
                    "the estimate uses it.") +
            (bin > 1 ? fmt::format(" Each band spans the residuals of {} epochs.", bin) : ""),
        time_label, "residual (m)");
    Binned east({"east", "line", "blue", 3, 5}, bin);
    Binned north({"north", "line", "orange", 3, 5}, bin);
    Range times, values;
    for (const Residual& residual : residuals) {
        east.add(residual.time, residual.east_m, residual.arc);
        north.add(residual.time, residual.north_m, residual.arc);
        times.widen(residual.time);
        for (const double value : {residual.east_m, residual.north_m, residual.bound_m})
            values.widen(std::abs(value));
    }
    figure["curves"].push_back(east.finished().json());
    figure["curves"].push_back(north.finished().json());
    add_bounds(figure, residuals);
    set_axes(figure, *times.least, *times.most, -*values.most, *values.most);
    return figure;
}

Json test_figure(const ScreenedTable& table) {
    std::vector<const ScreenedEpoch*> tested;
    for (const ScreenedEpoch& row : table.rows)
        if (row.statistic && row.threshold && *row.threshold > 0.0) tested.push_back(&row);
    if (tested.size() < 2) return nullptr;
    const std::size_t bin = 1 + tested.size() / bins_of_a_figure;
    Json figure = empty_figure(
        "innovations", "Tests of screening",
        fmt::format("Statistic of the best supported error over its threshold, from the "
                    "innovations: above 1 the error is decided for, and the epoch left out or the "
                    "stretch ended. A ratio above {0:g} is drawn at {0:g}.{1}",
                    largest_ratio_shown,
                    bin > 1 ? fmt::format(" Each band spans {} epochs.", bin) : ""),
        time_label, "statistic over threshold");
    Binned kept({"epochs kept", "line", "blue", 3, 4}, bin);
    Curve decided({"decided for an error", "points", "vermilion", 3, 4});
    Range times, ratios;
    ratios.widen(1.2);
    for (const ScreenedEpoch* row : tested) {
        const double time = row->time.seconds();
        const double ratio = std::min(*row->statistic / *row->threshold, largest_ratio_shown);
        times.widen(time);
        ratios.widen(ratio);
        if (ratio <= 1.0)
            kept.add(time, ratio, row->arc);
        else if (decided.size() < rejections_shown)
            decided.add(time, ratio);
    }
    if (const Curve& curve = kept.finished(); !curve.empty())
        figure["curves"].push_back(curve.json());
    if (!decided.empty()) figure["curves"].push_back(decided.json());
    figure["levels"].push_back({{"level_name", "threshold"}, {"level", 1.0}});
    set_axes(figure, *times.least, *times.most, 0.0, *ratios.most);
    return figure;
}

}  // namespace runcert
