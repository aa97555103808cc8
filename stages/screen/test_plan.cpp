#include "stages/screen/test_plan.h"

#include <cmath>
#include <iterator>

#include "core/statistics.h"

namespace runcert {

TestPlan::TestPlan(double family_false_alarm_rate, std::int64_t tests, double power,
                   std::int64_t burst_epochs_max, double manoeuvre_max_m_s2)
    : tests_(tests),
      size_(family_false_alarm_rate / static_cast<double>(tests)),
      power_(power),
      burst_epochs_max_(static_cast<std::size_t>(burst_epochs_max)),
      manoeuvre_max_m_s2_(manoeuvre_max_m_s2),
      noncentrality_{0.0, runcert::noncentrality(size_, power, 1),
                     runcert::noncentrality(size_, power, 2)} {
    for (const int axes : {1, 2})
        critical(axes);
}

double TestPlan::critical(int degrees_of_freedom) const {
    const auto index = static_cast<std::size_t>(degrees_of_freedom);
    if (critical_.size() <= index) critical_.resize(index + 1, 0.0);
    if (critical_[index] == 0.0)
        critical_[index] = chi_squared_upper_quantile(size_, degrees_of_freedom);
    return critical_[index];
}

std::int64_t tests_of_an_epoch(const TestedData& data, std::int64_t burst_epochs_max) {
    const std::int64_t of_a_series = 5 + (burst_epochs_max - 1) + std::ssize(span_lengths);
    return (data.position_series + data.baseline_series + data.speed_series) * of_a_series +
           data.comparisons;
}

}  // namespace runcert
