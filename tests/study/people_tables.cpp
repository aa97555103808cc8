#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "people_study.h"
#include "study_verdict.h"

namespace runcert {
namespace {

constexpr double epochs_of_cost = 50'000.0;

double quantile(std::vector<double> values, double share) {
    if (values.empty()) return std::nan("");
    std::ranges::sort(values);
    const double at = share * static_cast<double>(values.size() - 1);
    return values[static_cast<std::size_t>(std::lround(at))];
}

double largest(const std::vector<double>& values) {
    return values.empty() ? 0.0 : std::ranges::max(values);
}

struct KindSummary {
    std::int64_t runs = 0, certified = 0, held = 0, failed = 0, beaten = 0, false_beaten = 0;
    std::vector<double> expanded_km_h, errors_km_h, missed_by_km_h;
    double usable = 0.0, epochs = 0.0, processor_s = 0.0;
    std::map<std::string, std::int64_t> reasons;

    void add(const PeopleResult& one) {
        ++runs;
        if (one.failed) ++failed;
        usable += static_cast<double>(one.usable);
        epochs += static_cast<double>(one.epochs);
        processor_s += one.processor_s;
        if (!one.certified()) {
            ++reasons[reason_words(one.reason)];
            return;
        }
        ++certified;
        if (one.outcome == Outcome::beaten) ++beaten;
        if (one.falsely_beaten()) ++false_beaten;
        expanded_km_h.push_back(3.6 * one.expanded);
        errors_km_h.push_back(3.6 * one.error());
        if (one.held())
            ++held;
        else
            missed_by_km_h.push_back(3.6 * (std::abs(one.error()) - one.expanded));
    }
    std::string line(const std::string& name) const {
        std::vector<double> sizes = errors_km_h;
        for (double& error : sizes)
            error = std::abs(error);
        const double share = static_cast<double>(certified) / static_cast<double>(runs);
        const double coverage = static_cast<double>(held) / static_cast<double>(certified);
        return fmt::format(
            "{:<32} {:5} {:9.3f} {:9.3f} {:8.2f} {:8.2f} {:+8.2f} {:8.2f} {:8.2f} {:7.3f} {:7} "
            "{:8.1f}\n",
            name, runs, share, coverage, quantile(expanded_km_h, 0.5), quantile(expanded_km_h, 0.9),
            quantile(errors_km_h, 0.5), quantile(sizes, 0.95), largest(missed_by_km_h),
            usable / epochs, false_beaten, processor_s / epochs * epochs_of_cost);
    }
};

constexpr std::string_view heading =
    "                                               coverage    U, km/h           error, km/h     "
    "  missed  usable   false\n"
    "kind                              runs certified    95 %   median     90 %   median   95 %  "
    "  by most   share  beaten  s/50,000\n";

std::string csv_text(std::string text) {
    std::ranges::replace(text, '"', '\'');
    std::ranges::replace(text, '\n', ' ');
    return "\"" + text + "\"";
}

std::string number(const std::optional<double>& value) {
    return value ? fmt::format("{:.6f}", *value) : "";
}

}  // namespace

std::string people_table(const std::vector<PeopleResult>& results) {
    std::vector<std::pair<std::string, std::string>> order;
    std::map<std::pair<std::string, std::string>, KindSummary> cells;
    for (const PeopleResult& one : results) {
        const std::pair cell{one.profile, one.kind};
        if (!cells.contains(cell)) order.push_back(cell);
        cells[cell].add(one);
    }
    std::ranges::stable_sort(order, {}, &std::pair<std::string, std::string>::first);
    std::string text;
    std::string refused = "Why the others were refused\n";
    std::string rule;
    for (const auto& cell : order) {
        const KindSummary& sum = cells[cell];
        if (cell.first != rule) text += fmt::format("{}\n{}", cell.first, heading);
        rule = cell.first;
        text += sum.line(cell.second);
        for (const auto& [reason, count] : sum.reasons)
            refused +=
                fmt::format("{:<28} {:<28} {:5} {}\n", cell.first, cell.second, count, reason);
    }
    return text + refused;
}

std::string people_faults_table(const std::vector<PeopleResult>& results) {
    struct Count {
        std::int64_t runs = 0, certified = 0, held = 0, beaten = 0, false_at = 0, false_above = 0;
    };
    std::map<std::string, Count> counts;
    std::map<std::string, KindSummary> kinds;
    std::string listed;
    for (const PeopleResult& one : results) {
        kinds[one.kind].add(one);
        for (const std::string& name :
             {to_text(one.fault), to_text(one.fault) + ", " + one.kind, std::string("~ all")}) {
            Count& count = counts[name];
            ++count.runs;
            if (!one.certified()) continue;
            ++count.certified;
            if (one.held()) ++count.held;
            if (one.outcome == Outcome::beaten) ++count.beaten;
            if (one.falsely_beaten()) ++count.false_at;
            if (one.falsely_beaten_above()) ++count.false_above;
        }
        if (!one.certified() || !one.falsely_beaten()) continue;
        listed += fmt::format(
            "  seed {}: {}, {}, {:.3f} km/h +- {:.3f}, true {:.3f}, required {:.3f}; {}\n",
            one.seed, one.kind, one.profile, 3.6 * *one.speed, 3.6 * one.expanded, 3.6 * *one.truth,
            3.6 * one.record, one.faults);
    }
    std::string text =
        "                                                               beaten although the truth "
        "is below\n"
        "faults                             runs certified  held beaten  the true best speed  and "
        "0.1 km/h more\n";
    for (const auto& [name, count] : counts)
        text += fmt::format("{:<34} {:6} {:8} {:6} {:6} {:12} {:18}\n", name, count.runs,
                            count.certified, count.held, count.beaten, count.false_at,
                            count.false_above);
    text += fmt::format("\n{}", heading);
    for (const auto& [name, sum] : kinds)
        text += sum.line(name);
    text += "Refused\n";
    for (const auto& [name, sum] : kinds)
        for (const auto& [reason, count] : sum.reasons)
            text += fmt::format("{:<28} {:5} {}\n", name, count, reason);
    return text + "Falsely beaten\n" + listed;
}

std::string people_csv(const std::vector<PeopleResult>& results) {
    std::set<std::string> symbols;
    for (const PeopleResult& one : results)
        for (const auto& [symbol, contribution] : one.contributions)
            symbols.insert(symbol);
    std::string text =
        "kind,seed,rule,fault,faults,outcome,outcome_above,failed,epochs,usable,record_m_s,"
        "speed_m_s,truth_m_s,error_m_s,U_m_s,held,bias_limit_m_s,undetected_m_s,"
        "expected_beside_velocities_m_s,window_start_s,white_m,slow_m,slow_tau_s,stated_m,filter_s,"
        "velocity_white_m_s,velocity_slow_m_s,"
        "velocity_stated_m_s,velocity_late_s";
    for (const std::string& symbol : symbols)
        text += ",u_" + symbol;
    text += ",reason\n";
    for (const PeopleResult& one : results) {
        const bool known = one.speed && one.truth;
        const PeopleDevice& device = one.device;
        text += fmt::format(
            "{},{},{},{},{},{},{},{},{},{},{:.6f},{},{},{},{:.6f},{},{:.6f},{:.6f},{},{},",
            csv_text(one.kind), one.seed, one.profile, to_text(one.fault), csv_text(one.faults),
            to_text(one.outcome), to_text(one.outcome_above), one.failed ? 1 : 0, one.epochs,
            one.usable, one.record, number(one.speed), number(one.truth),
            known ? fmt::format("{:.6f}", one.error()) : "", one.expanded,
            known ? (one.held() ? "1" : "0") : "", one.bias_limit, one.undetected,
            number(one.expected_with_velocities), number(one.window_start));
        text += fmt::format("{:.4f},{:.4f},{:.2f},{:.4f},{:.3f},{:.4f},{:.4f},{:.4f},{:.4f}",
                            device.white_m, device.slow_m, device.slow_tau_s, device.stated_m,
                            device.filter_s, device.velocity_white_m_s, device.velocity_slow_m_s,
                            device.velocity_stated_m_s, device.velocity_late_s);
        for (const std::string& symbol : symbols) {
            const auto found = one.contributions.find(symbol);
            text += found == one.contributions.end() ? "," : fmt::format(",{:.6f}", found->second);
        }
        text += fmt::format(",{}\n", csv_text(one.reason));
    }
    return text;
}

}  // namespace runcert
