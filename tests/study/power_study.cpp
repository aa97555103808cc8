#include "power_study.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>

#include "core/parallel.h"
#include "core/random.h"
#include "stages/screen/adaptation.h"
#include "witness/arcs.h"

namespace runcert {
namespace {

struct Kind {
    Hypothesis kind;
    std::size_t epochs;
};
constexpr std::array kinds{Kind{Hypothesis::outlier, 1},   Kind{Hypothesis::burst, 2},
                           Kind{Hypothesis::burst, 5},     Kind{Hypothesis::burst, 20},
                           Kind{Hypothesis::step, 1},      Kind{Hypothesis::ramp, 1},
                           Kind{Hypothesis::time_shift, 1}};
constexpr std::size_t places = 4;

/// A recording, screened as it is, and the tests of what is measured with errors in it.
class StudiedRecording {
  public:
    StudiedRecording(const StudyRun& run, std::uint64_t seed)
        : recording_(simulate_recording(run, seed)),
          rate_hz_(run.rate_hz),
          config_(study_screen_config()),
          screened_(screen(to_be_screened(recording_.screened), config_)),
          model_(model_of(screened_.basis.models.front())),
          plan_(config_.family_false_alarm_rate, screened_.basis.tests, config_.power,
                config_.burst_epochs_max),
          arcs_(arcs_of<2>(recording_.screened)),
          diagnosis_(arcs_.front().epochs, model_) {}

    std::size_t epoch_at(double time_s) const {
        return static_cast<std::size_t>(std::lround(time_s * rate_hz_));
    }

    /// An error at an epoch in a direction, of the size that screening states; nothing where it
    /// states none.
    std::optional<SupposedError> smallest(const Kind& kind, std::size_t k,
                                          double direction_rad) const {
        SupposedError error{.kind = kind.kind, .first = k, .epochs = kind.epochs};
        const auto size = detectable(kind, k);
        if (!size) return std::nullopt;
        if (kind.kind == Hypothesis::time_shift)
            error.late_s = std::copysign(*size, std::numbers::pi - direction_rad);
        else
            error.size = *size * Eigen::Vector2d(std::cos(direction_rad), std::sin(direction_rad));
        return error;
    }

    /// Whether the error's own test rejects the model.
    bool own_test(const SupposedError& error) const {
        const std::vector<Arc<2>> arcs = arcs_of<2>(with_errors(recording_, {&error, 1}));
        const Chain<2> diagnosis(arcs.front().epochs, model_);
        const double factor = local_variance_factors(diagnosis)[error.first];
        const int unknowns = error.kind == Hypothesis::time_shift ? 1 : 2;
        return statistic(diagnosis, error) / factor > plan_.critical(unknowns);
    }

    ScreenedTable screen_with(const std::vector<SupposedError>& errors) const {
        return screen(to_be_screened(with_errors(recording_, errors)), config_);
    }

  private:
    std::optional<double> detectable(const Kind& kind, std::size_t k) const {
        const ScreenedEpoch& row = screened_.rows[k];
        switch (kind.kind) {
            case Hypothesis::outlier:
                return row.detectable.outlier_m;
            case Hypothesis::step:
                return row.detectable.step_m;
            case Hypothesis::ramp:
                return row.detectable.ramp_m_s;
            case Hypothesis::time_shift:
                return row.detectable.time_s;
            default: {  // noise is the same on both axes: so is the variance
                const double variance = diagnosis_.burst(k, kind.epochs).covariance()(0, 0);
                return std::sqrt(row.local_variance_factor.value() * plan_.noncentrality(2) *
                                 variance);
            }
        }
    }

    static double statistic(const Chain<2>& diagnosis, const SupposedError& error) {
        switch (error.kind) {
            case Hypothesis::outlier:
                return diagnosis.outlier(error.first).statistic();
            case Hypothesis::step:
                return diagnosis.step(error.first).statistic();
            case Hypothesis::ramp:
                return diagnosis.ramp(error.first).statistic();
            case Hypothesis::time_shift: {
                const auto test = diagnosis.time_shift(error.first);
                return test ? test->statistic() : 0.0;
            }
            default:
                return diagnosis.burst(error.first, error.epochs).statistic();
        }
    }

    SimulatedRecording recording_;
    double rate_hz_;
    ScreenConfig config_;
    ScreenedTable screened_;
    EstimationModel model_;
    TestPlan plan_;
    std::vector<Arc<2>> arcs_;
    Chain<2> diagnosis_;
};

using PowerLines = std::array<PowerLine, kinds.size()>;

void study_screening(const StudiedRecording& recording, std::vector<SupposedError> errors,
                     std::size_t only, double rate_hz, PowerLine& line) {
    const SupposedError alone = errors[only % errors.size()];
    line.found_alone.add(judge(recording.screen_with({alone}), alone, rate_hz).found);
    if (line.kind == Hypothesis::ramp) errors = {alone};
    const ScreenedTable once = recording.screen_with(errors);
    for (const SupposedError& error : errors)
        line.found.add(judge(once, error, rate_hz).found);
    for (SupposedError& error : errors) {
        error.size *= 2.0;
        error.late_s *= 2.0;
    }
    const ScreenedTable twice = recording.screen_with(errors);
    for (const SupposedError& error : errors) {
        const Judgement judgement = judge(twice, error, rate_hz);
        line.found_twice.add(judgement.found);
        line.dated_twice.add(judgement.dated);
        line.named_twice.add(judgement.named);
    }
    line.left_out += wrongly_left_out(twice, errors);
}

PowerLines study_recording(const StudyRun& cell, std::uint64_t seed, std::size_t number,
                           bool screened) {
    const StudiedRecording recording(cell, seed);
    RandomGenerator random(seed ^ 0x5eed);
    PowerLines lines;
    for (std::size_t i = 0; i < kinds.size(); ++i) {
        lines[i].kind = kinds[i].kind;
        lines[i].epochs = kinds[i].epochs;
        std::vector<SupposedError> errors;
        for (std::size_t place = 0; place < places; ++place) {
            const double time_s = 11.0 + 12.0 * static_cast<double>(place) + 2.0 * random.uniform();
            const double direction_rad = 2.0 * std::numbers::pi * random.uniform();
            const auto error =
                recording.smallest(kinds[i], recording.epoch_at(time_s), direction_rad);
            if (error) errors.push_back(*error);
        }
        for (const SupposedError& error : errors)
            lines[i].own_test.add(recording.own_test(error));
        if (screened && !errors.empty())
            study_screening(recording, errors, number, cell.rate_hz, lines[i]);
    }
    return lines;
}

}  // namespace

PowerLine& PowerLine::operator+=(const PowerLine& other) {
    kind = other.kind;
    epochs = other.epochs;
    own_test += other.own_test;
    found_alone += other.found_alone;
    found += other.found;
    found_twice += other.found_twice;
    dated_twice += other.dated_twice;
    named_twice += other.named_twice;
    left_out += other.left_out;
    return *this;
}

std::vector<StudyRun> screening_cells() {
    std::vector<StudyRun> cells;
    for (const double rate_hz : {10.0, 20.0})
        for (const StudyNoise& noise :
             {StudyNoise{.white_m = 0.010},
              StudyNoise{.white_m = 0.003, .error_sigma_m = 0.008, .error_tau_s = 2.0}})
            cells.push_back(
                {.rate_hz = rate_hz, .jerk_density = 1.0, .return_time_s = 10.0, .noise = noise});
    return cells;
}

std::string cell_name(const StudyRun& run) {
    const StudyNoise& noise = run.noise;
    std::string name = fmt::format("{:g} Hz, {:g} mm", run.rate_hz, noise.white_m * 1e3);
    if (noise.error_sigma_m > 0.0)
        name += fmt::format(" + {:g} mm of {:g} s", noise.error_sigma_m * 1e3, noise.error_tau_s);
    return name;
}

std::vector<PowerLine> study_power(const StudyRun& cell, const ScreeningStudyOptions& options) {
    std::vector<PowerLine> sum(kinds.size());
    const auto recordings = results_of(options.recordings, options.threads, [&](std::int64_t i) {
        return study_recording(cell, options.seed * 1'000'003 + static_cast<std::uint64_t>(i),
                               static_cast<std::size_t>(i), i < options.screened);
    });
    for (const PowerLines& lines : recordings)
        for (std::size_t i = 0; i < kinds.size(); ++i)
            sum[i] += lines[i];
    return sum;
}

Share study_clean(StudyRun cell, const ScreeningStudyOptions& options) {
    cell.shuttle = true;
    cell.length_s = static_cast<double>(options.clean_epochs - 1) / cell.rate_hz;
    const ScreenConfig config = study_screen_config();
    const auto clean = results_of(options.clean_runs, options.threads, [&](std::int64_t i) {
        const SimulatedRecording recording =
            simulate_recording(cell, options.seed * 2'000'003 + static_cast<std::uint64_t>(i));
        const ScreenedTable screened = screen(to_be_screened(recording.screened), config);
        const ScreeningSummary summary = summarise(screened.rows);
        return summary.arcs == 1 && summary.usable == std::ssize(screened.rows) &&
               summary.decisions.empty();
    });
    Share share;
    for (const bool one : clean)
        share.add(one);
    return share;
}

std::string power_table(const StudyRun& cell, const std::vector<PowerLine>& lines) {
    std::string text = fmt::format(
        "{}: errors of the smallest detectable size, and of twice that\n"
        "              tries  own test  alone   found  |  twice: found    dated    named  good "
        "epochs "
        "left out\n",
        cell_name(cell));
    for (const PowerLine& line : lines) {
        std::string name(to_text(line.kind));
        if (line.kind == Hypothesis::burst) name += fmt::format(" of {}", line.epochs);
        const bool dated = line.kind == Hypothesis::step || line.kind == Hypothesis::time_shift;
        text += fmt::format(
            "{:<12} {:6}    {:6.3f}  {:5.3f}  {:6.3f}  |      {:8.5f} {:>8} {:8.4f}  {:6}\n", name,
            line.own_test.of, line.own_test.fraction(), line.found_alone.fraction(),
            line.found.fraction(), line.found_twice.fraction(),
            dated ? fmt::format("{:.4f}", line.dated_twice.fraction()) : "-",
            line.named_twice.fraction(), line.left_out);
    }
    return text;
}

}  // namespace runcert
