#include <fmt/format.h>

#include <fstream>
#include <sstream>

#include "alignment_study.h"
#include "core/failure.h"
#include "core/text.h"

namespace runcert {
namespace {

using Cells = std::vector<std::string>;

/// The rows of one of [FHB03]'s tables, without the line of its names.
std::vector<Cells> published_table(int number) {
    const std::string name = fmt::format("tests/published/data/fhb03/table_{}.csv", number);
    std::ifstream file(RUNCERT_SOURCE_DIR "/" + name);
    if (!file) throw Failure(name, "the file cannot be read", "Run from a checkout");
    std::vector<Cells> rows;
    std::string line;
    std::getline(file, line);
    while (std::getline(file, line)) {
        std::istringstream cells(line);
        rows.emplace_back();
        for (std::string cell; std::getline(cells, cell, ',');)
            rows.back().emplace_back(trim(cell));
    }
    return rows;
}

/// Mean, largest and failures: "5.8 / 12.0, 0".
std::string times(const AlignmentSummary& summary) {
    const std::string failed = fmt::format("{}", summary.failed);
    if (summary.failed == summary.runs) return fmt::format("- / -, {}", failed);
    return fmt::format("{:.1f} / {:.1f}, {}", summary.true_s, summary.true_most_s, failed);
}

std::string method_line(const std::string& name, const std::vector<Alignment>& runs) {
    const AlignmentSummary s = summarise(runs);
    const std::string stated =
        s.stated_s > 0.0 ? fmt::format("{:5.1f} +- {:4.1f}", s.stated_s, s.stated_sd_s) : "-";
    return fmt::format(
        "  {:28} {:6.1f} {:>14} {:7.2f} / {:5.1f} {:6.1f} +- {:4.1f} {:6.1f} {:4} of {}, "
        "{} unseen\n",
        name, s.initial_error_deg, stated, s.error_median_deg, s.error_most_deg, s.true_s,
        s.true_sd_s, s.true_most_s, s.failed, s.runs, s.failed_unseen);
}

/// Of starts whose error is within bounds, over all of them: mean of the means, largest, failed.
AlignmentSummary between(const AlignmentStudy& study, double least_deg, double most_deg) {
    std::vector<Alignment> runs;
    for (std::size_t i = 0; i < study.by_error.size(); ++i)
        if (alignment_errors_deg[i] >= least_deg && alignment_errors_deg[i] <= most_deg)
            runs.insert(runs.end(), study.by_error[i].begin(), study.by_error[i].end());
    return summarise(runs);
}

/// By how much the track model is sooner than the GPS heading, which the paper's summary prints.
std::string sooner_line(const std::vector<AlignmentStudy>& studies) {
    const auto sooner = [](double track_s, double heading_s) {
        return 100.0 * (1.0 - track_s / heading_s);
    };
    const std::vector<Cells> rows = published_table(3);
    const auto mean_s = [&](const std::string& track, const std::string& method) {
        for (const Cells& row : rows)
            if (row.at(0) == track && row.at(1) == method) return parse_double(row.at(3)).value();
        throw Failure("table_3.csv", "a method is missing", "Restore it");
    };
    std::string text = "  The track model is sooner than the GPS heading by";
    for (const auto& [track, printed] : {std::pair("Fontana", 48), std::pair("Sears Point", 80)})
        text += fmt::format(" {:.0f} % at {} (printed: {}),",
                            sooner(mean_s(track, "track model"), mean_s(track, "GPS heading")),
                            track, printed);
    text.back() = ';';
    text += " ours in true time by";
    for (const AlignmentStudy& study : studies)
        text += fmt::format(" {:.0f} %,",
                            sooner(summarise(study.of(AlignmentStart::track_model)).true_s,
                                   summarise(study.of(AlignmentStart::gps_heading)).true_s));
    text.back() = '\n';
    return text;
}

template <class Text>
std::string for_each_study(const std::vector<AlignmentStudy>& studies, const Text& text) {
    std::string all;
    for (const AlignmentStudy& study : studies)
        all += fmt::format("    {:40} {}\n", study.cell, text(study));
    return all;
}

}  // namespace

std::string alignment_table_1(const std::vector<AlignmentStudy>& studies) {
    std::string text =
        "[FHB03] Table 1: average convergence (s) by the initial error; beside it ours: mean / "
        "largest s until the true error stays below 1 degree, starts that do not in 100 s\n";
    text += fmt::format("  {:>4} {:8} {:>7} {:>8} {:>7}", "deg", "axis", "Balzac", "Fontana",
                        "Sears P.");
    for (const AlignmentStudy& study : studies)
        text += fmt::format("  {:>38}", study.cell);
    text += "\n";
    const std::vector<Cells> rows = published_table(1);
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const Cells& row = rows[i];
        if (parse_double(row.at(0)) != alignment_errors_deg[i])
            throw Failure("table_1.csv", "its errors are not those of the study", "Restore it");
        text += fmt::format("  {:>4} {:8} {:>7} {:>8} {:>7}", row[0], row.at(1), row.at(2),
                            row.at(3), row.at(4));
        for (const AlignmentStudy& study : studies)
            text += fmt::format("  {:>38}", times(summarise(study.by_error[i])));
        text += "\n";
    }
    return text;
}

std::string alignment_table_2(const std::vector<SurfaceAccuracy>& ours) {
    std::string text =
        "[FHB03] Table 2: attitude by surface and velocity less the car's, degrees\n";
    const std::vector<Cells> rows = published_table(2);
    text += fmt::format("  {:52} {:>6} {:>6} {:>7}\n", "", "roll", "pitch", "heading");
    for (const Cells& row : rows)
        text += fmt::format("  {:52} {:>6} {:>6} {:>7}\n", row.at(0) + ", " + row.at(1), row.at(2),
                            row.at(3), row.at(4));
    for (const SurfaceAccuracy& one : ours)
        for (const bool mean : {true, false}) {
            const Eigen::Vector3d& figures = mean ? one.mean_deg : one.sd_deg;
            text += fmt::format(
                "  {:52} {:6.2f} {:6.2f} {:7.2f}\n",
                fmt::format("oval, vertices {:.0f} cm, {:.2f} m/s, {}", 1e2 * one.vertex_sigma_m,
                            one.velocity_sigma_m_s, mean ? "mean" : "standard deviation"),
                figures.x(), figures.y(), figures.z());
        }
    return text + "  The means are the car's own lean and side slip.\n";
}

std::string alignment_table_3(const std::vector<AlignmentStudy>& studies) {
    std::string text = "[FHB03] Table 3: convergence by method (s), mean +- standard deviation\n";
    for (const Cells& row : published_table(3))
        text += fmt::format("  {:28} {:>6} +- {:>4} of {}\n", row.at(0) + ", " + row.at(1),
                            row.at(3), row.at(4), row.at(2));
    text += sooner_line(studies);
    text += fmt::format("Ours: {:24} {:>6} {:>14} {:>15} {:>14} {:>6} failed\n", "", "error",
                        "stated s", "error then", "true s", "most");
    for (const AlignmentStudy& study : studies) {
        text += study.cell + "\n";
        for (std::size_t i = 0; i < study.by_start.size(); ++i)
            text += method_line(alignment_start_name(alignment_starts[i]), study.by_start[i]);
        if (!study.overconfident.empty())
            text += method_line("track model, as for a car", study.overconfident);
    }
    return text +
           "  stated: the root of the trace of the attitude's covariance falls below 1 degree; "
           "true: the error stays below it. A converged covariance is not convergence: the error "
           "then shows. Unseen: NIS/3 of 2 or less.\n";
}

std::string alignment_figures(const std::vector<AlignmentStudy>& studies) {
    std::string text =
        "[FHB03] Figures 5 and 9, average: Sears Point 40 s for small errors to 70 s at 45 "
        "degrees; Fontana at most 35 s for small ones, below 100 s up to 45 degrees\n";
    text += for_each_study(studies, [](const AlignmentStudy& study) {
        return fmt::format("{:.1f} s up to 10 degrees, {:.1f} s at 40",
                           between(study, 0.0, 10.0).true_s, between(study, 40.0, 40.0).true_s);
    });
    text +=
        "Figures 6 and 10, largest: Sears Point to 140 s at 30 degrees, where the mean is 60; "
        "Fontana at least 100 s several times at 45 degrees\n";
    text += for_each_study(studies, [](const AlignmentStudy& study) {
        const AlignmentSummary at_30 = between(study, 30.0, 30.0);
        return fmt::format("{:.1f} s at 30 degrees, where the mean is {:.1f}; {:.1f} s at 40",
                           at_30.true_most_s, at_30.true_s, between(study, 40.0, 40.0).true_most_s);
    });
    text +=
        "Failed of starts above 40 degrees: Fontana 40 of 60 in 100 s; Sears Point 16 of 154 in "
        "250 s (14 of 140 above 60, by Figure 6); none at 40 degrees or less\n";
    text += for_each_study(studies, [](const AlignmentStudy& study) {
        const AlignmentSummary below = between(study, 0.0, 40.0),
                               above = between(study, 41.0, 180.0);
        return fmt::format("{} of {} in 100 s ({} unseen); {} of {} at 40 or less", above.failed,
                           above.runs, above.failed_unseen, below.failed, below.runs);
    });
    return text;
}

}  // namespace runcert
